//! Optimisers: plain control flow over an [`Oracle`].

mod catalogue;
mod cma_es;
mod de;
mod distribution;
mod hybrid;
mod l_shade;
mod nelder_mead;
mod population;
mod pso;
mod random;
mod scp;

pub use catalogue::{Setting, Settings};
pub use cma_es::CmaEs;
pub use de::De;
pub use hybrid::Hybrid;
pub use l_shade::LShade;
pub use nelder_mead::NelderMead;
pub use pso::{Inertia, Pso, Walls};
pub use random::RandomSearch;
pub use scp::{Ending, Scp};

use crate::search::Evaluation;
use crate::search::{Oracle, Rng, Stop};

/// A method of minimisation.
///
/// It asks the oracle until the oracle says stop, or until it has nothing more to do.
pub trait Optimiser: Send + Sync {
    /// Minimises. `Ok` means that the method ended by itself.
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop>;

    /// The variables in which it searches a problem that has several formulations; without a name the problem's
    /// first.
    fn formulation(&self) -> Option<&str> {
        None
    }

    /// For a search of many independent starts: one of them, and how many there are. Trials of how long a run
    /// takes make it one start at a time.
    fn parts(&self) -> Option<(Box<dyn Optimiser>, usize)> {
        None
    }

    /// Whether it can search only problems with derivatives.
    fn needs_derivatives(&self) -> bool {
        false
    }
}

/// The cost to compare points by: what is infinite or no number is as bad as can be.
fn rank(evaluation: &Evaluation) -> f64 {
    if evaluation.cost.is_finite() { evaluation.cost } else { f64::INFINITY }
}

/// Writes a point drawn uniformly from the oracle's box.
fn uniform_point(oracle: &Oracle<'_>, rng: &mut Rng, x: &mut [f64]) {
    for (x, [lower, upper]) in x.iter_mut().zip(oracle.bounds().iter()) {
        *x = rng.uniform(lower, upper);
    }
}

/// Writes the point of the oracle's box that stands at `z` in the unit cube; the walls mirror what is
/// outside.
fn mirror_from_unit(oracle: &Oracle<'_>, z: &[f64], x: &mut [f64]) {
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
