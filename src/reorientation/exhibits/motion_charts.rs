//! The charts of a motion.

#[cfg(feature = "cli")]
use std::path::Path;

use super::base_attitude::base_attitude;
use super::derivatives::derivatives;
use super::joint_angles::joint_angles;
use super::snapshots::snapshots;
use crate::exhibit::Chart;
#[cfg(feature = "cli")]
use crate::figure::FigureError;
use crate::reorientation::motion::Motion;
use crate::task::Task;

/// Intervals at which a motion is sampled for its charts.
pub(crate) const SAMPLES: usize = 600;

/// The names of the charts of a motion.
pub(super) const MOTION_NAMES: [&str; 4] =
    ["joint-angles", "joint-derivatives", "base-attitude", "snapshots"];

/// The paper's Figures 4, 5 and 6 for a motion, and snapshots; their table is `motion`.
pub(super) fn motion_charts(motion: &Motion, task: &Task) -> Vec<Chart> {
    let chart = |name: &str, title: &str, caption: &str, figure| Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        table: "motion".into(),
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
            "Joint rates, accelerations and jerks of the best motion over time; dotted lines are the limits.",
            derivatives(motion, &task.limits),
        ),
        chart(
            "base-attitude",
            "Attitude of the base",
            "ZYX Euler angles of the base over time; dotted lines are the goal's.",
            base_attitude(motion, task),
        ),
        chart(
            "snapshots",
            "The arm along the motion",
            "The robot at equal distances of time, seen along one direction of inertial space; the dotted outline is the base in \
             its goal attitude, the orange line the way of the tool. Body and panels are drawn for the eye: the model knows mass, inertia and mount.",
            snapshots(motion, task),
        ),
    ]
}

/// Writes the charts of a motion into a folder.
#[cfg(feature = "cli")]
pub(crate) fn write_motion_figures(
    folder: &Path,
    motion: &Motion,
    task: &Task,
) -> Result<(), FigureError> {
    motion_charts(motion, task).iter().try_for_each(|chart| chart.figure.save(folder, &chart.name))
}
