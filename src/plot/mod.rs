//! The charts of every experiment, drawn from its tables.

mod charts;
mod comparison;
mod convergence;
mod critical_difference;
mod curves;
mod looks;
mod running_times;
#[cfg(test)]
mod tests;

pub use charts::{NAMES, charts};
pub use comparison::{effect_sizes, final_costs};
pub use convergence::convergence;
pub use critical_difference::critical_difference;
pub use looks::Looks;
pub use running_times::{expected_running_time, profiles, running_time_distribution};
