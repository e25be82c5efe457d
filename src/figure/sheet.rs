//! What is drawn on: millimetres from the upper left corner.

use std::collections::{HashMap, HashSet};
use std::sync::{Arc, LazyLock};

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use resvg::usvg;

use super::error::FigureError;
use super::style::{Dashes, INK, PAPER, Stroke, TEXT_PT};

/// Drawing units a millimetre. Plotters draws on whole units; this many make curves smooth.
const UNITS_PER_MM: f64 = 40.0;
/// Millimetres a point.
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The family name of the embedded font.
const FONT: &str = "Noto Sans";
/// Radius of a marker \[mm\].
const MARKER: f64 = 0.62;
/// Size of a lowered or raised text, as a share of the text's: journals want 6 points at least.
const SMALL: f64 = 0.8;
const _: () = assert!(SMALL * TEXT_PT >= 6.0);
/// Most letters of a text that are drawn; more fit no figure.
const MOST_LETTERS: usize = 400;
/// The share of a text cut in the middle that is its end, where settings stand.
const END: f64 = 0.7;

/// The embedded font, for plotters to measure text with and for usvg to draw it.
static FONTS: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    // The bytes are a font, so this cannot fail; if it did, plotters would say so when drawing.
    let _ = plotters::style::register_font(FONT, FontStyle::Normal, notosans::REGULAR_TTF);
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    Arc::new(fonts)
});

/// A place \[mm\] from the upper left corner: to the right, down.
pub(crate) type Place = [f64; 2];

/// Which side of a text is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Left,
    Centre,
    Right,
}

/// What begins and ends a lowered and a raised part of a text: characters that [`printable`] takes away.
const LOWERED: char = '\u{E000}';
const RAISED: char = '\u{E001}';
const LEVEL: char = '\u{E002}';

/// A text of somebody else's, without characters that no drawing can have and those that lower and raise.
pub(crate) fn printable(text: &str) -> String {
    let level = |c: char| if matches!(c, LOWERED | RAISED | LEVEL) { '\u{FFFD}' } else { c };
    drawable(text).chars().map(level).collect()
}

/// A text without characters that no drawing can have.
fn drawable(text: &str) -> String {
    let is_drawable = |c: char| !c.is_control() && !matches!(c, '\u{FFFE}' | '\u{FFFF}');
    text.chars().map(|c| if is_drawable(c) { c } else { '\u{FFFD}' }).collect()
}

/// A raised text.
pub(crate) fn raised(text: &str) -> String {
    format!("{RAISED}{text}{LEVEL}")
}

/// Text size in plotters' measure, which is 1.24 times the font size.
fn text_size(points: f64) -> f64 {
    points * MM_PER_PT * UNITS_PER_MM * 1.24
}

/// Width of a text as drawn \[mm\]. Plotters measures at a font size that makes ascent and descent
/// together as high as its text size, 1.362 em for this font; it draws at the size divided by 1.24.
pub(crate) fn text_width(text: &str, points: f64) -> f64 {
    LazyLock::force(&FONTS);
    let measured = |text: &str| {
        let size = (FONT, text_size(points)).into_font().box_size(text);
        size.map_or(0.0, |(width, _)| f64::from(width)) * 1.362 / 1.24 / UNITS_PER_MM
    };
    let parts = text.split(LEVEL).map(|part| match part.split_once([LOWERED, RAISED]) {
        Some((level, small)) => measured(level) + SMALL * measured(small),
        None => measured(part),
    });
    parts.sum()
}

/// The text, or as much of its beginning as fits a width \[mm\], with an ellipsis.
pub(crate) fn fitted(text: &str, width: f64) -> String {
    cut(text, width, 0.0)
}

/// Texts that fit a width \[mm\]: cut at their ends; where that leaves different ones the same, in the middle; and
/// numbered where even that does.
pub(crate) fn fitted_apart(texts: &[String], width: f64) -> Vec<String> {
    let mut cut_down: Vec<String> = texts.iter().map(|text| fitted(text, width)).collect();
    for i in alike(texts, &cut_down) {
        cut_down[i] = cut(&texts[i], width, END);
    }
    for i in alike(texts, &cut_down) {
        let number = format!(" ({})", i + 1);
        cut_down[i] = fitted(&texts[i], width - text_width(&number, TEXT_PT)) + &number;
    }
    cut_down
}

