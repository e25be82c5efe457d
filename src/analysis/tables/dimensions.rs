//! Final cost against the number of variables.

use std::collections::{BTreeMap, BTreeSet};

use polars::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::quartiles;
use crate::exhibit::Table;

/// Final costs by the series' place in the plan, optimiser and number of variables.
type Costs = BTreeMap<(usize, usize, usize), Vec<f64>>;

/// One line per series, optimiser and number of variables; none where no series has several of these.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Option<Table>> {
    let (series, mut costs) = costs(analysis);
    let mut variables = vec![BTreeSet::new(); series.len()];
    for (series, _, count) in costs.keys() {
        variables[*series].insert(*count);
    }
    costs.retain(|(series, ..), _| variables[*series].len() > 1);
    if costs.is_empty() {
        return Ok(None);
    }
    let quartiles: Vec<[f64; 3]> =
        costs.values().map(|costs| quartiles(costs.iter().copied())).collect();
    let quartile = |k: usize| quartiles.iter().map(|all| all[k]).collect::<Vec<f64>>();
    let frame = df!(
        "series" => costs.keys().map(|key| series[key.0]).collect::<Vec<_>>(),
        "optimiser" => costs.keys().map(|key| analysis.optimiser(key.1)).collect::<Vec<_>>(),
        "variables" => costs.keys().map(|key| key.2 as u64).collect::<Vec<_>>(),
        "quartile 1" => quartile(0),
        "median" => quartile(1),
        "quartile 3" => quartile(2),
    )?;
    let caption = "Quartiles of the final costs, certified, over all runs on instances that differ in their number of \
        variables, and in what does not tell groups apart, alone; a failed run's cost is infinite.";
    Ok(Some(Table::of("dimensions", caption, frame)))
}

/// The series in the order of the plan, and the costs of the runs.
fn costs<'a>(analysis: &Analysis<'a>) -> (Vec<&'a str>, Costs) {
    let instances = &analysis.plan.instances;
    let mut series: Vec<&str> = Vec::new();
    let places: Vec<(usize, usize)> = instances
        .iter()
        .map(|instance| {
            let place = series.iter().position(|known| *known == instance.series);
            let place = place.unwrap_or_else(|| {
                series.push(&instance.series);
                series.len() - 1
            });
            (place, instance.subject.dimension())
        })
        .collect();
    let mut costs = Costs::new();
    for run in analysis.runs {
        let (series, variables) = places[run.instance];
        costs.entry((series, run.optimiser, variables)).or_default().push(run.cost);
    }
    (series, costs)
}
