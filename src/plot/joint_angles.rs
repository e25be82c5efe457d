//! Joint angles over time: the paper's Figure 4.

use super::figure::Figure;
use super::panel::{Axis, Line, Panel};
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
        let points = motion.time.iter().zip(values).map(|(t, v)| [*t, v]).collect();
        lines.push(Line { name: joint.name.clone(), stroke: Stroke::of(i), points });
    }
    for limit in limits.iter().flat_map(|limit| [-limit, *limit]) {
        let points = vec![[0.0, limit], [end, limit]];
        let name = if limits.first() == Some(&-limit) { "limit" } else { "" }.to_owned();
        lines.push(Line { name, stroke: Stroke::reference(), points });
    }
    Panel {
        x: Axis::linear("time t [s]", [0.0, end], 0.0),
        y: Axis::linear(label, extent(&lines), MARGIN),
        bands: Vec::new(),
        lines,
    }
}

/// Free share of a vertical axis above and below its lines.
pub(super) const MARGIN: f64 = 0.04;

/// The smallest and the largest ordinate of all lines.
pub(super) fn extent(lines: &[Line]) -> [f64; 2] {
    let values = lines.iter().flat_map(|line| line.points.iter().map(|[_, y]| *y));
    let [low, high] =
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], y| [l.min(y), h.max(y)]);
    if high - low > 1e-9 { [low, high] } else { [low - 1.0, high + 1.0] }
}