/// The places of different texts that look the same when cut.
fn alike(texts: &[String], cut_down: &[String]) -> Vec<usize> {
    let mut first: HashMap<&str, &str> = HashMap::new();
    let mut shared: HashSet<&str> = HashSet::new();
    for (text, short) in texts.iter().zip(cut_down) {
        if *first.entry(short).or_insert(text) != text {
            shared.insert(short);
        }
    }
    (0..texts.len()).filter(|&i| shared.contains(cut_down[i].as_str())).collect()
}

/// The text, or as much of its beginning and its end as fits a width \[mm\], with an ellipsis between; `end` is the share
/// of the end.
fn cut(text: &str, width: f64, end: f64) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= MOST_LETTERS && text_width(text, TEXT_PT) <= width {
        return text.to_owned();
    }
    let short = |kept: usize| {
        let behind = (end * kept as f64).round() as usize;
        let before: String = letters[..kept - behind].iter().collect();
        let behind: String = letters[letters.len() - behind..].iter().collect();
        levelled(&format!("{}…{}", before.trim_end(), behind.trim_start()))
    };
    let (mut fits, mut over) = (0, letters.len().min(MOST_LETTERS));
    while over - fits > 1 {
        let middle = usize::midpoint(fits, over);
        if text_width(&short(middle), TEXT_PT) <= width {
            fits = middle;
        } else {
            over = middle;
        }
    }
    short(fits)
}

/// A cut text whose lowered and raised parts end where it does, and begin where they end.
fn levelled(text: &str) -> String {
    let mut is_level = true;
    let mut levelled = String::new();
    for letter in text.chars() {
        let is_end = letter == LEVEL;
        if !(is_end && is_level) {
            levelled.push(letter);
        }
        is_level = is_end || (is_level && !matches!(letter, LOWERED | RAISED));
    }
    if !is_level {
        levelled.push(LEVEL);
    }
    levelled
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
        LazyLock::force(&FONTS);
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
        let options = usvg::Options { fontdb: FONTS.clone(), ..usvg::Options::default() };
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
    use super::{dashed, fitted, fitted_apart, simplified, text_width};
    use crate::figure::style::TEXT_PT;

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

    /// Where the ends tell, they are kept; where nothing that fits does, numbers tell.
    #[test]
    fn texts_that_differ_look_different_when_cut() {
        let long = |end: &str| format!("{} {end}", "a label that is long ".repeat(8));
        let ends = ["cognitive=1.5", "cognitive=2.5", "cognitive=1.5"].map(long);
        let cut = fitted_apart(&ends, 40.0);
        assert!(cut[0].ends_with("cognitive=1.5") && cut[1].ends_with("cognitive=2.5"), "{cut:?}");
        assert_eq!(cut[0], cut[2]);
        let middles = ["b", "c"].map(|middle| long(middle) + &long(""));
        let cut = fitted_apart(&middles, 40.0);
        assert!(cut[0].ends_with("… (1)") && cut[1].ends_with("… (2)"), "{cut:?}");
        assert!(cut.iter().all(|text| text_width(text, TEXT_PT) <= 40.0));
    }

    #[test]
    fn a_very_long_text_is_cut_at_once() {
        let text = "a".repeat(1_000_000);
        assert!(fitted(&text, 50.0).chars().count() < 60);
    }

    /// A lowered part that is cut ends with the text.
    #[test]
    fn what_is_cut_stays_balanced() {
        let text = "K\u{E000}base and more of it\u{E002} and more";
        for width in 3..30 {
            for cut in [fitted(text, f64::from(width)), super::cut(text, f64::from(width), 0.7)] {
                let count = |c: char| cut.chars().filter(|&letter| letter == c).count();
                assert_eq!(count('\u{E000}'), count('\u{E002}'), "{cut:?}");
            }
        }
    }
}
