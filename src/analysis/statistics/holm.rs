//! P-values of many tests at once.

use super::ranks::ascending;

/// Holm's adjusted p-values, in the order given: a hypothesis is rejected at level `α`, with the chance
/// of any false rejection at most `α`, where its adjusted p-value is at most `α`.
///
/// The `i`-th lowest of `m` is multiplied by `m − i + 1`, is no lower than those before it, and no
/// higher than 1. Holm (1979), Scandinavian Journal of Statistics 6:65–70.
pub fn holm(p_values: &[f64]) -> Vec<f64> {
    let mut adjusted = vec![0.0; p_values.len()];
    let mut highest = 0.0_f64;
    for (i, place) in ascending(p_values).into_iter().enumerate() {
        highest = highest.max((p_values.len() - i) as f64 * p_values[place]).min(1.0);
        adjusted[place] = highest;
    }
    adjusted
}
