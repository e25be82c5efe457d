//! A chart: a figure and what is said about it.

use std::borrow::Cow;

use super::table::file_name;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, extent, range};
use crate::figure::text::printable;

/// A figure with what goes with it in a report.
#[derive(Debug, Clone)]
pub struct Chart {
    /// Name of its files.
    pub(crate) name: String,
    /// What it shows, in a few words.
    pub(crate) title: String,
    /// How to read it.
    pub(crate) caption: String,
    /// Name of the table it was drawn from.
    pub(crate) table: Cow<'static, str>,
    /// The drawing.
    pub(crate) figure: Figure,
}

impl Chart {
    /// Lines over one abscissa: each with its name and its points, `[x, y]`. `name` is that of the chart's
    /// files, on the terms of [`Table::new`](super::Table::new), `table` that of the table with its data;
    /// `axes` are labels with units.
    pub fn lines(
        [name, title, caption, table]: [&str; 4],
        axes: [&str; 2],
        lines: &[(&str, Vec<[f64; 2]>)],
    ) -> Self {
        let line = |(i, (name, points)): (usize, &(&str, Vec<[f64; 2]>))| {
            Line::of(i, &printable(name), points.clone())
        };
        let lines: Vec<Line> = lines.iter().enumerate().map(line).collect();
        let abscissae = lines.iter().flat_map(|line| line.points.iter().map(|[x, _]| *x));
        let x = Axis::linear(&printable(axes[0]), range(abscissae, f64::NEG_INFINITY), MARGIN);
        let y = Axis::linear(&printable(axes[1]), extent(&lines), MARGIN);
        let panel = Panel::new(x, y, lines.into_iter().map(Mark::Line).collect());
        Self {
            name: file_name(name),
            title: title.to_owned(),
            caption: caption.to_owned(),
            table: file_name(table).into(),
            figure: Figure::column(vec![panel], 44.0),
        }
    }
}
