//! How long optimisers take: distributions, expectations, profiles.

use polars::prelude::DataFrame;

use super::convergence::{curve_line, faint};
use super::curves::{Curve, MOST_PANELS, curves, facets, stepped};
use super::looks::Looks;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::style::Stroke;
use crate::figure::{Figure, FigureError};

/// Share of pairs of run and target reached against evaluations, from the table
/// `running-time-distribution`; thin lines go on with simulated restarts. Of too many groups only all together are drawn.
pub(super) fn running_time_distribution(
    frame: &DataFrame,
    looks: &Looks,
) -> Result<Option<Figure>, FigureError> {
    let shares = ["share of runs", "share with restarts"];
    let mut curves = curves(frame, "group", "evaluations", &shares)?;
    if facets(&curves, looks).is_none_or(|facets| facets.len() > MOST_PANELS) {
        curves.retain(|curve| curve.panel == "all");
    }
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let evaluations = range(curves.iter().flat_map(|c| &c.points).map(|(x, _)| *x), 1.0);
    let panels = facets.into_iter().map(|facet| {
        let column =
            |curve: &Curve, k: usize| stepped(curve.points.iter().map(|(x, y)| [*x, y[k]]));
        let mut marks: Vec<Mark> = facet.others.iter().map(|c| faint(column(c, 0))).collect();
        for curve in &facet.curves {
            let thin = Stroke { width: 0.15, marker: None, ..looks.stroke(&curve.optimiser) };
            marks.push(Mark::Line(Line::new("", thin, column(curve, 1))));
        }
        marks.extend(facet.curves.iter().map(|c| curve_line(c, column(c, 0), looks)));
        marks.push(Mark::Note("thin: with simulated restarts".to_owned()));
        let x = Axis::logarithmic("evaluations", evaluations, 0.0);
        let y = Axis::linear("share of targets reached", [0.0, 1.0], 0.02);
        Panel::new(x, y, marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

/// Expected running time against how far above the least cost the target is, from the table
/// `expected-running-time`.
pub(super) fn expected_running_time(
    frame: &DataFrame,
    looks: &Looks,
    symbol: &str,
) -> Result<Option<Figure>, FigureError> {
    let curves = curves(frame, "group", "above least", &["expected running time"])?;
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let all = || curves.iter().flat_map(|c| &c.points).filter(|(_, y)| y[0].is_finite());
    let targets = range(all().map(|(x, _)| *x), 1e-12);
    let times = range(all().map(|(_, y)| y[0]), 1.0);
    let panels = facets.into_iter().map(|facet| {
        let finite = |curve: &Curve| -> Vec<[f64; 2]> {
            let finite = curve.points.iter().filter(|(_, y)| y[0].is_finite());
            finite.map(|(x, y)| [*x, y[0]]).collect()
        };
        let mut marks: Vec<Mark> = facet.others.iter().map(|c| faint(finite(c))).collect();
        marks.extend(facet.curves.iter().map(|c| curve_line(c, finite(c), looks)));
        let x = Axis::logarithmic(&format!("target: {symbol} − least known"), targets, 0.0);
        let y = Axis::logarithmic("expected evaluations", times, MARGIN);
        Panel::new(x.reversed(), y, marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

/// Room behind the last step of a profile, as a factor, and the least ratio of an axis's ends.
const BEHIND: f64 = 1.3;
const SHORTEST: f64 = 10.0;

/// Performance or data profiles, a panel per target. `time` is the column of the abscissae.
pub(super) fn profiles(
    frame: &DataFrame,
    looks: &Looks,
    time: &str,
    label: &str,
) -> Result<Option<Figure>, FigureError> {
    let curves = curves(frame, "target", time, &["share"])?;
    let Some(facets) = facets(&curves, looks) else { return Ok(None) };
    let positive = curves.iter().flat_map(|c| &c.points).map(|(x, _)| *x).filter(|x| *x > 0.0);
    let [low, high] = range(positive, 1e-3);
    let high = (BEHIND * high).max(SHORTEST * low);
    let panels = facets.into_iter().map(|facet| {
        let steps = |curve: &Curve| steps(curve, low, high);
        let mut marks: Vec<Mark> = facet.others.iter().map(|c| faint(steps(c))).collect();
        marks.extend(facet.curves.iter().map(|c| curve_line(c, steps(c), looks)));
        let x = Axis::logarithmic(label, [low, high], 0.0);
        let y = Axis::linear("share of problems", [0.0, 1.0], 0.02);
        Panel::new(x, y, marks).titled(&facet.title)
    });
    Ok(Some(Figure::grid(panels.collect())))
}

/// A profile keeps each share up to the next step, and the last to the end.
fn steps(curve: &Curve, low: f64, high: f64) -> Vec<[f64; 2]> {
    let shares = curve.points.iter().map(|(x, y)| [x.max(low), y[0]]);
    let mut points = stepped(shares);
    points.extend(points.last().map(|&[_, share]| [high, share]));
    points
}
