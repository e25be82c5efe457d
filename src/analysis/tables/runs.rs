//! Every run and what it found.

use polars::prelude::*;

use super::{Analysis, Table};
use crate::analysis::Run;
use crate::experiment::Instance;

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
        "residual [°]" => reals(|run| run.residual_deg),
        "t_f [s]" => reals(|run| run.duration),
        "evaluations" => counts(|run| run.evaluations),
        "budget" => counts(|run| run.budget),
    )?;
    if !analysis.plan.instances.iter().any(Instance::is_task) {
        frame = frame.drop_many(["residual [°]", "t_f [s]"]);
    }
    let caption = "All stored runs with their certified best costs, residuals and durations; a failed run's cost is \
        infinite.";
    Ok(Table::curve("runs", caption, frame))
}

fn labels<'a>(analysis: &Analysis<'a>, label: fn(&Instance) -> &str) -> Vec<&'a str> {
    analysis.runs.iter().map(|run| label(&analysis.plan.instances[run.instance])).collect()
}
