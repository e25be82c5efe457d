//! What is drawn on: millimetres from the upper left corner.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::usvg;

use super::error::FigureError;
use super::style::{Dashes, INK, PAPER, Stroke, TEXT_PT};
use super::text::{FONT, LEVEL, LOWERED, RAISED, SMALL, UNITS_PER_MM, drawable, fonts, text_size};

/// Radius of a marker \[mm\].
const MARKER: f64 = 0.62;

/// A place \[mm\] from the upper left corner: to the right, down.
pub(crate) type Place = [f64; 2];

/// Which side of a text is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Left,
    Centre,
    Right,
}

/// A drawing in the making.
pub(crate) struct Sheet<'a>(DrawingArea<SVGBackend<'a>, Shift>);

fn units(mm: f64) -> i32 {
    (mm * UNITS_PER_MM).round() as i32
}

fn on_grid([x, y]: Place) -> (i32, i32) {
    (units(x), units(y))
}

impl Sheet<'_> {
    /// An SVG of this size \[mm\], drawn by `draw` and read with the embedded font.
    pub(crate) fn drawn(
        width: f64,
        height: f64,
        draw: impl FnOnce(&Sheet<'_>) -> Result<(), FigureError>,
    ) -> Result<usvg::Tree, FigureError> {
        let fonts = fonts();
        let (w, h) = (units(width).unsigned_abs(), units(height).unsigned_abs());
        let mut drawing = String::new();
        {
            let sheet = Sheet(SVGBackend::with_string(&mut drawing, (w, h)).into_drawing_area());
            sheet.0.fill(&PAPER)?;
            draw(&sheet)?;
            sheet.0.present()?;
        }
        let in_units = format!("width=\"{w}\" height=\"{h}\"");
        let in_mm = format!("width=\"{width}mm\" height=\"{height}mm\"");
        let small = |shift: &str| {
            format!("<tspan baseline-shift=\"{shift}\" font-size=\"{}%\">", 100.0 * SMALL)
        };
        let drawing = drawing
            .replacen(&in_units, &in_mm, 1)
            .replace(LOWERED, &small("-25%"))
            .replace(RAISED, &small("35%"))
            .replace(LEVEL, "</tspan>");
        let options = usvg::Options { fontdb: fonts, ..usvg::Options::default() };
        usvg::Tree::from_str(&drawing, &options)
            .map_err(|e| FigureError::Convert { format: "SVG", reason: e.to_string() })
    }

    /// A line through places.
    pub(crate) fn line(&self, places: &[Place], stroke: &Stroke) -> Result<(), FigureError> {
        let style = stroke.colour.stroke_width(units(stroke.width).unsigned_abs());
        for piece in dashed(&simplified(places), stroke.dashes) {
            let mut piece: Vec<_> = piece.into_iter().map(on_grid).collect();
            piece.dedup();
            if piece.len() > 1 {
                self.0.draw(&PathElement::new(piece, style))?;
            }
        }
        Ok(())
    }

    /// A filled polygon.
    pub(crate) fn area(
        &self,
        corners: &[Place],
        colour: RGBColor,
        opacity: f64,
    ) -> Result<(), FigureError> {
        let corners: Vec<_> = simplified(corners).into_iter().map(on_grid).collect();
        Ok(self.0.draw(&Polygon::new(corners, colour.mix(opacity).filled()))?)
    }

    /// A point in its stroke's shape, unless it has none.
    pub(crate) fn marker(&self, [x, y]: Place, stroke: &Stroke) -> Result<(), FigureError> {
        let Some(marker) = stroke.marker else { return Ok(()) };
        let corners: Vec<Place> =
            marker.outline().iter().map(|[a, b]| [x + MARKER * a, y + MARKER * b]).collect();
        if !stroke.hollow {
            return self.area(&corners, stroke.colour, 1.0);
        }
        self.area(&corners, PAPER, 1.0)?;
        let closed: Vec<Place> = corners.iter().chain(&corners[..1]).copied().collect();
        self.line(&closed, &Stroke::plain(stroke.colour, 0.22))
    }

    /// A text in ink, its middle at the height of the place.
    pub(crate) fn text(&self, text: &str, at: Place, anchor: Anchor) -> Result<(), FigureError> {
        self.sized_text(text, at, anchor, TEXT_PT, INK)
    }

    /// A text of some size \[pt\] and colour, its middle at the height of the place.
    pub(crate) fn sized_text(
        &self,
        text: &str,
        at: Place,
        anchor: Anchor,
        points: f64,
        colour: RGBColor,
    ) -> Result<(), FigureError> {
        let pos = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Centre => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let style = (FONT, text_size(points)).into_font().color(&colour);
        let style = style.pos(Pos::new(pos, VPos::Center));
        Ok(self.0.draw_text(&drawable(text), &style, on_grid(at))?)
    }

    /// A text that is read upwards, its middle at the place.
    pub(crate) fn upright_text(&self, text: &str, at: Place) -> Result<(), FigureError> {
        let style = (FONT, text_size(TEXT_PT)).into_font().color(&INK);
        let style = style.transform(FontTransform::Rotate270);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        Ok(self.0.draw_text(&drawable(text), &style, on_grid(at))?)
    }
}

