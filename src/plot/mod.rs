//! The charts of every experiment, drawn from its tables.

mod charts;
mod convergence;
mod costs;
mod critical_difference;
mod curves;
mod dimensions;
mod effect_sizes;
mod final_costs;
mod looks;
mod names;
mod running_times;
#[cfg(test)]
mod tests;

pub(crate) use charts::{NAMES, charts, left_out};
