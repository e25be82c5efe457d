//! How low the cost is after so many evaluations.

use polars::prelude::*;
use rayon::prelude::*;

use super::interval::interval;
use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::{median, quartiles};
use crate::exhibit::Table;

/// One line per group, number of evaluations and optimiser.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    struct Line<'a> {
        labels: [&'a str; 2],
        evaluations: u64,
        costs: Vec<f64>,
    }
    let mut lines = Vec::new();
    for group in &analysis.groups {
        let budget = group.iter().map(|run| run.budget).min().unwrap_or(1);
        for evaluations in budgets(budget) {
            let costs = group.iter().map(|run| run.best_at(evaluations)).collect();
            lines.push(Line { labels: analysis.labels(group), evaluations, costs });
        }
    }
    let intervals: Vec<[f64; 2]> = lines
        .par_iter()
        .map(|line| interval(&line.costs, |costs| median(costs.to_vec())))
        .collect();
    let quartiles: Vec<_> = lines.iter().map(|l| quartiles(l.costs.iter().copied())).collect();
    let frame = df!(
        "group" => lines.iter().map(|l| l.labels[1]).collect::<Vec<_>>(),
        "evaluations" => lines.iter().map(|l| l.evaluations).collect::<Vec<_>>(),
        "optimiser" => lines.iter().map(|l| l.labels[0]).collect::<Vec<_>>(),
        "runs" => lines.iter().map(|l| l.costs.len() as u64).collect::<Vec<_>>(),
        "quartile 1" => quartiles.iter().map(|q| q[0]).collect::<Vec<_>>(),
        "median" => quartiles.iter().map(|q| q[1]).collect::<Vec<_>>(),
        "quartile 3" => quartiles.iter().map(|q| q[2]).collect::<Vec<_>>(),
        "median 2.5 %" => intervals.iter().map(|ends| ends[0]).collect::<Vec<_>>(),
        "median 97.5 %" => intervals.iter().map(|ends| ends[1]).collect::<Vec<_>>(),
    )?;
    let caption = "Best cost so far, as the search evaluated it, after so many evaluations: quartiles over the runs, \
        and the median's 95 % bootstrap percentile interval (1000 resamples; fewer of samples above 1000, 400 at least).";
    Ok(Table::of("fixed-budget", caption, frame))
}

/// Powers of ten up to a budget, and the budget.
fn budgets(budget: u64) -> impl Iterator<Item = u64> {
    let powers = std::iter::successors(Some(10_u64), |power| power.checked_mul(10));
    powers.take_while(move |&power| power < budget).chain([budget])
}
