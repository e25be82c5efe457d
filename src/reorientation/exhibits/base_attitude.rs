//! ZYX Euler angles of the base over time: the paper's Figure 6.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent};
use crate::figure::style::Stroke;
use crate::reorientation::motion::{Motion, zyx_near};
use crate::task::Task;

/// ZYX Euler angles of the base over time, with its turn where that has a limit; dotted lines are the goal's and the limit.
pub(super) fn base_attitude(motion: &Motion, task: &Task) -> Figure {
    let end = motion.time.last().copied().unwrap_or(1.0);
    let angles = motion.base_zyx();
    let last = angles.last().copied().unwrap_or_default();
    let mut goals = zyx_near(&task.goal.base, last).map(f64::to_degrees).to_vec();
    goals.dedup();
    let mut lines: Vec<Line> = Vec::new();
    for (k, name) in ["yaw ψ", "pitch ϑ", "roll φ"].into_iter().enumerate() {
        let values = angles.iter().map(|zyx| zyx[k].to_degrees());
        lines.push(Line::over_time(k, name, &motion.time, values));
    }
    for (i, angle) in goals.into_iter().enumerate() {
        lines.push(Line::level(if i == 0 { "goal" } else { "" }, angle, [0.0, end]));
    }
    let mut label = "base Euler angle [°]";
    if let Some(limit) = task.path.base_turn.map(f64::to_degrees) {
        let stroke = Stroke::of(3);
        let dotted = Stroke { dashes: Stroke::reference().dashes, ..stroke };
        let turns = motion.base.iter().map(|base| task.path.turn_at(task, base).to_degrees());
        lines.push(Line::over_time(3, "turn", &motion.time, turns));
        lines.push(Line::new("its limit", dotted, vec![[0.0, limit], [end, limit]]));
        label = "base angle [°]";
    }
    let x = Axis::linear("time t [s]", [0.0, end], 0.0);
    let y = Axis::linear(label, extent(&lines), MARGIN);
    Figure::column(vec![Panel::new(x, y, lines.into_iter().map(Mark::Line).collect())], 44.0)
}
