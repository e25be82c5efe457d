//! Best cost against evaluations, as a table.

use polars::prelude::*;

use super::{Analysis, Table};
use crate::analysis::{Curve, convergence};

/// One line an optimiser, group and place on the curve.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let curves = convergence(analysis.plan, analysis.runs);
    let labels = |label: fn(&Curve) -> &str| -> Vec<&str> {
        let all = curves.iter().map(|curve| (label(curve), curve.evaluations.len()));
        all.flat_map(|(label, count)| std::iter::repeat_n(label, count)).collect()
    };
    let quartile = |q: usize| -> Vec<f64> {
        curves.iter().flat_map(|curve| curve.quartiles.iter().map(move |all| all[q])).collect()
    };
    let frame = df!(
        "group" => labels(|curve| &curve.group),
        "optimiser" => labels(|curve| &curve.optimiser),
        "evaluations" => curves.iter().flat_map(|c| c.evaluations.iter().copied()).collect::<Vec<_>>(),
        "quartile 1" => quartile(0),
        "median" => quartile(1),
        "quartile 3" => quartile(2),
    )?;
    let caption = "Quartiles over the runs of the best cost so far, as the search evaluated it, after so many \
        evaluations, up to the smallest budget of the group.";
    Ok(Table::curve("convergence", caption, frame))
}
