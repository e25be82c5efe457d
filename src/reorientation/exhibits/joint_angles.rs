//! Joint angles over time: the paper's Figure 4.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent};
use crate::figure::text::printable;
use crate::reorientation::motion::Motion;
use crate::robot::JointKind;

/// Joint angles over time, and below them the distances of joints that slide.
pub(super) fn joint_angles(motion: &Motion) -> Figure {
    let panel = |kind| {
        let label = match kind {
            JointKind::Revolute => "joint angle θ [°]",
            JointKind::Prismatic => "joint distance d [m]",
        };
        joint_panel(motion, kind, 0, label, &[])
    };
    Figure::column(kinds(motion).map(panel).collect(), 44.0)
}

/// The kinds of joints that a motion has.
pub(super) fn kinds(motion: &Motion) -> impl Iterator<Item = JointKind> {
    let kinds = [JointKind::Revolute, JointKind::Prismatic].into_iter();
    kinds.filter(|kind| motion.joints.iter().any(|joint| joint.kind == *kind))
}

/// One derivative of the position of every joint of a kind over time \[° or m, s\], with limits where there are any.
pub(super) fn joint_panel(
    motion: &Motion,
    kind: JointKind,
    order: usize,
    label: &str,
    limits: &[f64],
) -> Panel {
    let mut lines: Vec<Line> = Vec::new();
    let end = motion.time.last().copied().unwrap_or(1.0);
    for (i, joint) in motion.joints.iter().enumerate().filter(|(_, joint)| joint.kind == kind) {
        let values = joint.derivatives.iter().map(|d| kind.to_file_units(d[order]));
        lines.push(Line::over_time(i, &printable(&joint.name), &motion.time, values));
    }
    for limit in limits.iter().flat_map(|limit| [-limit, *limit]) {
        let name = if limits.first() == Some(&-limit) { "limit" } else { "" };
        lines.push(Line::level(name, limit, [0.0, end]));
    }
    let x = Axis::linear("time t [s]", [0.0, end], 0.0);
    let y = Axis::linear(label, extent(&lines), MARGIN);
    Panel::new(x, y, lines.into_iter().map(Mark::Line).collect())
}
