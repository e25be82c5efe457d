//! One pair of axes with its marks.

use super::axis::Axis;
use super::error::FigureError;
use super::marks::{Line, Mark, grid};
use super::sheet::{Anchor, Place, Sheet};
use super::style::{INK, PAPER, Stroke, TEXT_PT};
use super::text::text_width;

/// Height of a line of text \[mm\].
pub(crate) const LINE: f64 = 3.6;
/// Length of a tick, and room between it and its text \[mm\].
const TICK: f64 = 0.8;
const GAP: f64 = 0.7;
/// Room above and to the right of the axes \[mm\].
const MARGIN_TOP: f64 = 1.6;
const MARGIN_RIGHT: f64 = 3.0;
/// Room between a text and the edge \[mm\].
const EDGE: f64 = 0.3;
/// Where the break of an axis stands, from its lower end \[mm\].
const BREAK: f64 = 1.0;
/// Free share of an axis before and behind its lines.
pub(crate) const MARGIN: f64 = 0.04;

/// One pair of axes with its marks.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    /// Stands above the axes, unless empty.
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Drawn in this order.
    pub(crate) marks: Vec<Mark>,
    /// Whether the axes are drawn.
    pub(crate) has_axes: bool,
}

/// Where a panel is and which labels it has.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Left, top, right and lower end of what is between the axes \[mm\].
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
    pub(crate) x_label: bool,
    pub(crate) y_label: bool,
}

impl Panel {
    /// A panel with axes and no title.
    pub(crate) fn new(x: Axis, y: Axis, marks: Vec<Mark>) -> Self {
        Self { title: String::new(), x, y, marks, has_axes: true }
    }

    /// A panel without axes.
    pub(crate) fn bare(x: Axis, y: Axis, marks: Vec<Mark>) -> Self {
        Self { has_axes: false, ..Self::new(x, y, marks) }
    }

    /// The same with a title.
    pub(crate) fn titled(self, title: &str) -> Self {
        Self { title: title.to_owned(), ..self }
    }

    /// Room above the axes \[mm\].
    pub(crate) fn above(&self) -> f64 {
        let title = if self.title.is_empty() { 0.0 } else { LINE };
        title + if self.has_axes { MARGIN_TOP } else { 0.5 }
    }

    /// Room to the right of axes of this width, where the last text of the horizontal one needs some \[mm\].
    pub(crate) fn beside(&self, width: f64) -> f64 {
        if !self.has_axes {
            return 0.5;
        }
        let over =
            |(at, text): &(f64, String)| 0.5 * text_width(text, TEXT_PT) - (1.0 - at) * width;
        self.x.ticks_across(width).iter().map(over).fold(MARGIN_RIGHT - EDGE, f64::max) + EDGE
    }

    /// Room below the axes \[mm\].
    pub(crate) fn below(&self, with_label: bool) -> f64 {
        match (self.has_axes, with_label && !self.x.label.is_empty()) {
            (false, _) => 0.5,
            (true, false) => TICK + GAP + LINE,
            (true, true) => TICK + GAP + 2.0 * LINE,
        }
    }

    /// Room to the left of the axes, given their height \[mm\].
    pub(crate) fn left(&self, height: f64, with_label: bool) -> f64 {
        if !self.has_axes {
            return 0.5;
        }
        let ticks = self.ticks_up(height, with_label);
        let widest = ticks.iter().map(|(_, text)| text_width(text, TEXT_PT)).fold(0.0, f64::max);
        let label = if with_label && !self.y.label.is_empty() { LINE + 0.4 } else { 0.6 };
        label + widest + GAP + TICK
    }

    /// The ticks of the vertical axis; names stand only where a label would.
    fn ticks_up(&self, height: f64, with_label: bool) -> Vec<(f64, String)> {
        if self.y.has_grid() || with_label { self.y.ticks_up(height) } else { Vec::new() }
    }

    /// Draws the panel, with a title that fits.
    pub(crate) fn draw(
        &self,
        sheet: &Sheet<'_>,
        frame: &Frame,
        title: &str,
    ) -> Result<(), FigureError> {
        let Frame { left, top, right, bottom, .. } = *frame;
        let place = |[x, y]: [f64; 2]| -> Place {
            [left + (right - left) * self.x.place(x), bottom - (bottom - top) * self.y.place(y)]
        };
        let ticks = if self.has_axes {
            [self.x.ticks_across(right - left), self.ticks_up(bottom - top, frame.y_label)]
        } else {
            Default::default()
        };
        self.draw_grid(sheet, frame, &ticks)?;
        self.marks.iter().try_for_each(|mark| mark.draw(sheet, &place))?;
        if self.has_axes {
            self.draw_axes(sheet, frame, &ticks)?;
        }
        sheet.text(title, [left, top - self.above() + 0.5 * LINE], Anchor::Left)
    }

    fn draw_grid(
        &self,
        sheet: &Sheet<'_>,
        &Frame { left, top, right, bottom, .. }: &Frame,
        [across, up]: &[Vec<(f64, String)>; 2],
    ) -> Result<(), FigureError> {
        for (at, _) in across.iter().filter(|_| self.x.has_grid()) {
            let x = left + at * (right - left);
            sheet.line(&[[x, top], [x, bottom]], &grid())?;
        }
        for (at, _) in up.iter().filter(|_| self.y.has_grid()) {
            let y = bottom - at * (bottom - top);
            sheet.line(&[[left, y], [right, y]], &grid())?;
        }
        Ok(())
    }

