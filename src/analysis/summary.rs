//! One line per optimiser and group of instances.

use polars::prelude::*;

use super::grouped::groups;
use super::statistics::quantile;
use super::targets::Targets;
use crate::experiment::{Plan, Run};

/// One line per optimiser and group of instances: quartiles of the best cost over the runs, failures
/// counted as infinite, and what the subject measures of the best run's point. A column for each target says how many runs reached their instance's. Costs are certified.
pub fn summary(plan: &Plan, runs: &[Run], targets: &Targets) -> PolarsResult<DataFrame> {
    let groups = groups(plan, runs);
    let texts = |value: &dyn Fn(&[&Run]) -> String| -> Vec<String> {
        groups.iter().map(|group| value(group)).collect()
    };
    let reals = |value: &dyn Fn(&[&Run]) -> f64| -> Vec<f64> {
        groups.iter().map(|group| value(group)).collect()
    };
    let counts = |value: &dyn Fn(&[&Run]) -> u64| -> Vec<u64> {
        groups.iter().map(|group| value(group)).collect()
    };
    let best_cost = format!("best {}", plan.cost_symbol());
    let mut columns = df!(
        "group" => texts(&|g| plan.instances[g[0].instance].group.clone()),
        "optimiser" => texts(&|g| plan.optimisers[g[0].optimiser].label.clone()),
        "runs" => counts(&|g| g.len() as u64),
        "failed" => counts(&|g| g.iter().filter(|run| run.cost.is_infinite()).count() as u64),
        best_cost => reals(&|g| quantile_of(g, |run| run.cost, 0.0)),
        "quartile 1" => reals(&|g| quantile_of(g, |run| run.cost, 0.25)),
        "median" => reals(&|g| quantile_of(g, |run| run.cost, 0.5)),
        "quartile 3" => reals(&|g| quantile_of(g, |run| run.cost, 0.75)),
    )?;
    let best: Vec<Option<&Run>> = groups
        .iter()
        .map(|group| group.iter().copied().min_by(|a, b| a.cost.total_cmp(&b.cost)))
        .collect();
    let mut tail = measure_columns(plan, &best);
    tail.push(Column::new(
        "evaluations".into(),
        counts(&|g| g.iter().map(|r| r.evaluations).sum()),
    ));
    tail.push(Column::new("s/run".into(), reals(&|g| quantile_of(g, |run| run.seconds, 0.5))));
    columns = columns.hstack(&tail)?;
    for column in target_columns(plan, targets, &groups) {
        columns.with_column(column)?;
    }
    Ok(columns)
}

/// One column for each measure that is shown, of some runs.
pub(super) fn measure_columns(plan: &Plan, runs: &[Option<&Run>]) -> Vec<Column> {
    let shown = plan.measures().iter().enumerate();
    let shown = shown.filter_map(|(place, m)| Some((place, m.heading.as_deref()?)));
    let values = |place: usize| -> Vec<f64> {
        runs.iter().map(|run| run.map_or(f64::NAN, |run| run.measure(place))).collect()
    };
    shown.map(|(place, heading)| Column::new(heading.into(), values(place))).collect()
}

/// One column per target: how many runs reached their instance's; where groups have different ones, each cell
/// says which.
fn target_columns(plan: &Plan, targets: &Targets, groups: &[Vec<&Run>]) -> Vec<Column> {
    let symbol = plan.cost_symbol();
    let column = |k: usize| {
        let all = targets.label(k, symbol, 0..plan.instances.len());
        let numbered = all.starts_with("target");
        let cell = |group: &Vec<&Run>| {
            let target = |run: &Run| targets.values[run.instance].get(k).copied();
            let reached = |run: &&&Run| target(run).is_some_and(|target| run.cost <= target);
            let share = format!("{}/{}", group.iter().filter(reached).count(), group.len());
            let own = targets.label(k, "", group.iter().map(|run| run.instance));
            let own = own.trim_start();
            if numbered && !own.starts_with("target") { format!("{share} {own}") } else { share }
        };
        let cells: Vec<String> = groups.iter().map(cell).collect();
        let name = if numbered { format!("{symbol}, {all}") } else { all };
        Column::new(name.into(), cells)
    };
    (0..targets.count()).map(column).collect()
}

fn quantile_of(group: &[&Run], value: fn(&Run) -> f64, q: f64) -> f64 {
    let mut values: Vec<f64> = group.iter().map(|run| value(run)).collect();
    values.sort_by(f64::total_cmp);
    quantile(&values, q)
}
