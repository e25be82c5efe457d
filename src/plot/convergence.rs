//! Best cost against evaluations.

use super::figure::Figure;
use super::panel::{Axis, Band, Line, MARGIN, Panel};
use super::style::Stroke;
use crate::analysis::Curve;

/// Median of the best cost so far over the seeds, with the quartiles as a band.
pub fn convergence(curves: &[Curve]) -> Figure {
    let many = curves.iter().any(|curve| curve.instance != curves[0].instance);
    let mut panel = Panel {
        x: Axis::logarithmic("evaluations", extent(curves, |c| c.evaluations.clone()), 0.0),
        y: Axis::logarithmic(
            "best J, median and quartiles",
            extent(curves, |c| c.quartiles.concat()),
            MARGIN,
        ),
        bands: Vec::new(),
        lines: Vec::new(),
    };
    for (i, curve) in curves.iter().enumerate() {
        let stroke = Stroke::of(i);
        let places = curve.evaluations.iter().zip(&curve.quartiles);
        let places: Vec<_> = places.filter(|(_, q)| q.iter().all(|v| v.is_finite())).collect();
        panel.bands.push(Band {
            colour: stroke.colour,
            points: places.iter().map(|(n, [low, _, high])| [**n, *low, *high]).collect(),
        });
        panel.lines.push(Line {
            name: if many {
                format!("{} {}", curve.optimiser, curve.instance)
            } else {
                curve.optimiser.clone()
            },
            stroke,
            points: places.iter().map(|(n, [_, median, _])| [**n, *median]).collect(),
        });
    }
    Figure { panels: vec![panel], panel_height: 54.0 }
}

/// The smallest and the largest positive finite value.
fn extent(curves: &[Curve], values: impl Fn(&Curve) -> Vec<f64>) -> [f64; 2] {
    let all = curves.iter().flat_map(values).filter(|v| v.is_finite() && *v > 0.0);
    let [low, high] = all.fold([f64::INFINITY, 0.0], |[l, h]: [f64; 2], v| [l.min(v), h.max(v)]);
    if high > low { [low, high] } else { [0.1, 10.0] }
}
