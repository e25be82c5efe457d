//! Which charts a report has, and how they are drawn.

use plotters::style::RGBColor;

use super::error::ReportError;
use crate::exhibit::Chart;
use crate::figure::style::COLOURS;

/// Which charts a report has, and how they are drawn; by default all, as they are.
#[derive(Debug, Clone, Default)]
pub struct ChartOptions {
    /// Names of the charts to draw; all where there are none.
    pub only: Vec<String>,
    /// Whether logarithmic axes are drawn linear: horizontal ones, vertical ones.
    pub linear: [bool; 2],
    /// Red, green and blue of the optimisers, in the order of the experiment's file, and of other lines, in their order; they
    /// repeat where they are too few. If empty, each kind of optimiser has its own colour of `okabe-ito`.
    pub colours: Vec<[u8; 3]>,
}

/// Named colours; those of `okabe-ito`, the default, are in `figure::style`. `tol-bright` is Paul Tol's bright scheme
/// (SRON/EPS/TN/09-002).
pub const PALETTES: [(&str, &[[u8; 3]]); 3] = [
    ("okabe-ito", &[]),
    (
        "tol-bright",
        &[
            [0x44, 0x77, 0xAA],
            [0xEE, 0x66, 0x77],
            [0x22, 0x88, 0x33],
            [0xCC, 0xBB, 0x44],
            [0x66, 0xCC, 0xEE],
            [0xAA, 0x33, 0x77],
            [0xBB, 0xBB, 0xBB],
        ],
    ),
    ("grey", &[[0, 0, 0], [90, 90, 90], [140, 140, 140], [60, 60, 60], [115, 115, 115]]),
];

/// The colours of a palette.
pub fn palette(name: &str) -> Option<Vec<[u8; 3]>> {
    PALETTES.iter().find(|(own, _)| *own == name).map(|(_, colours)| colours.to_vec())
}

impl ChartOptions {
    /// The charts asked for, with the axes asked for.
    pub(super) fn chosen(&self, charts: Vec<Chart>) -> Result<Vec<Chart>, ReportError> {
        let names: Vec<&str> = charts.iter().map(|chart| chart.name.as_str()).collect();
        if let Some(missing) = self.only.iter().find(|name| !names.contains(&name.as_str())) {
            return Err(ReportError::NoChart { name: missing.clone(), known: names.join(", ") });
        }
        let is_asked = |chart: &Chart| self.only.is_empty() || self.only.contains(&chart.name);
        let drawn =
            |chart: Chart| Chart { figure: chart.figure.with_linear_axes(self.linear), ..chart };
        Ok(charts.into_iter().filter(is_asked).map(drawn).collect())
    }

    /// Charts whose lines are not optimisers, in the colours asked for.
    pub(super) fn recoloured(&self, charts: Vec<Chart>) -> Vec<Chart> {
        let of = |colour| self.colour(colour);
        let recoloured = |chart: Chart| Chart { figure: chart.figure.recoloured(of), ..chart };
        charts.into_iter().map(recoloured).collect()
    }

    /// What a default colour becomes.
    fn colour(&self, colour: RGBColor) -> RGBColor {
        let place = COLOURS.iter().position(|own| *own == colour);
        match place.filter(|_| !self.colours.is_empty()) {
            None => colour,
            Some(place) => {
                let [red, green, blue] = self.colours[place % self.colours.len()];
                RGBColor(red, green, blue)
            }
        }
    }
}
