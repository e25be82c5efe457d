//! ZYX Euler angles of the base over time: the paper's Figure 6.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent};
use crate::figure::style::Stroke;
use crate::reorientation::motion::{Motion, zyx_near};
use crate::task::Task;

/// ZYX Euler angles of the base over time; dotted lines are the goal's.
pub(super) fn base_attitude(motion: &Motion, task: &Task) -> Figure {
    let end = motion.time.last().copied().unwrap_or(1.0);
    let angles = motion.base_zyx();
    let last = angles.last().copied().unwrap_or_default();
    let mut goals = zyx_near(&task.goal.base, last).map(f64::to_degrees).to_vec();
    goals.dedup();
    let mut lines: Vec<Line> = Vec::new();
    for (k, name) in ["yaw ψ", "pitch ϑ", "roll φ"].into_iter().enumerate() {
        let values = angles.iter().map(|zyx| zyx[k].to_degrees());
        lines.push(Line::over_time(name, Stroke::of(k), &motion.time, values));
    }
    for (i, angle) in goals.into_iter().enumerate() {
        lines.push(Line::level(if i == 0 { "goal" } else { "" }, angle, [0.0, end]));
    }
    let x = Axis::linear("time t [s]", [0.0, end], 0.0);
    let y = Axis::linear("base Euler angle [°]", extent(&lines), MARGIN);
    Figure::column(vec![Panel::new(x, y, lines.into_iter().map(Mark::Line).collect())], 44.0)
}
