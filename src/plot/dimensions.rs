//! Final cost against the number of variables.

use polars::prelude::DataFrame;

use super::convergence::faint;
use super::curves::{Curve, curves, facets};
use super::looks::Looks;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::{Figure, FigureError};

/// Costs below are drawn at the axis's lower end.
const LOWEST: f64 = 1e-10;

/// Median of the final costs against the number of variables, from the table `dimensions`; a panel per series. `symbol`
/// stands for the cost.
pub(super) fn dimensions(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let curves = curves(frame, "series", "variables", &["median"])?;
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let variables = range(curves.iter().flat_map(|c| &c.points).map(|(x, _)| *x), 1.0);
    let medians = curves.iter().flat_map(points).map(|[_, cost]| cost);
    let y = Axis::logarithmic(&format!("final {symbol}, median"), range(medians, LOWEST), MARGIN);
    let panels = facets.into_iter().map(|facet| {
        let mut marks: Vec<Mark> = facet.others.iter().map(|curve| faint(points(curve))).collect();
        marks.extend(facet.curves.iter().map(|curve| line(curve, looks)));
        let x = Axis::logarithmic("variables", variables, MARGIN);
        Panel::new(x, y.clone(), marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

fn points(curve: &Curve) -> Vec<[f64; 2]> {
    let finite = curve.points.iter().filter(|(_, y)| y[0].is_finite());
    finite.map(|(x, y)| [*x, y[0].max(LOWEST)]).collect()
}

fn line(curve: &Curve, looks: &Looks) -> Mark {
    Mark::Line(Line::new(&curve.optimiser, looks.stroke(&curve.optimiser), points(curve)))
}
