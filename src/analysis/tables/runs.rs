//! Every run and what it found.

use polars::prelude::*;

use super::{Field, Table};
use crate::analysis::Run;
use crate::experiment::Instance;

/// One line a stored run, in the plan's order. Nothing in it depends on the machine's speed.
pub(super) fn table(field: &Field<'_>) -> PolarsResult<Table> {
    let reals = |value: fn(&Run) -> f64| -> Vec<f64> { field.runs.iter().map(value).collect() };
    let counts = |value: fn(&Run) -> u64| -> Vec<u64> { field.runs.iter().map(value).collect() };
    let cost = format!("best {}", field.plan.cost_symbol());
    let mut frame = df!(
        "instance" => labels(field, |instance| &instance.label),
        "group" => labels(field, |instance| &instance.group),
        "optimiser" => field.runs.iter().map(|run| field.optimiser(run.optimiser)).collect::<Vec<_>>(),
        "seed" => counts(|run| run.seed),
        cost => reals(|run| run.cost),
        "residual [°]" => reals(|run| run.residual_deg),
        "t_f [s]" => reals(|run| run.duration),
        "evaluations" => counts(|run| run.evaluations),
        "budget" => counts(|run| run.budget),
    )?;
    if !field.plan.instances.iter().any(Instance::is_task) {
        frame = frame.drop_many(["residual [°]", "t_f [s]"]);
    }
    let caption = "All stored runs with their certified best costs, residuals and durations; a failed run's cost is \
        infinite.";
    Ok(Table::curve("runs", caption, frame))
}

fn labels<'a>(field: &Field<'a>, label: fn(&Instance) -> &str) -> Vec<&'a str> {
    field.runs.iter().map(|run| label(&field.plan.instances[run.instance])).collect()
}
