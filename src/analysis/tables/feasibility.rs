//! When the limits are first kept.

use polars::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::quartiles;
use crate::exhibit::Table;
use crate::experiment::Run;

/// One line per group and optimiser, but for imported ones, of whose limits nothing is known; none where all are imported.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Option<Table>> {
    let is_own =
        |group: &&Vec<&Run>| analysis.plan.optimisers[group[0].optimiser].imported().is_none();
    let groups: Vec<&Vec<&Run>> = analysis.groups.iter().filter(is_own).collect();
    if groups.is_empty() && !analysis.groups.is_empty() {
        return Ok(None);
    }
    let first = |run: &&Run| run.first_feasible.map_or(f64::INFINITY, |first| first as f64);
    let quartiles: Vec<_> = groups.iter().map(|g| quartiles(g.iter().map(first))).collect();
    let kept = |group: &[&Run]| group.iter().filter(|run| run.first_feasible.is_some()).count();
    let frame = df!(
        "group" => groups.iter().map(|g| analysis.labels(g)[1]).collect::<Vec<_>>(),
        "optimiser" => groups.iter().map(|g| analysis.labels(g)[0]).collect::<Vec<_>>(),
        "runs" => groups.iter().map(|g| g.len() as u64).collect::<Vec<_>>(),
        "feasible" => groups.iter().map(|g| kept(g) as u64).collect::<Vec<_>>(),
        "quartile 1" => quartiles.iter().map(|q| q[0]).collect::<Vec<_>>(),
        "median" => quartiles.iter().map(|q| q[1]).collect::<Vec<_>>(),
        "quartile 3" => quartiles.iter().map(|q| q[2]).collect::<Vec<_>>(),
    )?;
    let caption = "Evaluations until a point within all limits was evaluated; infinite for a run without one.";
    Ok(Some(Table::of("first-feasible", caption, frame)))
}
