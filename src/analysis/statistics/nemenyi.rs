//! Which mean ranks differ, all treatments compared with each other.

use super::normal;

/// Nemenyi's p-value of two treatments whose mean ranks over `blocks` blocks differ by `difference`, among
/// `treatments` that are all compared with each other; already adjusted for that.
///
/// Demšar (2006), Journal of Machine Learning Research 7:1–30.
pub fn nemenyi(difference: f64, treatments: usize, blocks: usize) -> f64 {
    studentised_range_sf(difference.abs() / deviation(treatments, blocks), treatments)
}

/// Nemenyi's critical difference: mean ranks that differ by more do so significantly at level `alpha`.
///
/// Demšar (2006), Journal of Machine Learning Research 7:1–30, for any number of treatments.
pub fn critical_difference(treatments: usize, blocks: usize, alpha: f64) -> f64 {
    // No level above rounding needs a wider range than 40.
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if studentised_range_sf(middle, treatments) > alpha {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high) * deviation(treatments, blocks)
}

/// Standard deviation of independent mean ranks whose differences have the variance `k (k + 1) / 6n`
/// of those that are compared.
fn deviation(treatments: usize, blocks: usize) -> f64 {
    let k = treatments as f64;
    (k * (k + 1.0) / (12.0 * blocks as f64)).sqrt()
}

/// Probability that the range of `count` independent standard normal numbers exceeds `q`: the survival
/// function of the studentised range with infinite degrees of freedom, to 1e-14.
///
/// With the highest number at `z`, the others are within `q` below it:
///
/// ```text
///     1 − k ∫ φ(z) (Φ(z) − Φ(z − q))^(k−1) dz
/// ```
///
/// The trapezoidal rule is exact to rounding for what is as smooth and falls as fast at both ends;
/// Trefethen and Weideman (2014), doi 10.1137/130932132.
pub fn studentised_range_sf(q: f64, count: usize) -> f64 {
    const STEPS_TO_A_UNIT: i32 = 32;
    const END: i32 = 10;
    let others = count.saturating_sub(1) as f64;
    let density = |step: i32| {
        let z = f64::from(step) / f64::from(STEPS_TO_A_UNIT);
        normal::density(z) * (normal::cdf(z) - normal::cdf(z - q)).powf(others)
    };
    let steps = -END * STEPS_TO_A_UNIT..=END * STEPS_TO_A_UNIT;
    let within = steps.map(density).sum::<f64>() / f64::from(STEPS_TO_A_UNIT);
    (1.0 - count as f64 * within).clamp(0.0, 1.0)
}
