//! What stands between a panel's axes.

use plotters::style::RGBColor;

use super::error::FigureError;
use super::sheet::{Anchor, Place, Sheet};
use super::style::{GRID, INK_ON_COLOUR, Marker, PAPER, Stroke, mix};

/// One mark; abscissae and ordinates are values of the panel's axes.
#[derive(Debug, Clone)]
pub(crate) enum Mark {
    Line(Line),
    /// The area between two curves over the same abscissae: `[x, lower, upper]`.
    Band {
        colour: RGBColor,
        points: Vec<[f64; 3]>,
    },
    /// Points alone.
    Points {
        name: String,
        stroke: Stroke,
        points: Vec<[f64; 2]>,
    },
    /// A horizontal box at a height: least value, quartiles, largest value.
    Box {
        stroke: Stroke,
        height: f64,
        five: [f64; 5],
    },
    /// A filled unit square about a point, with a text.
    Cell {
        at: [f64; 2],
        colour: RGBColor,
        text: String,
        points: f64,
    },
    /// A filled polygon.
    Area {
        colour: RGBColor,
        corners: Vec<[f64; 2]>,
    },
    /// A line of the legend that explains no single stroke.
    Note(String),
    /// A text beside a point or centred on it, raised by so much \[mm\].
    Label {
        at: [f64; 2],
        text: String,
        anchor: Anchor,
        raised: f64,
    },
}

/// A line through points.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    /// Shown in the legend, unless empty.
    pub(crate) name: String,
    pub(crate) stroke: Stroke,
    pub(crate) points: Vec<[f64; 2]>,
    /// Where its stroke's marker stands.
    pub(crate) marked: Marked,
}

/// Where a line has markers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Marked {
    /// At every point.
    Points,
    /// At even distances across, begun at this share of one, so that lines on each other can be told apart.
    Evenly(f64),
}

/// Distance between markers \[mm\].
const MARKER_DISTANCE: f64 = 13.0;
/// Half the height of a box, where names are one apart.
const BOX: f64 = 0.3;
/// Room between a label and its point \[mm\].
const LABEL_GAP: f64 = 1.2;
/// Opacity of a band.
const BAND: f64 = 0.18;

impl Line {
    /// A line without markers.
    pub(crate) fn new(name: &str, stroke: Stroke, points: Vec<[f64; 2]>) -> Self {
        Self { name: name.to_owned(), stroke, points, marked: Marked::Points }
    }

    /// The `index`-th of several lines that are no optimisers, with a marker here and there, so that a grey copy tells them apart.
    pub(crate) fn of(index: usize, name: &str, points: Vec<[f64; 2]>) -> Self {
        let stroke = Stroke::of(index).with_marker(Marker::ALL[index % Marker::ALL.len()]);
        let marked = Marked::Evenly((index as f64 * 0.382).fract());
        Self { name: name.to_owned(), stroke, points, marked }
    }

    /// Values at given times.
    pub(crate) fn over_time(
        index: usize,
        name: &str,
        time: &[f64],
        values: impl Iterator<Item = f64>,
    ) -> Self {
        Self::of(index, name, time.iter().zip(values).map(|(t, v)| [*t, v]).collect())
    }

    /// A reference at one height.
    pub(crate) fn level(name: &str, height: f64, [from, to]: [f64; 2]) -> Self {
        Self::new(name, Stroke::reference(), vec![[from, height], [to, height]])
    }

    fn draw(
        &self,
        sheet: &Sheet<'_>,
        place: &impl Fn([f64; 2]) -> Place,
    ) -> Result<(), FigureError> {
        let places: Vec<Place> = self.points.iter().copied().map(place).collect();
        sheet.line(&places, &self.stroke)?;
        if let (None, [at]) = (self.stroke.marker, &places[..]) {
            return sheet.marker(*at, &self.stroke.with_marker(Marker::Circle));
        }
        let marked = match self.marked {
            _ if self.stroke.marker.is_none() => Vec::new(),
            Marked::Points => places,
            Marked::Evenly(first) => evenly(&places, first * MARKER_DISTANCE),
        };
        marked.into_iter().try_for_each(|at| sheet.marker(at, &self.stroke))
    }
}

/// Places on a line, at even distances across; of a line too short for that its end.
fn evenly(places: &[Place], first: f64) -> Vec<Place> {
    let Some([start, _]) = places.first() else { return Vec::new() };
    let mut marked = Vec::new();
    let mut next = start + first;
    for ends in places.windows(2) {
        let ([x, y], [to_x, to_y]) = (ends[0], ends[1]);
        while next <= to_x && to_x > x {
            let share = (next - x) / (to_x - x);
            marked.push([next, y + share * (to_y - y)]);
            next += MARKER_DISTANCE;
        }
    }
    if marked.is_empty() {
        marked.extend(places.last());
    }
    marked
}

