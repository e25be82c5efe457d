//! Points of the box, and the cost to compare them by.

use crate::search::{Evaluation, Oracle, Rng};

/// The cost to compare points by: infinite where it is not finite.
pub(super) fn rank(evaluation: &Evaluation) -> f64 {
    if evaluation.cost.is_finite() { evaluation.cost } else { f64::INFINITY }
}

/// Writes a point drawn uniformly from the oracle's box.
pub(super) fn uniform_point(oracle: &Oracle<'_>, rng: &mut Rng, x: &mut [f64]) {
    for (x, [lower, upper]) in x.iter_mut().zip(oracle.bounds().iter()) {
        *x = rng.uniform(lower, upper);
    }
}

/// Writes the point of the oracle's box that stands at `z` in the unit cube; the walls mirror what is
/// outside.
pub(super) fn mirror_from_unit(oracle: &Oracle<'_>, z: &[f64], x: &mut [f64]) {
    for ((x, z), [lower, upper]) in x.iter_mut().zip(z).zip(oracle.bounds().iter()) {
        *x = (lower + reflect(*z) * (upper - lower)).clamp(lower, upper);
    }
}

/// The place in the unit interval that its mirrored copies repeat.
fn reflect(z: f64) -> f64 {
    let z = z.rem_euclid(2.0);
    if z > 1.0 { 2.0 - z } else { z }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_reflect() {
        for (z, expected) in [(0.25, 0.25), (-0.25, 0.25), (1.25, 0.75), (2.5, 0.5), (-3.75, 0.25)]
        {
            assert_eq!(reflect(z), expected);
        }
    }
}
