//! From stored runs to tables of what they say.

mod convergence;
mod format;
#[cfg(test)]
mod handmade;
mod runs;
mod standing;
pub mod statistics;
mod summary;
pub mod tables;
mod targets;
mod ties;

pub use convergence::{Curve, convergence};
pub use format::{csv, latex, markdown, render};
pub use runs::{Improvement, Run, best_run, load};
pub use standing::{Failure, Standing, Tally, standing};
pub use summary::summary;
pub use targets::{Targets, least_found, targets};
