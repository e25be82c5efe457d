//! What a task limits on the way, over time.

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent};
use crate::figure::style::Stroke;
use crate::reorientation::limited::{Limited, limited};
use crate::reorientation::motion::Motion;
use crate::task::Task;

/// A panel for each limit, which is the dotted line; nothing where there is none.
pub(super) fn on_the_way(motion: &Motion, task: &Task) -> Option<Figure> {
    let limited = limited(task, motion);
    let end = motion.time.last().copied().unwrap_or(1.0);
    let panel = |(index, limited): (usize, &Limited)| {
        let Limited { name, unit, limit, is_least, values, .. } = limited;
        let points = motion.time.iter().zip(values).map(|(time, value)| [*time, *value]);
        let line = Line::new("", Stroke::of(0), points.collect());
        let bound = if *is_least { "least" } else { "limit" };
        let told = if index == 0 || *is_least { bound } else { "" };
        let lines = vec![line, Line::level(told, *limit, [0.0, end])];
        let label = if unit.is_empty() {
            format!("{name}, share of its limit")
        } else {
            format!("{name} [{unit}]")
        };
        let x = Axis::linear("time t [s]", [0.0, end], 0.0);
        let y = Axis::linear(&label, extent(&lines), MARGIN);
        Panel::new(x, y, lines.into_iter().map(Mark::Line).collect())
    };
    let panels: Vec<Panel> = limited.iter().enumerate().map(panel).collect();
    (!panels.is_empty()).then(|| Figure::column(panels, 30.0))
}
