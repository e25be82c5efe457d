//! Final cost against the number of variables.

use polars::prelude::DataFrame;

use super::convergence::faint;
use super::costs::CostScale;
use super::curves::{Curve, curves, facets};
use super::looks::Looks;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::{Figure, FigureError};

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
    let medians: Vec<f64> = curves.iter().flat_map(points).map(|[_, cost]| cost).collect();
    let scale = CostScale::of(medians.into_iter());
    let y = scale.axis(&format!("final {symbol}, median"));
    let drawn =
        |curve: &Curve| points(curve).into_iter().map(|[x, y]| [x, scale.drawn(y)]).collect();
    let panels = facets.into_iter().map(|facet| {
        let mut marks: Vec<Mark> = scale.cut(variables).into_iter().collect();
        marks.extend(facet.others.iter().map(|curve| faint(drawn(curve))));
        let line = |curve: &&Curve| {
            let (name, stroke) = (looks.name(&curve.optimiser), looks.stroke(&curve.optimiser));
            Mark::Line(Line::new(name, stroke, drawn(curve)))
        };
        marks.extend(facet.curves.iter().map(line));
        let x = Axis::logarithmic("variables", variables, MARGIN);
        Panel::new(x, y.clone(), marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

fn points(curve: &Curve) -> Vec<[f64; 2]> {
    let finite = curve.points.iter().filter(|(_, y)| y[0].is_finite());
    finite.map(|(x, y)| [*x, y[0]]).collect()
}
