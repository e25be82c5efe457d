//! Rows of the `runs` table.

use std::collections::HashMap;

use polars::prelude::*;

use crate::experiment::{Plan, RunSpec, Status};

/// A stored run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Key.
    pub key: String,
    /// Index of the optimiser in the plan.
    pub optimiser: usize,
    /// Index of the instance in the plan.
    pub instance: usize,
    /// Seed.
    pub seed: u64,
    /// Evaluations the run was allowed.
    pub budget: u64,
    /// Best cost, certified where there is a motion to certify; infinite for a run that failed.
    pub cost: f64,
    /// Error of the base \[°\].
    pub residual_deg: f64,
    /// Duration \[s\].
    pub duration: f64,
    /// Evaluations made.
    pub evaluations: u64,
    /// Wall time \[s\].
    pub seconds: f64,
    /// Bump coefficients of the best motion, joint by joint; none where there is no motion.
    pub coefficients: Vec<f64>,
}

/// The rows of a `runs` table, labelled as the plan labels them: an edited experiment may call a
/// stored run by another name. Runs that are not in the plan are left out.
pub fn runs(plan: &Plan, frame: &DataFrame) -> PolarsResult<Vec<Run>> {
    if frame.height() == 0 {
        return Ok(Vec::new());
    }
    let planned: HashMap<&str, &RunSpec> =
        plan.runs.iter().map(|run| (run.key.as_str(), run)).collect();
    let text = |name: &str| frame.column(name)?.str();
    let real = |name: &str| frame.column(name)?.f64();
    let whole = |name: &str| frame.column(name)?.u64();
    let (key, status) = (text("key")?, text("status")?);
    let (evaluations, cost) = (whole("evaluations")?, real("certified_j")?);
    let (residual, duration, seconds) = (real("residual_deg")?, real("t_f")?, real("seconds")?);
    let coefficients = frame.column("coefficients")?.list()?;
    let row = |i: usize| -> PolarsResult<Option<Run>> {
        let Some((key, spec)) = key.get(i).and_then(|key| planned.get_key_value(key)) else {
            return Ok(None);
        };
        let failed = status.get(i).is_some_and(Status::is_failure);
        let cost = cost.get(i).filter(|cost| !failed && cost.is_finite());
        let coefficients = match coefficients.get_as_series(i) {
            Some(list) => list.f64()?.into_no_null_iter().collect(),
            None => Vec::new(),
        };
        Ok(Some(Run {
            key: (*key).to_owned(),
            optimiser: spec.optimiser,
            instance: spec.instance,
            seed: spec.seed,
            budget: spec.budget,
            cost: cost.unwrap_or(f64::INFINITY),
            residual_deg: residual.get(i).unwrap_or(f64::NAN),
            duration: duration.get(i).unwrap_or(f64::NAN),
            evaluations: evaluations.get(i).unwrap_or_default(),
            seconds: seconds.get(i).unwrap_or(f64::NAN),
            coefficients,
        }))
    };
    (0..frame.height()).filter_map(|i| row(i).transpose()).collect()
}

/// The run with the lowest cost, unless all failed.
pub fn best_run<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    runs.filter(|run| run.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Groups runs by optimiser and the instances' groups, in the order of their first row.
pub(super) fn groups<'a>(plan: &Plan, runs: &'a [Run]) -> Vec<Vec<&'a Run>> {
    let of = |run: &Run| (run.optimiser, plan.instances[run.instance].group.as_str());
    let mut groups: Vec<Vec<&Run>> = Vec::new();
    for run in runs {
        let fits = |group: &&mut Vec<&Run>| of(group[0]) == of(run);
        match groups.iter_mut().find(fits) {
            Some(group) => group.push(run),
            None => groups.push(vec![run]),
        }
    }
    groups
}
