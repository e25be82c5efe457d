//! Whether one of two treatments is better, pair by pair.

use super::{average_ranks, normal};

/// What Wilcoxon's signed-rank test says about pairs of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wilcoxon {
    /// Pairs that differ; the others are left out.
    pub pairs: usize,
    /// Sum of the ranks of the pairs whose first value is the lower one.
    pub first_lower: f64,
    /// Sum of the ranks of the pairs whose second value is the lower one.
    pub second_lower: f64,
    /// Two-sided p-value; 1 where no pair differs.
    pub p: f64,
    /// Whether that is from the exact distribution.
    pub exact: bool,
}

/// Most pairs for which the exact distribution is used; a normal one is as good beyond.
const EXACT: usize = 50;

/// Wilcoxon's signed-rank test of paired values, two-sided.
///
/// Pairs are ranked by how much their values differ. Two equal values, infinite ones too, do not
/// differ, and one infinite value differs more than any two finite ones do. The p-value is exact for up
/// to 50 pairs that differ, with the ranks as they are, tied or not; otherwise that of the normal approximation,
/// corrected for ties but not for continuity. Values past the end of the shorter list have no pair.
///
/// Wilcoxon (1945), doi 10.2307/3001968; pairs that do not differ are left out, as there.
pub fn wilcoxon(first: &[f64], second: &[f64]) -> Wilcoxon {
    let pairs = first.iter().zip(second);
    let differences: Vec<f64> = pairs.filter(|(a, b)| a != b).map(|(a, b)| a - b).collect();
    let sizes: Vec<f64> = differences.iter().map(|difference| difference.abs()).collect();
    let ranks = average_ranks(&sizes);
    let sum = |negative: bool| {
        let signed = ranks.iter().zip(&differences);
        signed.filter(|(_, d)| (**d < 0.0) == negative).fold(0.0, |sum, (rank, _)| sum + rank)
    };
    let (first_lower, second_lower) = (sum(true), sum(false));
    let exact = differences.len() <= EXACT;
    let lesser = first_lower.min(second_lower);
    let p = if exact { exact_p(&ranks, lesser) } else { normal_p(&ranks, lesser) };
    Wilcoxon { pairs: differences.len(), first_lower, second_lower, p, exact }
}

/// Each rank counts with probability ½: the share of the 2ⁿ sets of ranks whose sum is at most the lesser
/// one, twice. Ranks of ties are halves, so all are doubled.
fn exact_p(ranks: &[f64], lesser: f64) -> f64 {
    let mut sets_by_sum = vec![1.0];
    for rank in ranks {
        let mut with = vec![0.0; (2.0 * rank) as usize];
        with.extend_from_slice(&sets_by_sum);
        for (with, without) in with.iter_mut().zip(&sets_by_sum) {
            *with += without;
        }
        sets_by_sum = with;
    }
    let below: f64 = sets_by_sum.iter().take((2.0 * lesser) as usize + 1).sum();
    (2.0 * below / 2_f64.powi(ranks.len() as i32)).min(1.0)
}

/// Each rank counts with probability ½, so the sum's mean is half of all and its variance a quarter of
/// all squares, whether ranks are tied or not.
fn normal_p(ranks: &[f64], lesser: f64) -> f64 {
    let mean = ranks.iter().sum::<f64>() / 2.0;
    let variance = ranks.iter().map(|rank| rank * rank).sum::<f64>() / 4.0;
    2.0 * normal::cdf((lesser - mean) / variance.sqrt())
}
