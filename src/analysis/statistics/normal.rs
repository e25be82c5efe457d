//! The standard normal distribution.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// `Φ(z)`. The error function of statrs is right to eleven digits only, that of libm to the last one.
pub(super) fn cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// `φ(z)`.
pub(super) fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}
