//! By how much one sample is better than another.

use super::average_ranks;

/// Vargha and Delaney's `A₁₂`: the probability that a value of the first sample is *lower* than one of
/// the second, equal ones, infinite ones too, counting half. So it is 1 where the first is always
/// better, ½ where neither is. No number where a sample is empty.
///
/// Vargha and Delaney (2000), doi 10.3102/10769986025002101, who count the higher values.
pub fn vargha_delaney(first: &[f64], second: &[f64]) -> f64 {
    let ranks = average_ranks(&[first, second].concat());
    let (m, n) = (first.len() as f64, second.len() as f64);
    // In the second sample's ranks are its own, 1 to n, and one for each lower value of the first.
    let lower = ranks.iter().skip(first.len()).sum::<f64>() - n * (n + 1.0) / 2.0;
    lower / (m * n)
}
