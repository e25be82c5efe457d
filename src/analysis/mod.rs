//! From stored runs to tables of what they say.

mod convergence;
mod runs;
pub mod statistics;
mod summary;
mod table;

pub use convergence::{Curve, convergence};
pub use runs::{Run, best_run, runs};
pub use summary::summary;
pub use table::render;
