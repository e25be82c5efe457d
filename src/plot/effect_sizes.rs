//! Every two optimisers beside each other.

use plotters::style::RGBColor;
use polars::prelude::DataFrame;

use super::curves::{reals, texts};
use super::looks::Looks;
use crate::analysis::ALPHA;
use crate::figure::axis::{Axis, LONGEST_NAME};
use crate::figure::marks::Mark;
use crate::figure::panel::Panel;
use crate::figure::style::{COLOURS, GRID, PAPER, TEXT_PT, Width, mix};
use crate::figure::text::{fitted_apart, text_width};
use crate::figure::{Figure, FigureError};

/// Height of a line \[mm\].
const ROW: f64 = 4.6;
/// Text of a cell, the largest that fits \[pt\], and room between two \[mm\].
const TEXTS: [f64; 3] = [7.0, 6.5, 6.0];
const GAP: f64 = 0.8;
/// What stands beside the cells but for the names \[mm\].
const BESIDE: f64 = 6.0;

/// Vargha and Delaney's A12 of every two optimisers as a heat map, from the table `pairs`, in the order of the
/// table `ranks`: the probability that a run of the row's ends lower than one of the column's. A star marks pairs that
/// differ significantly; pairs that do not are pale. Where cells are too narrow for numbers, colours alone tell.
pub(super) fn effect_sizes(
    pairs: &DataFrame,
    ranks: &DataFrame,
    looks: &Looks,
) -> Result<Figure, FigureError> {
    let order = texts(ranks, "optimiser")?;
    let place = |label: &String| order.iter().position(|name| name == label).unwrap_or_default();
    let (first, second) = (texts(pairs, "first")?, texts(pairs, "second")?);
    let (effects, p) = (reals(pairs, "A12")?, reals(pairs, "p Holm")?);
    let count = order.len();
    let names: Vec<String> = order.iter().map(|label| looks.name(label).to_owned()).collect();
    let numbered = |(i, name): (usize, &String)| format!("{name}\u{2002}{}", i + 1);
    let room = LONGEST_NAME - text_width(&format!("\u{2002}{count}"), TEXT_PT);
    let names: Vec<String> = fitted_apart(&names, room).iter().enumerate().map(numbered).collect();
    let widest = names.iter().map(|name| text_width(name, TEXT_PT)).fold(0.0, f64::max);
    let cell = |width: Width| (width.mm() - widest - BESIDE) / count as f64;
    let shown: Vec<(f64, bool)> = effects
        .iter()
        .zip(&p)
        .flat_map(|(&effect, &p)| [(effect, p <= ALPHA), (1.0 - effect, p <= ALPHA)])
        .collect();
    let (width, cell_text) = match CellText::within(cell(Width::Column), &shown) {
        Some(own) => (Width::Column, Some(own)),
        None => (Width::Page, CellText::within(cell(Width::Page), &shown)),
    };
    let cell = |row: usize, column: usize, colour: RGBColor, effect: Option<(f64, bool)>| {
        let text =
            effect.zip(cell_text.as_ref()).map(|((effect, star), own)| own.text(effect, star));
        let points = cell_text.as_ref().map_or(TEXT_PT, |own| own.points);
        let at = [column as f64, row as f64];
        Mark::Cell { at, colour, text: text.unwrap_or_default(), points }
    };
    let mut marks: Vec<Mark> = (0..count).map(|i| cell(i, i, GRID, None)).collect();
    for (i, (first, second)) in first.iter().zip(&second).enumerate() {
        let (row, column) = (place(first), place(second));
        for (row, column, effect) in [(row, column, effects[i]), (column, row, 1.0 - effects[i])] {
            let is_significant = p[i] <= ALPHA;
            let colour = shade(effect, is_significant);
            marks.push(cell(row, column, colour, Some((effect, is_significant))));
        }
    }
    let numbers: Vec<String> = (1..=count).map(|n| n.to_string()).collect();
    let star = if cell_text.is_some() { "*, strong: significant" } else { "strong: significant" };
    for note in [format!("{star} (Wilcoxon–Holm, {ALPHA})"), "pale: not".to_owned()] {
        marks.push(Mark::Note(note));
    }
    let x = Axis::names("the row's runs end lower than the column's", &numbers);
    let panel = Panel::new(x, Axis::names("", &names).reversed(), marks);
    Ok(Figure { width, across: 1, height: ROW * count as f64, panels: vec![panel] })
}

/// How numbers stand in cells.
struct CellText {
    /// Text size \[pt\].
    points: f64,
    /// Whether 0.93 is .93.
    is_short: bool,
}

impl CellText {
    /// The largest with which all of some effects, and whether these are significant, fit cells of this width \[mm\], if there
    /// is one.
    fn within(width: f64, effects: &[(f64, bool)]) -> Option<Self> {
        let mut choices = [false, true]
            .into_iter()
            .flat_map(|is_short| TEXTS.into_iter().map(move |points| Self { points, is_short }));
        choices.find(|choice| {
            let fits = |&(effect, is_significant): &(f64, bool)| {
                text_width(&choice.text(effect, is_significant), choice.points) + GAP <= width
            };
            effects.iter().all(fits)
        })
    }

    fn text(&self, effect: f64, is_significant: bool) -> String {
        let star = if is_significant { "*" } else { "" };
        let text = format!("{effect:.2}{star}");
        let short = text.strip_prefix('0').filter(|_| self.is_short).map(ToOwned::to_owned);
        short.unwrap_or(text)
    }
}

/// Blue where the row is lower, orange where the column is.
fn shade(effect: f64, is_significant: bool) -> RGBColor {
    let end = if effect > 0.5 { COLOURS[0] } else { COLOURS[1] };
    let strength = (2.0 * effect - 1.0).abs() * if is_significant { 0.85 } else { 0.35 };
    mix(mix(PAPER, GRID, 0.3), end, strength)
}
