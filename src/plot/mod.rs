//! Charts: one drawing, written as SVG, PNG and PDF.

mod axis;
mod base_attitude;
mod chart;
mod charts;
mod comparison;
mod convergence;
mod critical_difference;
mod curves;
mod derivatives;
mod figure;
mod joint_angles;
mod looks;
mod marks;
mod panel;
mod pareto;
mod running_times;
mod sheet;
mod snapshots;
mod style;
mod sweeps;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use base_attitude::base_attitude;
pub use chart::Chart;
pub use charts::{NAMES, charts};
pub use comparison::{effect_sizes, final_costs};
pub use convergence::convergence;
pub use critical_difference::critical_difference;
pub use derivatives::derivatives;
pub use figure::{Figure, PlotError};
pub use joint_angles::joint_angles;
pub use looks::Looks;
pub use pareto::pareto;
pub use running_times::{expected_running_time, profiles, running_time_distribution};
pub use snapshots::snapshots;
pub use sweeps::{Swept, sweep};

use crate::reorientation::Motion;
use crate::task::Task;

/// Intervals at which a motion is sampled for its charts.
pub const SAMPLES: usize = 600;

/// The names of the charts of a motion.
pub const MOTION_NAMES: [&str; 4] =
    ["joint-angles", "joint-derivatives", "base-attitude", "snapshots"];

/// The paper's Figures 4, 5 and 6 for a motion, and snapshots; their table is `motion`.
pub fn motion_charts(motion: &Motion, task: &Task) -> Vec<Chart> {
    let chart = |name: &str, title: &str, caption: &str, figure| Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        table: "motion",
        figure,
    };
    vec![
        chart(
            "joint-angles",
            "Joint angles",
            "Joint angles of the best motion over time.",
            joint_angles(motion),
        ),
        chart(
            "joint-derivatives",
            "Joint rates, accelerations and jerks",
            "Joint rates, accelerations and jerks of the best motion over time; short dashes are the limits.",
            derivatives(motion, &task.limits),
        ),
        chart(
            "base-attitude",
            "Attitude of the base",
            "ZYX Euler angles of the base over time; short dashes are the goal's.",
            base_attitude(motion, task),
        ),
        chart(
            "snapshots",
            "The arm along the motion",
            "The robot at equal distances of time, seen along one direction of inertial space; the dashed outline is the base in \
             its goal attitude, the orange line the way of the tool. Body and panels are drawn for the eye: the model knows mass, inertia and mount.",
            snapshots(motion, task),
        ),
    ]
}

/// Writes the charts of a motion into a folder.
pub fn write_motion_figures(folder: &Path, motion: &Motion, task: &Task) -> Result<(), PlotError> {
    motion_charts(motion, task).iter().try_for_each(|chart| chart.figure.save(folder, &chart.name))
}
