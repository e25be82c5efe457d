//! From stored runs to tables of what they say.

mod convergence;
mod runs;
mod summary;
mod table;
mod traces;

pub use convergence::{Curve, convergence};
pub use runs::{Run, best_run, runs};
pub use summary::summary;
pub use table::render;
pub use traces::{Trace, traces};
