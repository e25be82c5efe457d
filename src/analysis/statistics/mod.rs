//! Statistics of a benchmark, as functions of plain slices.
//!
//! Costs and running times are better when lower. A run without success takes infinitely long, so
//! every function here takes infinite values, and none turns them into NaN.

mod bootstrap;
mod cliques;
mod effect_size;
mod friedman;
mod holm;
mod nemenyi;
mod normal;
mod profiles;
mod quantile;
mod ranks;
mod running_time;
mod wilcoxon;

pub use bootstrap::Bootstrap;
pub use cliques::cliques;
pub use effect_size::vargha_delaney;
pub use friedman::{Friedman, friedman};
pub use holm::holm;
pub use nemenyi::{critical_difference, nemenyi, studentised_range_sf};
pub use profiles::{ProfileStep, convergence_target, data_profiles, performance_profiles};
pub use quantile::{median, quantile, quartiles};
pub use ranks::average_ranks;
pub use running_time::{Trial, expected_running_time, simulated_restarts};
pub use wilcoxon::{Wilcoxon, wilcoxon};
