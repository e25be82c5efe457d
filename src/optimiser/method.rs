//! What every optimiser is.

use crate::search::{Oracle, Problem, Rng, Stop};

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

    /// What it needs of a problem that this one does not give, if anything, such as `derivatives`.
    fn lacks(&self, problem: &dyn Problem) -> Option<&'static str> {
        (self.needs_derivatives() && problem.slopes().is_none()).then_some("derivatives")
    }
}
