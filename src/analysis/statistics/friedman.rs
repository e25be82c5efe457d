//! Whether treatments differ over blocks.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use super::average_ranks;

/// What Friedman's test says about `k` treatments on `n` blocks.
#[derive(Debug, Clone, PartialEq)]
pub struct Friedman {
    /// Mean rank of each treatment over the blocks, 1 being the lowest.
    pub mean_ranks: Vec<f64>,
    /// Friedman's statistic, corrected for ties.
    pub chi_square: f64,
    /// Its p-value: chi-squared with `k − 1` degrees of freedom.
    pub p: f64,
    /// Iman and Davenport's statistic; infinite where all blocks rank the treatments alike.
    pub f: f64,
    /// Its p-value: F with `k − 1` and `(k − 1)(n − 1)` degrees of freedom. It is the less conservative
    /// one, and the better one for few blocks.
    pub f_p: f64,
}

/// Friedman's test: a block is a row, an instance say, with one value for each treatment.
///
/// None with fewer than two blocks or two treatments, or with rows of different lengths. Where every
/// block has one value for all treatments, statistics are 0 and p-values 1.
///
/// With `A` the sum of all squared ranks, `B` the sum over treatments of their squared rank sums,
/// divided by `n`, and `C = n k (k + 1)² / 4`, which `A` and `B` exceed by what ranks differ,
///
/// ```text
///     χ² = n (k − 1) (B − C) / (A − C),      F = (n − 1) (B − C) / (A − B),
/// ```
///
/// as in Conover, Practical Nonparametric Statistics (1999), which corrects for ties. Friedman (1937),
/// doi 10.1080/01621459.1937.10503522; Iman and Davenport (1980), doi 10.1080/03610928008827904.
pub fn friedman(blocks: &[Vec<f64>]) -> Option<Friedman> {
    let (n, k) = (blocks.len(), blocks.first()?.len());
    if n < 2 || k < 2 || blocks.iter().any(|block| block.len() != k) {
        return None;
    }
    let ranks: Vec<Vec<f64>> = blocks.iter().map(|block| average_ranks(block)).collect();
    let sums: Vec<f64> = (0..k).map(|i| ranks.iter().map(|row| row[i]).sum()).collect();
    let (n, k) = (n as f64, k as f64);
    // Each times n, so that all are whole multiples of a quarter, and without rounding.
    let a = n * ranks.iter().flatten().map(|rank| rank * rank).sum::<f64>();
    let b: f64 = sums.iter().map(|sum| sum * sum).sum();
    let c = n * n * k * (k + 1.0) * (k + 1.0) / 4.0;
    let (chi_square, f) = if a == c {
        (0.0, 0.0)
    } else {
        (n * (k - 1.0) * (b - c) / (a - c), (n - 1.0) * (b - c) / (a - b))
    };
    Some(Friedman {
        mean_ranks: sums.iter().map(|sum| sum / n).collect(),
        chi_square,
        p: ChiSquared::new(k - 1.0).ok()?.sf(chi_square),
        f,
        f_p: FisherSnedecor::new(k - 1.0, (k - 1.0) * (n - 1.0)).ok()?.sf(f),
    })
}
