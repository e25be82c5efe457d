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
    /// Red, green and blue in the order in which lines take colours; they begin anew where they are too few. Without any, those
    /// of `okabe-ito`.
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
    /// The charts asked for, drawn as asked.
    pub(super) fn applied(&self, charts: Vec<Chart>) -> Result<Vec<Chart>, ReportError> {
        let names: Vec<&str> = charts.iter().map(|chart| chart.name.as_str()).collect();
        if let Some(missing) = self.only.iter().find(|name| !names.contains(&name.as_str())) {
            return Err(ReportError::NoChart { name: missing.clone(), known: names.join(", ") });
        }
        let is_asked = |chart: &Chart| self.only.is_empty() || self.only.contains(&chart.name);
        let drawn = |mut chart: Chart| {
            let figure = chart.figure.with_linear_axes(self.linear);
            chart.figure = figure.recoloured(|colour| self.colour(colour));
            chart
        };
        Ok(charts.into_iter().filter(is_asked).map(drawn).collect())
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
