//! The charts of every experiment, drawn from its tables.

mod charts;
mod comparison;
mod convergence;
mod critical_difference;
mod curves;
mod dimensions;
mod looks;
mod running_times;
#[cfg(test)]
mod tests;

pub(crate) use charts::{NAMES, charts};
