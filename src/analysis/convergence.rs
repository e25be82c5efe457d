//! Best cost against evaluations, over the seeds.

use rayon::prelude::*;

use super::runs::{Run, groups};
use super::statistics::quartiles;
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
pub fn convergence(plan: &Plan, runs: &[Run]) -> Vec<Curve> {
    groups(plan, runs).iter().map(|group| curve(plan, group)).collect()
}

fn curve(plan: &Plan, group: &[&Run]) -> Curve {
    let budget = group.iter().map(|run| run.budget).min().unwrap_or(1);
    let last = (budget as f64).ln();
    let mut evaluations: Vec<f64> =
        (0..POINTS).map(|i| (last * i as f64 / (POINTS - 1) as f64).exp().round()).collect();
    evaluations.dedup();
    let quartiles = evaluations
        .par_iter()
        .map(|&place| quartiles(group.iter().map(|run| run.best_at(place as u64))));
    Curve {
        optimiser: plan.optimisers[group[0].optimiser].label.clone(),
        group: plan.instances[group[0].instance].group.clone(),
        quartiles: quartiles.collect(),
        evaluations,
    }
}
