//! Every run and what it found.

use polars::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::summary::measure_columns;
use crate::exhibit::Table;
use crate::experiment::{Instance, Run};

/// One line a stored run, in the plan's order. Nothing in it depends on the machine's speed.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let reals = |value: fn(&Run) -> f64| -> Vec<f64> { analysis.runs.iter().map(value).collect() };
    let counts = |value: fn(&Run) -> u64| -> Vec<u64> { analysis.runs.iter().map(value).collect() };
    let cost = format!("best {}", analysis.plan.cost_symbol());
    let mut frame = df!(
        "instance" => labels(analysis, |instance| &instance.label),
        "group" => labels(analysis, |instance| &instance.group),
        "optimiser" => analysis.runs.iter().map(|run| analysis.optimiser(run.optimiser)).collect::<Vec<_>>(),
        "seed" => counts(|run| run.seed),
        cost => reals(|run| run.cost),
    )?;
    let gap = |run: &Run| {
        let known = analysis.plan.instances[run.instance].subject.known_cost();
        run.cost - known.unwrap_or(f64::NAN)
    };
    let runs: Vec<Option<&Run>> = analysis.runs.iter().map(Some).collect();
    let tail = df!(
        "evaluations" => counts(|run| run.evaluations),
        "budget" => counts(|run| run.budget),
        "gap" => analysis.runs.iter().map(gap).collect::<Vec<f64>>(),
    )?;
    frame = frame.hstack(&measure_columns(analysis.plan, &runs))?.hstack(tail.columns())?;
    let caption = "All stored runs with their certified best costs, and what else is measured of them; a failed run's cost is \
        infinite. The gap is how far the cost lies above the least known, where there is one.";
    Ok(Table::curve("runs", caption, frame))
}

fn labels<'a>(analysis: &Analysis<'a>, label: fn(&Instance) -> &str) -> Vec<&'a str> {
    analysis.runs.iter().map(|run| label(&analysis.plan.instances[run.instance])).collect()
}