impl Mark {
    /// What the legend says of it, if anything.
    pub(crate) fn legend(&self) -> Option<(&str, Option<&Stroke>)> {
        let (name, stroke) = match self {
            Self::Line(Line { name, stroke, .. }) | Self::Points { name, stroke, .. } => {
                (name, Some(stroke))
            }
            Self::Note(text) => (text, None),
            _ => return None,
        };
        (!name.is_empty()).then_some((name, stroke))
    }

    /// Gives it another colour.
    pub(crate) fn recolour(&mut self, of: impl Fn(RGBColor) -> RGBColor) {
        let colour = match self {
            Self::Line(Line { stroke, .. })
            | Self::Points { stroke, .. }
            | Self::Box { stroke, .. } => &mut stroke.colour,
            Self::Band { colour, .. } | Self::Area { colour, .. } => colour,
            Self::Cell { .. } | Self::Note(_) | Self::Label { .. } => return,
        };
        *colour = of(*colour);
    }

    /// Draws it, given where the axes' values are.
    pub(crate) fn draw(
        &self,
        sheet: &Sheet<'_>,
        place: &impl Fn([f64; 2]) -> Place,
    ) -> Result<(), FigureError> {
        match self {
            Self::Line(line) => line.draw(sheet, place),
            Self::Note(_) => Ok(()),
            Self::Band { colour, points } => {
                let lower = points.iter().map(|[x, low, _]| place([*x, *low]));
                let upper = points.iter().map(|[x, _, high]| place([*x, *high]));
                let outline: Vec<Place> = lower.chain(upper.rev()).collect();
                if let [low, high] = outline[..] {
                    return sheet.line(&[low, high], &Stroke::plain(*colour, 0.2));
                }
                sheet.area(&outline, *colour, BAND)
            }
            Self::Points { stroke, points, .. } => {
                points.iter().try_for_each(|point| sheet.marker(place(*point), stroke))
            }
            Self::Box { stroke, height, five } => draw_box(sheet, place, stroke, *height, *five),
            Self::Cell { at: [x, y], colour, text, points } => {
                let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
                let corners = corners.map(|[a, b]| place([x + a, y + b]));
                sheet.area(&corners, *colour, 1.0)?;
                let outline = [corners[0], corners[1], corners[2], corners[3], corners[0]];
                sheet.line(&outline, &Stroke::plain(PAPER, 0.15))?;
                let ink = if luminance(*colour) > 0.2 { INK_ON_COLOUR } else { PAPER };
                sheet.sized_text(text, place([*x, *y]), Anchor::Centre, *points, ink)
            }
            Self::Area { colour, corners } => {
                let corners: Vec<Place> = corners.iter().copied().map(place).collect();
                sheet.area(&corners, *colour, 1.0)
            }
            Self::Label { at, text, anchor, raised } => {
                let [x, y] = place(*at);
                let gap = match anchor {
                    Anchor::Left => LABEL_GAP,
                    Anchor::Centre => 0.0,
                    Anchor::Right => -LABEL_GAP,
                };
                sheet.text(text, [x + gap, y - raised], *anchor)
            }
        }
    }
}

fn draw_box(
    sheet: &Sheet<'_>,
    place: &impl Fn([f64; 2]) -> Place,
    stroke: &Stroke,
    height: f64,
    [least, low, median, high, largest]: [f64; 5],
) -> Result<(), FigureError> {
    let outline = Stroke::plain(stroke.colour, 0.25);
    let at = |x: f64, share: f64| place([x, height + share * BOX]);
    let corners = [at(low, -1.0), at(high, -1.0), at(high, 1.0), at(low, 1.0), at(low, -1.0)];
    sheet.line(&[at(least, 0.0), at(low, 0.0)], &outline)?;
    sheet.line(&[at(high, 0.0), at(largest, 0.0)], &outline)?;
    for end in [least, largest] {
        sheet.line(&[at(end, -0.5), at(end, 0.5)], &outline)?;
    }
    sheet.area(&corners[..4], mix(stroke.colour, PAPER, 0.75), 1.0)?;
    sheet.line(&corners, &outline)?;
    sheet.line(&[at(median, -1.0), at(median, 1.0)], &Stroke::plain(stroke.colour, 0.5))
}

/// Relative luminance (WCAG 2.2).
fn luminance(RGBColor(r, g, b): RGBColor) -> f64 {
    let linear = |part: u8| {
        let part = f64::from(part) / 255.0;
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    };
    0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
}

/// A grid line.
pub(crate) fn grid() -> Stroke {
    Stroke::plain(GRID, 0.12)
}

#[cfg(test)]
mod tests {
    use super::evenly;

    #[test]
    fn short_lines_have_a_marker() {
        assert_eq!(evenly(&[[3.0, 1.0]], 5.0), [[3.0, 1.0]]);
        assert_eq!(evenly(&[[3.0, 1.0], [7.0, 2.0]], 5.0), [[7.0, 2.0]]);
        assert_eq!(evenly(&[[0.0, 0.0], [10.0, 20.0]], 5.0), [[5.0, 10.0]]);
        assert!(evenly(&[], 5.0).is_empty());
    }
}
