//! Best cost against evaluations, over the seeds.

use std::collections::HashMap;

use polars::prelude::*;

use super::runs::{Run, groups};
use super::summary::quantile;
use super::traces::{Trace, traces};
use crate::experiment::Plan;

/// Quartiles of the best cost so far over the seeds and the instances of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The optimiser's label.
    pub optimiser: String,
    /// The label of the instance, or of the group it belongs to.
    pub group: String,
    /// Evaluations made, ascending.
    pub evaluations: Vec<f64>,
    /// Lower quartile, median and upper quartile at each.
    pub quartiles: Vec<[f64; 3]>,
}

/// Points of a curve, spaced evenly on a logarithmic axis.
const POINTS: usize = 200;

/// The convergence of every optimiser on every group of instances, as the searches evaluated their costs.
///
/// A curve holds where every run of the group still counts: up to the smallest budget among them. A
/// run that ended early keeps the best it had.
pub fn convergence(plan: &Plan, runs: &[Run], table: &DataFrame) -> PolarsResult<Vec<Curve>> {
    let traces = traces(table)?;
    Ok(groups(plan, runs).iter().map(|group| curve(plan, group, &traces)).collect())
}

fn curve(plan: &Plan, group: &[&Run], traces: &HashMap<String, Trace>) -> Curve {
    let budget = group.iter().map(|run| run.budget).min().unwrap_or(1);
    let traces = group.iter().map(|run| traces.get(&run.key).map_or(&[][..], Vec::as_slice));
    let traces: Vec<_> = traces.collect();
    let last = (budget as f64).ln();
    let mut evaluations: Vec<f64> =
        (0..POINTS).map(|i| (last * i as f64 / (POINTS - 1) as f64).exp().round()).collect();
    evaluations.dedup();
    let quartiles = evaluations.iter().map(|&place| {
        let mut costs: Vec<f64> = traces.iter().map(|trace| best_at(trace, place)).collect();
        costs.sort_by(f64::total_cmp);
        [0.25, 0.5, 0.75].map(|q| quantile(&costs, q))
    });
    Curve {
        optimiser: plan.optimisers[group[0].optimiser].label.clone(),
        group: plan.instances[group[0].instance].group.clone(),
        quartiles: quartiles.collect(),
        evaluations,
    }
}

/// Best cost after so many evaluations; infinite before the first.
fn best_at(trace: &[(u64, f64)], place: f64) -> f64 {
    let made = trace.partition_point(|(evaluation, _)| *evaluation as f64 <= place);
    made.checked_sub(1).map_or(f64::INFINITY, |i| trace[i].1)
}
