//! Charts: one drawing, written as SVG, PNG and PDF.

mod base_attitude;
mod convergence;
mod derivatives;
mod figure;
mod joint_angles;
mod panel;
mod style;

use std::path::Path;

pub use base_attitude::base_attitude;
pub use convergence::convergence;
pub use derivatives::derivatives;
pub use figure::{Figure, PlotError};
pub use joint_angles::joint_angles;

use crate::problem::Motion;
use crate::task::Task;

/// Intervals at which a motion is sampled for its charts.
pub const SAMPLES: usize = 600;

/// Writes the paper's Figures 4, 5 and 6 for a motion into a folder.
pub fn write_motion_figures(folder: &Path, motion: &Motion, task: &Task) -> Result<(), PlotError> {
    joint_angles(motion).save(folder, "joint-angles")?;
    derivatives(motion, &task.limits).save(folder, "joint-derivatives")?;
    base_attitude(motion, task).save(folder, "base-attitude")
}
