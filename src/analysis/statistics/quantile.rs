//! Quantiles of a sample.

/// Quantile by linear interpolation between order statistics, of values in ascending order: type 7 of
/// Hyndman and Fan (1996), doi 10.1080/00031305.1996.10473566, and `NumPy`'s default.
///
/// What lies between a finite and an infinite neighbour is infinite. Without values it is NaN.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let position = q.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    if low == high || low.is_infinite() { low } else { low + (high - low) * position.fract() }
}

/// The quartiles of unsorted values; infinite ones are the largest.
pub fn quartiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|q| quantile(&sorted, q))
}

/// The median of unsorted values; NaN where there are none.
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let (middle, is_odd) = (values.len() / 2, values.len() % 2 == 1);
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let lower =
        if is_odd { upper } else { below.iter().copied().fold(f64::NEG_INFINITY, f64::max) };
    if lower == upper { upper } else { lower + 0.5 * (upper - lower) }
}
