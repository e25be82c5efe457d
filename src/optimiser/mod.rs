//! Optimisers: plain control flow over an [`Oracle`].

mod catalogue;
mod conic;
mod pso;
mod random;
mod scp;

pub use catalogue::{Setting, Settings};
pub use pso::{Inertia, Pso, Walls};
pub use random::RandomSearch;
pub use scp::{Ending, Scp};

use crate::oracle::{Oracle, Rng, Stop};

/// A method of minimisation.
///
/// It asks the oracle until the oracle says stop, or until it has nothing more to do.
pub trait Optimiser: Sync {
    /// Minimises. `Ok` means that the method ended by itself.
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop>;
}

/// Writes a point drawn uniformly from the oracle's box.
fn uniform_point(oracle: &Oracle<'_>, rng: &mut Rng, x: &mut [f64]) {
    for (x, [lower, upper]) in x.iter_mut().zip(oracle.bounds().iter()) {
        *x = rng.uniform(lower, upper);
    }
}
