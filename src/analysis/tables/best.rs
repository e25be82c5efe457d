//! The best run of every instance.

use polars::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::summary::measure_columns;
use crate::exhibit::Table;
use crate::experiment::{Plan, Quantity, Run, Value, ValueKind};

/// One line per instance with a run that found something: its facts, who found it, its cost and its measures.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let plan = analysis.plan;
    let best = plan.results(analysis.runs).best_runs();
    let cost = format!("best {}", plan.cost_symbol());
    let label = |run: &&Run| plan.instances[run.instance].label.as_str();
    let mut frame = df!("instance" => best.iter().map(label).collect::<Vec<_>>())?;
    frame = frame.hstack(&fact_columns(plan, &best))?;
    let found = df!(
        "optimiser" => best.iter().map(|run| analysis.optimiser(run.optimiser)).collect::<Vec<_>>(),
        "seed" => best.iter().map(|run| run.seed).collect::<Vec<_>>(),
        cost => best.iter().map(|run| run.cost).collect::<Vec<_>>(),
    )?;
    let runs: Vec<Option<&Run>> = best.iter().map(|run| Some(*run)).collect();
    frame = frame.hstack(found.columns())?.hstack(&measure_columns(plan, &runs))?;
    Ok(Table::of("best", "The run with the lowest certified cost of each instance.", frame))
}

/// One column for each fact that is shown.
fn fact_columns(plan: &Plan, runs: &[&Run]) -> Vec<Column> {
    let facts: Vec<Vec<(Quantity, Value)>> =
        runs.iter().map(|run| plan.instances[run.instance].subject.facts()).collect();
    let column = |fact: &Quantity| {
        let heading = fact.heading.as_deref()?;
        let values = facts.iter().map(|facts| {
            let own = facts.iter().find(|(quantity, _)| quantity.name == fact.name);
            own.map_or(&Value::None, |(_, value)| value)
        });
        Some(match fact.kind {
            ValueKind::Text | ValueKind::Reals => {
                let text = |value: &Value| match value {
                    Value::Text(text) => Some(text.clone()),
                    _ => None,
                };
                Column::new(heading.into(), values.map(text).collect::<Vec<_>>())
            }
            ValueKind::Count => {
                let count = |value: &Value| match value {
                    Value::Count(count) => Some(*count),
                    _ => None,
                };
                Column::new(heading.into(), values.map(count).collect::<Vec<_>>())
            }
            ValueKind::Real => {
                Column::new(heading.into(), values.map(Value::real).collect::<Vec<_>>())
            }
        })
    };
    plan.facts().iter().filter_map(column).collect()
}
