//! The charts of a motion.

#[cfg(feature = "cli")]
use std::path::Path;

use super::base_attitude::base_attitude;
use super::derivatives::derivatives;
use super::joint_angles::joint_angles;
use super::on_the_way::on_the_way;
use super::snapshots::snapshots;
use crate::exhibit::Chart;
#[cfg(feature = "cli")]
use crate::figure::FigureError;
use crate::reorientation::motion::Motion;
use crate::task::Task;

/// Intervals at which a motion is sampled for its charts.
pub(crate) const SAMPLES: usize = 600;

/// The names of the charts of a motion.
pub(super) const MOTION_NAMES: [&str; 5] =
    ["joint-angles", "joint-derivatives", "base-attitude", "on-the-way", "snapshots"];

/// The paper's Figures 4, 5 and 6 for a motion, and snapshots; their table is `motion`.
pub(super) fn motion_charts(motion: &Motion, task: &Task) -> Vec<Chart> {
    let chart = |name: &str, title: &str, caption: &str, figure| Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        table: "motion".into(),
        figure,
    };
    let mut charts = vec![
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
            if task.path.base_turn.is_some() {
                "ZYX Euler angles of the base over time, and its turn; dotted lines are the goal's angles and the turn's limit."
            } else {
                "ZYX Euler angles of the base over time; dotted lines are the goal's."
            },
            base_attitude(motion, task),
        ),
    ];
    charts.extend(on_the_way(motion, task).map(|figure| {
        let caption =
            "Path limits of the task over time; dotted lines are the limits. A torque is that of the joint \
             which is nearest to its limit, a clearance that of the nearest bodies.";
        chart("on-the-way", "Path limits", caption, figure)
    }));
    charts.push(
        chart(
            "snapshots",
            "The arm along the motion",
            "The robot at equal distances of time, seen along one direction of inertial space; the dotted outline is the base in \
             its goal attitude, the orange line the way of the tool. A base without shapes in its robot's file is drawn with two panels, for the eye only.",
            snapshots(motion, task),
        ),
    );
    charts
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