/// A line without the places that are nearer than half a drawing unit to the line without them.
///
/// Douglas and Peucker (1973), doi 10.3138/FM57-6770-U75U-7727.
fn simplified(places: &[Place]) -> Vec<Place> {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return Vec::new() };
    let mut kept = vec![*first];
    let mut parts = vec![places];
    while let Some(part) = parts.pop() {
        let ends = [part[0], part[part.len() - 1]];
        let distances = part.iter().map(|place| distance(*place, ends));
        let farthest = distances.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        match farthest {
            Some((i, distance)) if distance > 0.5 / UNITS_PER_MM => {
                parts.push(&part[i..]);
                parts.push(&part[..=i]);
            }
            _ => kept.push(ends[1]),
        }
    }
    debug_assert_eq!(kept.last(), Some(last));
    kept
}

/// How far a place is from a piece of line.
fn distance([x, y]: Place, [[from_x, from_y], [to_x, to_y]]: [Place; 2]) -> f64 {
    let (along_x, along_y) = (to_x - from_x, to_y - from_y);
    let square = along_x * along_x + along_y * along_y;
    let share = if square > 0.0 {
        (((x - from_x) * along_x + (y - from_y) * along_y) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (x - from_x - share * along_x).hypot(y - from_y - share * along_y)
}

/// The pieces of a line that its dashes leave.
fn dashed(places: &[Place], dashes: Dashes) -> Vec<Vec<Place>> {
    if dashes.is_empty() {
        return vec![places.to_vec()];
    }
    let mut pieces = Vec::new();
    let mut piece: Vec<Place> = places.iter().copied().take(1).collect();
    let (mut turn, mut left) = (0, dashes[0]);
    for ends in places.windows(2) {
        let ([x, y], [to_x, to_y]) = (ends[0], ends[1]);
        let length = (to_x - x).hypot(to_y - y);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let here = [x + (to_x - x) * done / length, y + (to_y - y) * done / length];
            // Dashes at even turns, gaps at odd ones.
            if turn % 2 == 0 {
                piece.push(here);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![here];
            }
            turn += 1;
            left = dashes[turn % dashes.len()];
        }
        left -= length - done;
        if turn % 2 == 0 {
            piece.push(ends[1]);
        }
    }
    pieces.push(piece);
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::{dashed, simplified};

    #[test]
    fn simpler_lines_keep_their_corners() {
        let steps = [[0.0, 0.0], [1.0, 0.001], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [3.0, 2.0]];
        assert_eq!(simplified(&steps), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [3.0, 2.0]]);
        let closed = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        assert_eq!(simplified(&closed), closed);
        assert!(simplified(&[]).is_empty());
    }

    #[test]
    fn dashes_go_round_corners() {
        let corner = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0]];
        let pieces = dashed(&corner, &[2.0, 0.5]);
        assert_eq!(pieces[0], [[0.0, 0.0], [2.0, 0.0]]);
        assert_eq!(pieces[1], [[2.5, 0.0], [3.0, 0.0], [3.0, 1.5]]);
        assert_eq!(pieces[2], [[3.0, 2.0], [3.0, 3.0]]);
        assert_eq!(dashed(&corner, &[]), [corner]);
    }
}
