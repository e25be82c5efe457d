//! Best cost against evaluations.

use std::collections::HashSet;

use super::figure::Figure;
use super::panel::{Axis, Band, Line, MARGIN, Panel};
use super::style::Stroke;
use crate::analysis::Curve;

/// Costs below are drawn at the axis's lower end; a test function's optimum, zero, has no other place
/// on it.
const LOWEST: f64 = 1e-9;

/// Height of the panel where there is one, and of each where there are more \[mm\].
const ONE: f64 = 54.0;
const MANY: f64 = 40.0;

/// Median of the best cost so far over the runs, with the quartiles as a band: a panel for each group
/// of instances. `symbol` stands for the cost.
pub fn convergence(curves: &[Curve], symbol: &str) -> Figure {
    let groups = distinct(curves.iter().map(|curve| curve.group.as_str()));
    let optimisers = distinct(curves.iter().map(|curve| curve.optimiser.as_str()));
    let evaluations = extent(curves.iter().flat_map(|c| &c.evaluations));
    let panels = groups.iter().map(|group| {
        let curves = curves.iter().filter(|curve| curve.group == *group);
        let costs = extent(curves.clone().flat_map(|c| c.quartiles.iter().flatten()));
        let mut panel = Panel {
            title: (*group).to_owned(),
            x: Axis::logarithmic("evaluations", evaluations, 0.0),
            y: Axis::logarithmic(&format!("best {symbol}, median and quartiles"), costs, MARGIN),
            bands: Vec::new(),
            lines: Vec::new(),
        };
        for curve in curves {
            // An optimiser looks the same in every panel.
            let i = optimisers.iter().position(|name| *name == curve.optimiser).unwrap_or(0);
            draw(curve, Stroke::of(i), &mut panel);
        }
        panel
    });
    let panels: Vec<Panel> = panels.collect();
    Figure { panel_height: if panels.len() == 1 { ONE } else { MANY }, panels }
}

fn draw(curve: &Curve, stroke: Stroke, panel: &mut Panel) {
    let places = curve.evaluations.iter().zip(&curve.quartiles);
    let places: Vec<_> = places.filter(|(_, q)| q.iter().all(|v| v.is_finite())).collect();
    panel.bands.push(Band {
        colour: stroke.colour,
        points: places.iter().map(|(n, [low, _, high])| [**n, *low, *high]).collect(),
    });
    panel.lines.push(Line {
        name: curve.optimiser.clone(),
        stroke,
        points: places.iter().map(|(n, [_, median, _])| [**n, *median]).collect(),
    });
}

/// Every name once, in the order of their first appearance.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    names.filter(|name| seen.insert(*name)).collect()
}

/// The smallest and the largest finite value, neither below the axis's lower end.
fn extent<'a>(values: impl Iterator<Item = &'a f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite()).map(|v| v.max(LOWEST));
    let [low, high] = finite.fold([f64::INFINITY, 0.0], |[l, h]: [f64; 2], v| [l.min(v), h.max(v)]);
    if high > low { [low, high] } else { [0.1, 10.0] }
}