    fn draw_axes(
        &self,
        sheet: &Sheet<'_>,
        frame: &Frame,
        [across, up]: &[Vec<(f64, String)>; 2],
    ) -> Result<(), FigureError> {
        let Frame { left, top, right, bottom, x_label, y_label } = *frame;
        let stroke = Stroke::plain(INK, 0.2);
        sheet.line(&[[left, top], [left, bottom], [right, bottom]], &stroke)?;
        let x = |at: f64| left + at * (right - left);
        let y = |at: f64| bottom - at * (bottom - top);
        for (at, text) in across {
            sheet.line(&[[x(*at), bottom], [x(*at), bottom + TICK]], &stroke)?;
            let below = bottom + TICK + GAP + 0.4 * LINE;
            sheet.text(text, [x(*at), below], Anchor::Centre)?;
        }
        for (at, text) in up {
            sheet.line(&[[left, y(*at)], [left - TICK, y(*at)]], &stroke)?;
            sheet.text(text, [left - TICK - GAP, y(*at)], Anchor::Right)?;
        }
        if self.x.is_cut {
            draw_break(sheet, [left + BREAK, bottom], [0.0, 1.0])?;
        }
        if self.y.is_cut {
            draw_break(sheet, [left, bottom - BREAK], [1.0, 0.0])?;
        }
        let thin = Stroke::plain(INK, 0.12);
        for at in self.x.minor_ticks() {
            sheet.line(&[[x(at), bottom], [x(at), bottom + 0.5 * TICK]], &thin)?;
        }
        for at in self.y.minor_ticks() {
            sheet.line(&[[left, y(at)], [left - 0.5 * TICK, y(at)]], &thin)?;
        }
        if x_label {
            let below = bottom + TICK + GAP + 1.45 * LINE;
            // Longer than the axis, it begins further left.
            let rest = right + self.beside(right - left) - 0.5 * text_width(&self.x.label, TEXT_PT);
            let middle = (0.5 * (left + right)).min(rest);
            sheet.text(&self.x.label, [middle, below], Anchor::Centre)?;
        }
        if y_label {
            let middle = 0.5 * (top + bottom);
            let beside = left - self.left(bottom - top, true) + 0.5 * LINE;
            sheet.upright_text(&self.y.label, [beside, middle])?;
        }
        Ok(())
    }
}

/// Two slanted strokes over an axis, as its break; `across` is the direction at right angles to the axis.
fn draw_break(sheet: &Sheet<'_>, [x, y]: Place, [across, up]: [f64; 2]) -> Result<(), FigureError> {
    let corner =
        |along: f64, aside: f64| [x + along * up + aside * across, y - along * across - aside * up];
    let slanted = |along: f64| [corner(along - 0.3, -TICK), corner(along + 0.3, TICK)];
    let [[a, b], [c, d]] = [-0.35, 0.35].map(slanted);
    sheet.area(&[a, b, d, c], PAPER, 1.0)?;
    let stroke = Stroke::plain(INK, 0.2);
    sheet.line(&[a, b], &stroke)?;
    sheet.line(&[c, d], &stroke)
}

/// The smallest and the largest finite ordinate of all lines.
pub(crate) fn extent<'a>(lines: impl IntoIterator<Item = &'a Line>) -> [f64; 2] {
    let values = lines.into_iter().flat_map(|line| line.points.iter().map(|[_, y]| *y));
    let [low, high] = range(values, f64::NEG_INFINITY);
    // Costs of any scale are drawn, rounding is not.
    if high - low > 1e-9 * low.abs().max(high.abs()) { [low, high] } else { [low; 2] }
}

/// The smallest and the largest finite value, none below `lowest`.
pub(crate) fn range(values: impl Iterator<Item = f64>, lowest: f64) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite()).map(|v| v.max(lowest));
    let [low, high] =
        finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)]);
    if low <= high { [low, high] } else { [lowest.max(0.1), lowest.max(0.1) * 10.0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::figure::stored_pictures::texts;

    /// The last tick's text stands half behind the axis: 8000000 is about 10 mm wide.
    #[test]
    fn the_last_tick_has_room() {
        let panel = |high: f64| {
            Panel::new(
                Axis::linear("", [0.0, high], 0.0),
                Axis::linear("", [0.0, 1.0], 0.0),
                Vec::new(),
            )
        };
        assert!((panel(8.0).beside(70.0) - MARGIN_RIGHT).abs() < 1e-12);
        assert!(panel(8e6).beside(70.0) > 0.5 * text_width("8000000", TEXT_PT));
        let tree = Figure::column(vec![panel(8e6)], 44.0).tree().unwrap();
        let right = texts(tree.root()).iter().map(|(_, seen)| seen.right()).fold(0.0, f32::max);
        assert!(right <= tree.size().width(), "{right}");
    }

    /// No XML can have these, escaped or not.
    #[test]
    fn any_text_can_be_drawn() {
        let axis = |label: &str| Axis::linear(label, [0.0, 1.0], 0.0);
        let text = "a\u{0}\u{1b}[1m\u{FFFF}<&>\"'";
        let note = Mark::Note(text.to_owned());
        let panel = Panel::new(axis(text), axis(text), vec![note]).titled(text);
        assert!(Figure::column(vec![panel], 44.0).tree().is_ok());
    }
}
