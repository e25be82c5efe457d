//! The critical-difference diagram: mean ranks, and who cannot be told apart.

use polars::prelude::DataFrame;

use super::curves::{reals, texts};
use super::looks::Looks;
use crate::analysis::ALPHA;
use crate::figure::axis::{Axis, LONGEST_NAME};
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::Panel;
use crate::figure::sheet::Anchor;
use crate::figure::style::{INK, Stroke, TEXT_PT, Width};
use crate::figure::text::{fitted_apart, text_width};
use crate::figure::{Figure, FigureError};

/// Distance between lines of labels, and between bars \[mm\].
const ROW: f64 = 4.2;
const BAR: f64 = 1.6;
/// Height of the axis of ranks below the upper end \[mm\].
const AXIS: f64 = 8.4;
/// Room between the axis and where a label's line ends, and the shortest axis in a column \[mm\].
const GAP: f64 = 1.2;
const SHORTEST: f64 = 20.0;
/// Least distance of two ranks in a column \[mm\].
const RANK: f64 = 3.2;
/// Room for a mean rank behind its label, and around both \[mm\].
const FOR_RANK: f64 = 13.0;
/// How far a bar reaches over a member \[mm\].
const OVER: f64 = 0.8;

/// Everything in millimetres.
struct Diagram {
    /// Where ranks 1 and the last are.
    from: f64,
    to: f64,
    count: usize,
    marks: Vec<Mark>,
}

impl Diagram {
    fn x(&self, rank: f64) -> f64 {
        self.from + (self.to - self.from) * (rank - 1.0) / (self.count as f64 - 1.0).max(1.0)
    }

    fn line(&mut self, points: Vec<[f64; 2]>, stroke: Stroke) {
        self.marks.push(Mark::Line(Line::new("", stroke, points)));
    }

    fn label(&mut self, at: [f64; 2], text: String, anchor: Anchor) {
        self.marks.push(Mark::Label { at, text, anchor, raised: 0.0 });
    }

    /// A mean rank on the axis, and a line from there to its label.
    fn optimiser(&mut self, mean: f64, label: [f64; 2], stroke: Stroke) {
        let x = self.x(mean);
        let line = Stroke { width: 0.25, marker: None, ..stroke };
        self.line(vec![[x, AXIS], [x, label[1]], label], line);
        let stroke = Stroke { hollow: false, ..stroke };
        self.marks.push(Mark::Points { name: String::new(), stroke, points: vec![[x, AXIS]] });
    }

    fn axis(&mut self) {
        let ink = Stroke::plain(INK, 0.25);
        self.line(vec![[self.from, AXIS], [self.to, AXIS]], ink);
        let every = self.count.div_ceil(12);
        for rank in (1..=self.count).step_by(every) {
            let x = self.x(rank as f64);
            self.line(vec![[x, AXIS], [x, AXIS - 1.0]], ink);
            self.label([x, AXIS - 2.8], rank.to_string(), Anchor::Centre);
        }
    }
}

/// Mean ranks on an axis, 1 being the best; a bar joins optimisers that Wilcoxon's test with Holm's correction does not tell
/// apart. From the table `ranks`.
///
/// Demšar (2006), J. Mach. Learn. Res. 7, 1–30; Benavoli, Corani and Mangili (2016), J. Mach. Learn. Res. 17, 1–10, on why
/// the test is one of pairs and not Nemenyi's.
pub(super) fn critical_difference(ranks: &DataFrame, looks: &Looks) -> Result<Figure, FigureError> {
    let (labels, means) = (texts(ranks, "optimiser")?, reals(ranks, "mean rank")?);
    let cliques = texts(ranks, "cliques")?;
    let count = labels.len();
    let half = count.div_ceil(2);
    let shortest = f64::max(SHORTEST, RANK * count as f64);
    let names: Vec<String> = labels.iter().map(|label| looks.name(label).to_owned()).collect();
    let longest = (0.5 * (Width::Page.mm() - shortest) - FOR_RANK).clamp(FOR_RANK, LONGEST_NAME);
    let told = fitted_apart(&names, longest).into_iter().zip(&means);
    let told: Vec<String> = told.map(|(name, mean)| format!("{name} ({mean:.2})")).collect();
    let widest = |texts: &[String]| {
        texts.iter().map(|t| text_width(t, TEXT_PT)).fold(0.0, f64::max) + 2.0 * GAP + 1.0
    };
    let (left, right) = (widest(&told[..half]), widest(&told[half..]));
    let fits = Width::Column.mm() - left - right >= shortest;
    let width = if fits { Width::Column } else { Width::Page };
    let mut diagram = Diagram { from: left, to: width.mm() - right, count, marks: Vec::new() };
    diagram.axis();
    let test = format!("bars: not told apart by Wilcoxon's test, Holm's correction, α = {ALPHA}");
    diagram.label([0.0, 1.6], test, Anchor::Left);
    let bars = bars(&mut diagram, &means, &cliques);
    let first = AXIS + BAR * (bars as f64 + 1.0) + 1.6;
    for (i, text) in told.into_iter().enumerate() {
        let is_left = i < half;
        let row = if is_left { i } else { count - 1 - i };
        let (end, anchor) = if is_left {
            (left - GAP, Anchor::Right)
        } else {
            (width.mm() - right + GAP, Anchor::Left)
        };
        let end = [end, first + ROW * row as f64];
        diagram.optimiser(means[i], end, looks.stroke(&labels[i]));
        diagram.label(end, text, anchor);
    }
    let height = first + ROW * half as f64 - 0.5 * ROW;
    let axis = |length: f64| Axis::linear("", [0.0, length], 0.0);
    // A bare panel has half a millimetre of room on every side.
    let panel = Panel::bare(axis(width.mm()), axis(height).reversed(), diagram.marks);
    Ok(Figure { width, across: 1, height, panels: vec![panel] })
}

/// Draws a bar for each clique, thick at its members, and tells how many lines of bars there are.
fn bars(diagram: &mut Diagram, means: &[f64], cliques: &[String]) -> usize {
    let mut members: Vec<(&str, Vec<f64>)> = Vec::new();
    for (mean, of) in means.iter().zip(cliques) {
        for clique in of.split_whitespace() {
            match members.iter_mut().find(|(name, _)| *name == clique) {
                Some((_, means)) => means.push(*mean),
                None => members.push((clique, vec![*mean])),
            }
        }
    }
    // Each bar goes into the first line where it has room.
    let mut lines: Vec<f64> = Vec::new();
    for (_, members) in members {
        // Ranks ascend.
        let (from, to) = (diagram.x(members[0]), diagram.x(members[members.len() - 1]));
        let (from, to) = (from - OVER, to + OVER);
        let line = lines.iter().position(|&end| end + 2.0 * OVER < from).unwrap_or(lines.len());
        if line == lines.len() {
            lines.push(to);
        } else {
            lines[line] = to;
        }
        let y = AXIS + 2.0 + BAR * line as f64;
        diagram.line(vec![[from, y], [to, y]], Stroke::plain(INK, 0.3));
        for member in members {
            let x = diagram.x(member);
            diagram.line(vec![[x - OVER, y], [x + OVER, y]], Stroke::plain(INK, 0.9));
        }
    }
    lines.len()
}
