//! Best cost against evaluations.

use polars::prelude::DataFrame;

use super::curves::{Curve, curves, facets, stepped};
use super::looks::Looks;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark, Marked};
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::style::{FAINT, Stroke};
use crate::figure::{Figure, FigureError};

/// Costs below are drawn at the axis's lower end; a test function's optimum, zero, has no other place
/// on it.
const LOWEST: f64 = 1e-9;

/// Median of the best cost so far over the runs, with the quartiles as a band, from the table `convergence`.
/// `symbol` stands for the cost.
pub(super) fn convergence(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let quartiles = ["quartile 1", "median", "quartile 3"];
    let curves = curves(frame, "group", "evaluations", &quartiles)?;
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let evaluations = range(curves.iter().flat_map(|c| &c.points).map(|(x, _)| *x), 1.0);
    let panels = facets.into_iter().map(|facet| {
        let shown = facet.curves.iter().chain(&facet.others);
        let costs = shown.flat_map(|c| &c.points).flat_map(|(_, y)| y.iter().copied());
        let costs = range(costs, LOWEST);
        let mut marks: Vec<Mark> = facet.others.iter().map(|curve| faint(median(curve))).collect();
        marks.extend(facet.curves.iter().map(|curve| band(curve, looks)));
        marks.extend(facet.curves.iter().map(|c| curve_line(c, median(c), looks)));
        let x = Axis::logarithmic("evaluations", evaluations, 0.0);
        let y = Axis::logarithmic(&format!("best {symbol}, median and quartiles"), costs, MARGIN);
        Panel::new(x, y, marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

/// A curve that others are compared with.
pub(super) fn faint(points: Vec<[f64; 2]>) -> Mark {
    Mark::Line(Line::new("", Stroke::plain(FAINT, 0.2), points))
}

/// A curve in its optimiser's look.
pub(super) fn curve_line(curve: &Curve, points: Vec<[f64; 2]>, looks: &Looks) -> Mark {
    Mark::Line(Line {
        name: curve.optimiser.clone(),
        stroke: looks.stroke(&curve.optimiser),
        points,
        marked: Marked::Evenly(looks.stagger(&curve.optimiser)),
    })
}

fn median(curve: &Curve) -> Vec<[f64; 2]> {
    let points = curve.points.iter().filter(|(_, y)| y[1].is_finite());
    stepped(points.map(|(x, y)| [*x, y[1].max(LOWEST)]))
}

fn band(curve: &Curve, looks: &Looks) -> Mark {
    let points = curve.points.iter().filter(|(_, y)| y.iter().all(|v| v.is_finite()));
    let quartile = |k: usize| stepped(points.clone().map(|(x, y)| [*x, y[k].max(LOWEST)]));
    let ends = quartile(0).into_iter().zip(quartile(2));
    Mark::Band {
        colour: looks.stroke(&curve.optimiser).colour,
        points: ends.map(|([x, low], [_, high])| [x, low, high]).collect(),
    }
}
