//! ZYX Euler angles of the base over time: the paper's Figure 6.

use super::figure::Figure;
use super::joint_angles::{MARGIN, extent};
use super::panel::{Axis, Line, Panel};
use super::style::Stroke;
use crate::problem::Motion;
use crate::task::Task;

/// ZYX Euler angles of the base over time; dotted lines are the goal's.
pub fn base_attitude(motion: &Motion, task: &Task) -> Figure {
    let end = motion.time.last().copied().unwrap_or(1.0);
    let (roll, pitch, yaw) = task.goal.base.euler_angles();
    let mut goals = [yaw, pitch, roll].map(f64::to_degrees).to_vec();
    goals.dedup();
    let mut lines: Vec<Line> = Vec::new();
    let angles = motion.base_zyx();
    for (k, name) in ["yaw ψ", "pitch ϑ", "roll φ"].into_iter().enumerate() {
        let values = angles.iter().map(|zyx| zyx[k].to_degrees());
        let points = motion.time.iter().zip(values).map(|(t, v)| [*t, v]).collect();
        lines.push(Line { name: name.to_owned(), stroke: Stroke::of(k), points });
    }
    for (i, angle) in goals.into_iter().enumerate() {
        let name = if i == 0 { "goal" } else { "" }.to_owned();
        let points = vec![[0.0, angle], [end, angle]];
        lines.push(Line { name, stroke: Stroke::reference(), points });
    }
    let panel = Panel {
        x: Axis::linear("time t [s]", [0.0, end], 0.0),
        y: Axis::linear("base Euler angle [°]", extent(&lines), MARGIN),
        bands: Vec::new(),
        lines,
    };
    Figure { panels: vec![panel], panel_height: 54.0 }
}
