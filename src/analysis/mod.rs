//! From stored runs to tables of what they say.

mod convergence;
mod runs;
mod standing;
mod summary;
mod table;

pub use convergence::{Curve, convergence};
pub use runs::{Run, Step, best_run, load};
pub use standing::{Failure, Standing, Tally, standing};
pub use summary::summary;
pub use table::render;
