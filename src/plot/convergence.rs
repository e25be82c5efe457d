//! Best cost against evaluations.

use polars::prelude::DataFrame;

use super::costs::CostScale;
use super::curves::{Curve, curves, facets, stepped};
use super::looks::Looks;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark, Marked};
use crate::figure::panel::{Panel, range};
use crate::figure::style::{FAINT, Stroke};
use crate::figure::{Figure, FigureError};

/// Median of the best cost so far over the runs, with the quartiles as a band, from the table `convergence`; where some costs
/// of a panel are negative and the least cost is known, of what they are above that.
/// `symbol` stands for the cost.
pub(super) fn convergence(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let curves = curves(frame, "group", "evaluations", &ORDINATES)?;
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let evaluations = range(curves.iter().flat_map(|c| &c.points).map(|(x, _)| *x), 1.0);
    let panels = facets.into_iter().map(|facet| {
        let shown = || facet.curves.iter().chain(&facet.others).flat_map(|curve| &curve.points);
        let of = |first: usize| shown().flat_map(move |(_, y)| y[first..first + 3].iter().copied());
        let are_known = of(GAPS).all(|gap| !gap.is_nan());
        let are_gaps = of(0).any(|cost| cost < 0.0) && are_known;
        let (first, what) =
            if are_gaps { (GAPS, " − least known") } else { (0, ", median and quartiles") };
        let scale = CostScale::of(of(first).collect::<Vec<_>>().into_iter());
        let drawn = Drawn { first, scale };
        let mut marks: Vec<Mark> = scale.cut(evaluations).into_iter().collect();
        marks.extend(facet.others.iter().map(|curve| faint(drawn.median(curve))));
        marks.extend(facet.curves.iter().map(|curve| drawn.band(curve, looks)));
        marks.extend(facet.curves.iter().map(|c| curve_line(c, drawn.median(c), looks)));
        let x = Axis::logarithmic("evaluations", evaluations, 0.0);
        let y = scale.axis(&format!("best {symbol}{what}"));
        Panel::new(x, y, marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

/// The columns drawn, and the place of the first that is a gap.
const ORDINATES: [&str; 6] =
    ["quartile 1", "median", "quartile 3", "gap quartile 1", "gap median", "gap quartile 3"];
const GAPS: usize = 3;

/// A curve that others are compared with.
pub(super) fn faint(points: Vec<[f64; 2]>) -> Mark {
    Mark::Line(Line::new("all others", Stroke::plain(FAINT, 0.2), points))
}

/// A curve in its optimiser's look.
pub(super) fn curve_line(curve: &Curve, points: Vec<[f64; 2]>, looks: &Looks) -> Mark {
    Mark::Line(Line {
        name: looks.name(&curve.optimiser).to_owned(),
        stroke: looks.stroke(&curve.optimiser),
        points,
        marked: Marked::Evenly(looks.stagger(&curve.optimiser)),
    })
}

/// Which of a curve's ordinates are drawn, and how.
struct Drawn {
    /// The place of the first quartile.
    first: usize,
    scale: CostScale,
}

impl Drawn {
    fn median(&self, curve: &Curve) -> Vec<[f64; 2]> {
        let medians = curve.points.iter().map(|(x, y)| [*x, y[self.first + 1]]);
        stepped(medians.filter(|[_, y]| y.is_finite()).map(|[x, y]| [x, self.scale.drawn(y)]))
    }

    fn band(&self, curve: &Curve, looks: &Looks) -> Mark {
        let quartiles = |y: &[f64]| [y[self.first], y[self.first + 2]];
        let points = curve.points.iter().map(|(x, y)| (*x, quartiles(y)));
        let points = points.filter(|(_, quartiles)| quartiles.iter().all(|q| q.is_finite()));
        let quartile = |k: usize| stepped(points.clone().map(|(x, y)| [x, self.scale.drawn(y[k])]));
        let ends = quartile(0).into_iter().zip(quartile(1));
        Mark::Band {
            colour: looks.stroke(&curve.optimiser).colour,
            points: ends.map(|([x, low], [_, high])| [x, low, high]).collect(),
        }
    }
}
