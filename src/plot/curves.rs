//! Curves of optimisers from a table with a row per point.

use polars::prelude::*;

use super::looks::Looks;
use crate::figure::text::printable;

/// One curve.
#[derive(Debug, Clone, Default)]
pub(super) struct Curve {
    /// Which panel it belongs to: a group of instances, a target.
    pub(super) panel: String,
    pub(super) optimiser: String,
    /// Abscissa and ordinates.
    pub(super) points: Vec<(f64, Vec<f64>)>,
}

/// What one panel shows.
pub(super) struct Facet<'a> {
    pub(super) title: String,
    /// The panel's curves.
    pub(super) curves: Vec<&'a Curve>,
    /// Other curves of the same group, to compare with.
    pub(super) others: Vec<&'a Curve>,
}

/// Most panels of a figure.
pub(super) const MOST_PANELS: usize = 24;

/// A column of texts, as they can be drawn.
pub(super) fn texts(frame: &DataFrame, name: &str) -> PolarsResult<Vec<String>> {
    let column = frame.column(name)?.str()?;
    Ok(column.iter().map(|text| printable(text.unwrap_or_default())).collect())
}

/// A column of numbers; missing ones are no numbers.
pub(super) fn reals(frame: &DataFrame, name: &str) -> PolarsResult<Vec<f64>> {
    let column = frame.column(name)?.cast(&DataType::Float64)?;
    Ok(column.f64()?.iter().map(|value| value.unwrap_or(f64::NAN)).collect())
}

/// The curves of a table, in its order.
pub(super) fn curves(
    frame: &DataFrame,
    panel: &str,
    abscissa: &str,
    ordinates: &[&str],
) -> PolarsResult<Vec<Curve>> {
    let (panels, optimisers) = (texts(frame, panel)?, texts(frame, "optimiser")?);
    let abscissae = reals(frame, abscissa)?;
    let ordinates: Vec<Vec<f64>> =
        ordinates.iter().map(|name| reals(frame, name)).collect::<PolarsResult<_>>()?;
    let mut curves: Vec<Curve> = Vec::new();
    for (i, (panel, optimiser)) in panels.into_iter().zip(optimisers).enumerate() {
        if curves.last().is_none_or(|last| last.panel != panel || last.optimiser != optimiser) {
            curves.push(Curve { panel, optimiser, points: Vec::new() });
        }
        if let Some(curve) = curves.last_mut() {
            curve.points.push((abscissae[i], ordinates.iter().map(|column| column[i]).collect()));
        }
    }
    Ok(curves)
}

/// A panel for each group; where the field is too large for that, for each group and kind of optimiser, with the others behind.
/// None where these are too many.
pub(super) fn facets<'a>(curves: &'a [Curve], looks: &Looks) -> Option<Vec<Facet<'a>>> {
    let mut panels: Vec<&str> = Vec::new();
    for curve in curves {
        if !panels.contains(&curve.panel.as_str()) {
            panels.push(&curve.panel);
        }
    }
    let kinds = looks.kinds();
    let by_kind = looks.is_crowd() && panels.len() * kinds.len() <= MOST_PANELS;
    let facet = |panel: &str, kind: &str| {
        let all = curves.iter().filter(|curve| curve.panel == panel);
        let (curves, others) =
            all.partition(|curve| kind.is_empty() || looks.kind(&curve.optimiser) == kind);
        let titles = [looks.title(panel), kind.to_owned()].into_iter();
        let titles: Vec<String> = titles.filter(|title| !title.is_empty()).collect();
        Facet { title: titles.join(", "), curves, others }
    };
    let kinds = if by_kind { kinds } else { vec![""] };
    let facets = panels.iter().flat_map(|panel| kinds.iter().map(|kind| facet(panel, kind)));
    (panels.len() <= MOST_PANELS).then(|| facets.filter(|f| !f.curves.is_empty()).collect())
}

/// A curve that keeps each value up to the next.
pub(super) fn stepped(values: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for [x, y] in values {
        points.extend(points.last().map(|&[_, before]| [x, before]));
        points.push([x, y]);
    }
    points
}
