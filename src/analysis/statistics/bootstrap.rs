//! How far a statistic of a sample can be trusted.

use super::quantile;

/// Percentile intervals by the bootstrap; Efron and Tibshirani (1993), chapter 13,
/// doi 10.1201/9780429246593.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bootstrap {
    /// Share of the resamples' statistics inside the interval, 0.95 say.
    pub level: f64,
    /// Number of resamples.
    pub resamples: usize,
}

impl Bootstrap {
    /// Lower and upper end of the interval of a statistic.
    ///
    /// `index(n)` draws a whole number below `n`, each as likely; the resamples are drawn one after
    /// the other, each with as many draws as the sample has values. A statistic may be infinite, and
    /// so may then be the interval's ends; it has to be a number.
    pub fn interval<T: Copy>(
        &self,
        sample: &[T],
        statistic: impl Fn(&[T]) -> f64,
        mut index: impl FnMut(usize) -> usize,
    ) -> [f64; 2] {
        let mut resample = sample.to_vec();
        let mut draw = || {
            resample.fill_with(|| sample[index(sample.len())]);
            statistic(&resample)
        };
        let mut statistics: Vec<f64> = (0..self.resamples).map(|_| draw()).collect();
        statistics.sort_by(f64::total_cmp);
        let tail = (1.0 - self.level) / 2.0;
        [quantile(&statistics, tail), quantile(&statistics, 1.0 - tail)]
    }
}
