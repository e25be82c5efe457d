//! How charts look in print: one or two journal columns wide, 7.5-point text, colours that a
//! colour-blind reader can tell apart, dashes and markers that a grey copy keeps apart.

use plotters::style::RGBColor;

/// Width of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Width {
    /// One journal column.
    Column,
    /// Two journal columns, the page.
    Page,
}

impl Width {
    /// In millimetres.
    pub(crate) fn mm(self) -> f64 {
        match self {
            Self::Column => 88.0,
            Self::Page => 180.0,
        }
    }
}

/// Text size \[pt\].
pub(crate) const TEXT_PT: f64 = 7.5;

/// Ink for axes and text.
pub(crate) const INK: RGBColor = RGBColor(38, 38, 38);
/// Ink on a coloured ground; a page in dark colours turns the other ink light.
pub(crate) const INK_ON_COLOUR: RGBColor = RGBColor(30, 30, 30);
/// Grid lines.
pub(crate) const GRID: RGBColor = RGBColor(222, 222, 222);
/// Curves in the background.
pub(crate) const FAINT: RGBColor = RGBColor(200, 200, 200);
/// What lies under everything.
pub(crate) const PAPER: RGBColor = RGBColor(255, 255, 255);

/// Okabe and Ito's colours without the yellow, which is too light for a line on white, black and grey; then Paul Tol's dark
/// green (SRON/EPS/TN/09-002) and a violet.
pub(crate) const COLOURS: [RGBColor; 10] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(140, 140, 140),
    RGBColor(17, 119, 51),
    RGBColor(136, 46, 186),
];

/// Colours of what comes from other programs: unlike those above and unlike each other, from Paul Tol's muted scheme
/// (SRON/EPS/TN/09-002).
pub(crate) const OUTSIDE_COLOURS: [RGBColor; 4] =
    [RGBColor(136, 34, 85), RGBColor(153, 153, 51), RGBColor(51, 34, 136), RGBColor(102, 37, 6)];

/// What colours are mixed with where lines are paler or darker, and by which share; the first leaves them as they are.
pub(crate) const SHADES: [(RGBColor, f64); 4] =
    [(PAPER, 0.0), (PAPER, 0.4), (PAPER, 0.55), (INK, 0.5)];

/// Lengths of dashes and gaps, in turn \[mm\]; none is a solid line.
pub(crate) type Dashes = &'static [f64];

/// Solid, dashed, dotted, dash-dotted.
pub(crate) const DASHES: [Dashes; 4] = [&[], &[2.0, 0.8], &[0.6, 0.6], &[2.4, 0.7, 0.6, 0.7]];

/// Of lines that are no optimisers, as many as colours, so that a grey copy tells seven apart: solid, dashed, dash-dotted, long
/// dashes, short ones, dash-dot-dotted, and long beside short. Dots refer to something.
const LINES: [Dashes; 7] = [
    &[],
    &[2.0, 0.8],
    &[2.4, 0.7, 0.6, 0.7],
    &[5.0, 0.9],
    &[1.0, 1.0],
    &[2.4, 0.6, 0.6, 0.6, 0.6, 0.6],
    &[4.0, 0.8, 1.4, 0.8],
];

/// The shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marker {
    Circle,
    Square,
    Diamond,
    Up,
    Down,
    Plus,
    Cross,
    Star,
    Left,
    Right,
}

impl Marker {
    pub(crate) const ALL: [Self; 10] = [
        Self::Circle,
        Self::Square,
        Self::Up,
        Self::Diamond,
        Self::Down,
        Self::Plus,
        Self::Cross,
        Self::Star,
        Self::Left,
        Self::Right,
    ];

    /// Corners of the shape, in units of its radius.
    pub(crate) fn outline(self) -> Vec<[f64; 2]> {
        let on_circle = |count: usize, first_deg: f64, radius: &dyn Fn(usize) -> f64| {
            let corner = |i: usize| {
                let angle = (first_deg + 360.0 * i as f64 / count as f64).to_radians();
                [radius(i) * angle.cos(), radius(i) * angle.sin()]
            };
            (0..count).map(corner).collect::<Vec<_>>()
        };
        // Three corners of each of the four arms' notches, the inner one nearer.
        let cross = |turn_deg: f64| {
            let arms =
                (0..4).flat_map(|arm| [(-18.0, 1.1), (18.0, 1.1), (45.0, 0.48)].map(|c| (arm, c)));
            let corner = |(arm, (angle, radius)): (i32, (f64, f64))| {
                let angle = (turn_deg + 90.0 * f64::from(arm) + angle).to_radians();
                [radius * angle.cos(), radius * angle.sin()]
            };
            arms.map(corner).collect::<Vec<_>>()
        };
        match self {
            Self::Circle => on_circle(20, 0.0, &|_| 0.95),
            Self::Square => on_circle(4, 45.0, &|_| 1.2),
            Self::Diamond => on_circle(4, 0.0, &|_| 1.25),
            Self::Up => on_circle(3, -90.0, &|_| 1.25),
            Self::Down => on_circle(3, 90.0, &|_| 1.25),
            Self::Left => on_circle(3, 180.0, &|_| 1.25),
            Self::Right => on_circle(3, 0.0, &|_| 1.25),
            Self::Plus => cross(0.0),
            Self::Cross => cross(45.0),
            Self::Star => on_circle(10, -90.0, &|i| if i % 2 == 0 { 1.35 } else { 0.55 }),
        }
    }
}

/// How one line and its points are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: RGBColor,
    /// Width \[mm\].
    pub(crate) width: f64,
    pub(crate) dashes: Dashes,
    /// The shape of its points, unless it is a line alone.
    pub(crate) marker: Option<Marker>,
    /// Whether its points are outlines.
    pub(crate) hollow: bool,
}

impl Stroke {
    /// A plain solid line.
    pub(crate) const fn plain(colour: RGBColor, width: f64) -> Self {
        Self { colour, width, dashes: &[], marker: None, hollow: false }
    }

    /// The stroke of the `index`-th line of a chart whose lines are no optimisers.
    pub(crate) fn of(index: usize) -> Self {
        let colour = COLOURS[index % LINES.len()];
        let dashes = LINES[(index + index / LINES.len()) % LINES.len()];
        Self { dashes, ..Self::plain(colour, 0.32) }
    }

    /// The same with points.
    pub(crate) fn with_marker(self, marker: Marker) -> Self {
        Self { marker: Some(marker), ..self }
    }

    /// A thin line that refers to something, such as a limit.
    pub(crate) fn reference() -> Self {
        Self { dashes: DASHES[2], ..Self::plain(INK, 0.2) }
    }
}

/// A colour on the way to another, by a share.
pub(crate) fn mix(from: RGBColor, to: RGBColor, share: f64) -> RGBColor {
    let part = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(part(from.0, to.0), part(from.1, to.1), part(from.2, to.2))
}

#[cfg(test)]
mod tests {
    use super::Stroke;

    /// Without colours as with them.
    #[test]
    fn lines_of_seven_joints_are_told_apart_in_grey() {
        let strokes: Vec<Stroke> = (0..49).map(Stroke::of).collect();
        for i in 0..49 {
            for j in 0..i {
                let (a, b) = (strokes[i], strokes[j]);
                assert!(a.dashes != b.dashes || a.colour != b.colour, "{i} and {j}");
                assert!(i >= 7 || a.dashes != b.dashes, "{i} and {j}");
            }
        }
    }
}
