//! How charts look in print: one journal column wide, 8-point text, colours that a colour-blind
//! reader can tell apart, dashes that a grey copy keeps apart.

use plotters::style::{Color as _, IntoFont as _, RGBColor, ShapeStyle};

/// Drawing units a millimetre. Plotters draws on whole units; this many make curves smooth.
pub(super) const UNITS_PER_MM: f64 = 40.0;

/// Width of one journal column \[mm\].
pub(super) const COLUMN_MM: f64 = 88.0;

/// The family name of the embedded font.
pub(super) const FONT: &str = "Noto Sans";

/// Text size \[pt\].
const TEXT_PT: f64 = 7.5;

/// Millimetres a point.
const MM_PER_PT: f64 = 25.4 / 72.0;

/// Ink for axes and text.
pub(super) const INK: RGBColor = RGBColor(38, 38, 38);

/// Grid lines.
pub(super) const GRID: RGBColor = RGBColor(222, 222, 222);

/// Okabe and Ito's colours without the yellow, which is too light for a line on white; black last.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Dash and gap \[mm\]; nothing is a solid line.
const DASHES: [Option<(f64, f64)>; 3] = [None, Some((2.0, 0.8)), Some((0.7, 0.6))];

/// Millimetres in drawing units.
pub(super) fn units(mm: f64) -> i32 {
    (mm * UNITS_PER_MM).round() as i32
}

/// Text height in plotters' measure, which is 1.24 times the font size.
pub(super) fn text_size() -> f64 {
    TEXT_PT * MM_PER_PT * UNITS_PER_MM * 1.24
}

/// Width of a text as drawn. Plotters measures at a font size that makes ascent and descent together
/// as high as its text size, 1.362 em for this font; it draws at the size divided by 1.24.
pub(super) fn text_width(text: &str) -> i32 {
    let font = (FONT, text_size()).into_font();
    let measured = font.box_size(text).map_or(0.0, |(width, _)| f64::from(width));
    (measured * 1.362 / 1.24).round() as i32
}

/// How one line is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stroke {
    pub(super) colour: RGBColor,
    /// Width \[mm\].
    pub(super) width: f64,
    /// Dash and gap \[mm\].
    pub(super) dash: Option<(f64, f64)>,
}

impl Stroke {
    /// The stroke of the `index`-th line of a chart.
    pub(super) fn of(index: usize) -> Self {
        let colour = COLOURS[index % COLOURS.len()];
        Self { colour, width: 0.32, dash: DASHES[index % DASHES.len()] }
    }

    /// A thin line that refers to something, such as a limit.
    pub(super) fn reference() -> Self {
        Self { colour: INK, width: 0.2, dash: Some((0.6, 0.5)) }
    }

    pub(super) fn shape(&self) -> ShapeStyle {
        self.colour.stroke_width(units(self.width).unsigned_abs())
    }
}
