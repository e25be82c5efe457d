//! Joint angles over time: the paper's Figure 4.

use super::figure::Figure;
use super::panel::{Axis, Line, MARGIN, Panel, extent};
use super::style::Stroke;
use crate::problem::Motion;

/// Joint angles over time.
pub fn joint_angles(motion: &Motion) -> Figure {
    Figure { panels: vec![joint_panel(motion, 0, "joint angle θ [°]", &[])], panel_height: 54.0 }
}

/// One derivative of every joint's angle over time \[°, s\], with limits where there are any.
pub(super) fn joint_panel(motion: &Motion, order: usize, label: &str, limits: &[f64]) -> Panel {
    let mut lines: Vec<Line> = Vec::new();
    let end = motion.time.last().copied().unwrap_or(1.0);
    for (i, joint) in motion.joints.iter().enumerate() {
        let values = joint.derivatives.iter().map(|d| d[order].to_degrees());
        lines.push(Line::over_time(&joint.name, Stroke::of(i), &motion.time, values));
    }
    for limit in limits.iter().flat_map(|limit| [-limit, *limit]) {
        let name = if limits.first() == Some(&-limit) { "limit" } else { "" };
        lines.push(Line::level(name, limit, end));
    }
    Panel {
        title: String::new(),
        x: Axis::linear("time t [s]", [0.0, end], 0.0),
        y: Axis::linear(label, extent(&lines), MARGIN),
        bands: Vec::new(),
        lines,
    }
}
