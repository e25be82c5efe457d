//! Best cost against evaluations, over the seeds.

use std::collections::HashMap;

use polars::prelude::*;

use super::runs::runs;
use super::summary::quantile;

/// Quartiles of the best cost so far over the seeds of one optimiser.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The optimiser's label.
    pub optimiser: String,
    /// The instance's label.
    pub instance: String,
    /// Evaluations made, ascending.
    pub evaluations: Vec<f64>,
    /// Lower quartile, median and upper quartile at each.
    pub quartiles: Vec<[f64; 3]>,
}

/// Points of a curve, spaced evenly on a logarithmic axis.
const POINTS: usize = 200;

/// The convergence of every optimiser on every instance.
///
/// A curve holds where every run of the group still counts: up to the smallest budget among them. A
/// run that ended early keeps the best it had.
pub fn convergence(runs_table: &DataFrame, traces: &DataFrame) -> PolarsResult<Vec<Curve>> {
    let steps = steps(traces)?;
    let mut groups: Vec<(Curve, Vec<&[(f64, f64)]>, u64)> = Vec::new();
    for run in runs(runs_table)? {
        let trace = steps.get(&run.key).map_or(&[][..], Vec::as_slice);
        let same = |g: &&mut (Curve, _, _)| g.0.optimiser == run.optimiser && g.0.instance == run.instance;
        if let Some((_, traces, budget)) = groups.iter_mut().find(same) {
            traces.push(trace);
            *budget = (*budget).min(run.budget);
        } else {
            let curve = Curve {
                optimiser: run.optimiser,
                instance: run.instance,
                evaluations: Vec::new(),
                quartiles: Vec::new(),
            };
            groups.push((curve, vec![trace], run.budget));
        }
    }
    Ok(groups.into_iter().map(|(curve, traces, budget)| filled(curve, &traces, budget)).collect())
}

/// Evaluation and best cost of every row of the traces, by run.
fn steps(traces: &DataFrame) -> PolarsResult<HashMap<String, Vec<(f64, f64)>>> {
    let mut steps: HashMap<String, Vec<(f64, f64)>> = HashMap::new();
    if traces.height() == 0 {
        return Ok(steps);
    }
    let keys = traces.column("key")?.str()?;
    let evaluations = traces.column("evaluation")?.u64()?;
    let costs = traces.column("j")?.f64()?;
    for i in 0..traces.height() {
        if let (Some(key), Some(n), Some(j)) = (keys.get(i), evaluations.get(i), costs.get(i)) {
            steps.entry(key.to_owned()).or_default().push((n as f64, j));
        }
    }
    Ok(steps)
}

fn filled(mut curve: Curve, traces: &[&[(f64, f64)]], budget: u64) -> Curve {
    let last = (budget as f64).ln();
    let mut places: Vec<f64> =
        (0..POINTS).map(|i| (last * i as f64 / (POINTS - 1) as f64).exp().round()).collect();
    places.dedup();
    for place in places {
        let mut costs: Vec<f64> = traces.iter().map(|trace| best_at(trace, place)).collect();
        costs.sort_by(f64::total_cmp);
        curve.evaluations.push(place);
        curve.quartiles.push([0.25, 0.5, 0.75].map(|q| quantile(&costs, q)));
    }
    curve
}

/// Best cost after so many evaluations; infinite before the first.
fn best_at(trace: &[(f64, f64)], place: f64) -> f64 {
    let made = trace.partition_point(|(evaluation, _)| *evaluation <= place);
    made.checked_sub(1).map_or(f64::INFINITY, |i| trace[i].1)
}
