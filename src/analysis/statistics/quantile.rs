//! Quantiles of a sample.

/// Quantile by linear interpolation between order statistics, of values in ascending order: type 7 of
/// Hyndman and Fan (1996), doi 10.1080/00031305.1996.10473566, and `NumPy`'s default.
///
/// What lies between a finite and an infinite neighbour is infinite. Without values it is no number.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let position = q.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    if low == high || low.is_infinite() { low } else { low + (high - low) * position.fract() }
}
