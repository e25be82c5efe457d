//! Joint angles over time: the paper's Figure 4.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent};
use crate::figure::style::Stroke;
use crate::figure::text::printable;
use crate::reorientation::motion::Motion;

/// Joint angles over time.
pub(super) fn joint_angles(motion: &Motion) -> Figure {
    Figure::column(vec![joint_panel(motion, 0, "joint angle θ [°]", &[])], 44.0)
}

/// One derivative of every joint's angle over time \[°, s\], with limits where there are any.
pub(super) fn joint_panel(motion: &Motion, order: usize, label: &str, limits: &[f64]) -> Panel {
    let mut lines: Vec<Line> = Vec::new();
    let end = motion.time.last().copied().unwrap_or(1.0);
    for (i, joint) in motion.joints.iter().enumerate() {
        let values = joint.derivatives.iter().map(|d| d[order].to_degrees());
        lines.push(Line::over_time(&printable(&joint.name), Stroke::of(i), &motion.time, values));
    }
    for limit in limits.iter().flat_map(|limit| [-limit, *limit]) {
        let name = if limits.first() == Some(&-limit) { "limit" } else { "" };
        lines.push(Line::level(name, limit, [0.0, end]));
    }
    let x = Axis::linear("time t [s]", [0.0, end], 0.0);
    let y = Axis::linear(label, extent(&lines), MARGIN);
    Panel::new(x, y, lines.into_iter().map(Mark::Line).collect())
}
