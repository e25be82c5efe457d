//! Stored runs.

use std::collections::HashMap;

use polars::prelude::*;

use super::statistics::Trial;
use crate::experiment::{Plan, RunSpec, Status, Store, StoreError};

/// A stored run.
#[derive(Debug, Clone, Default, PartialEq)]
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
    /// The first evaluation within all limits, if there was one.
    pub first_feasible: Option<u64>,
    /// Wall time \[s\].
    pub seconds: f64,
    /// Bump coefficients of the best motion, joint by joint; none where there is no motion.
    pub coefficients: Vec<f64>,
    /// Improvements of the best cost and the last evaluation, in order; none where nothing was found.
    pub trace: Vec<Improvement>,
}

impl Run {
    /// Best cost after so many evaluations; infinite before the first.
    pub fn best_at(&self, evaluations: u64) -> f64 {
        let made = self.trace.partition_point(|step| step.evaluation <= evaluations);
        made.checked_sub(1).map_or(f64::INFINITY, |i| self.trace[i].cost)
    }

    /// The first evaluation with a cost of this or less, if there was one.
    pub fn hit(&self, target: f64) -> Option<u64> {
        let before = self.trace.partition_point(|step| step.cost > target);
        self.trace.get(before).map(|step| step.evaluation)
    }

    /// What the run says about a target.
    pub(super) fn trial(&self, target: f64) -> Trial {
        let hit = self.hit(target);
        Trial { evaluations: hit.unwrap_or(self.evaluations) as f64, solved: hit.is_some() }
    }
}

/// A row of a run's trace: an improvement, or the last evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Improvement {
    /// Which evaluation, counted from one.
    pub evaluation: u64,
    /// Best cost so far, as the search evaluated it.
    pub cost: f64,
}

/// The columns of `runs` that are read.
const COLUMNS: [&str; 9] = [
    "key",
    "status",
    "evaluations",
    "first_feasible",
    "certified_j",
    "residual_deg",
    "t_f",
    "seconds",
    "coefficients",
];

/// The stored runs of a plan, in its order. They are labelled as the plan labels them: an edited
/// experiment may call a stored run by another name.
pub fn load(plan: &Plan, store: &Store) -> Result<Vec<Run>, StoreError> {
    let planned = plan.places();
    let wanted = |key: &str| planned.contains_key(key);
    let mut runs: Vec<Option<Run>> = Vec::new();
    runs.resize_with(plan.runs.len(), || None);
    store.visit("runs", &COLUMNS, wanted, |frame| {
        rows(frame, |key, row| {
            if let Some(&i) = planned.get(key) {
                runs[i] = Some(row.run(&plan.runs[i])?);
            }
            Ok(())
        })
    })?;
    store.visit("traces", &["key", "evaluation", "j"], wanted, |frame| {
        let keys = frame.column("key")?.str()?;
        let (evaluations, costs) = (frame.column("evaluation")?.u64()?, frame.column("j")?.f64()?);
        for ((key, evaluation), cost) in keys.iter().zip(evaluations.iter()).zip(costs.iter()) {
            let run = key.and_then(|key| planned.get(key)).and_then(|&i| runs[i].as_mut());
            if let (Some(run), Some(evaluation), Some(cost)) = (run, evaluation, cost) {
                run.trace.push(Improvement { evaluation, cost });
            }
        }
        Ok(())
    })?;
    Ok(runs.into_iter().flatten().collect())
}

/// One row of the `runs` table.
struct Row<'a> {
    columns: &'a Columns<'a>,
    row: usize,
}

struct Columns<'a> {
    key: &'a StringChunked,
    status: &'a StringChunked,
    evaluations: &'a UInt64Chunked,
    first_feasible: &'a UInt64Chunked,
    cost: &'a Float64Chunked,
    residual: &'a Float64Chunked,
    duration: &'a Float64Chunked,
    seconds: &'a Float64Chunked,
    coefficients: &'a ListChunked,
}

fn rows(
    frame: &DataFrame,
    mut visitor: impl FnMut(&str, &Row<'_>) -> PolarsResult<()>,
) -> PolarsResult<()> {
    let columns = Columns {
        key: frame.column("key")?.str()?,
        status: frame.column("status")?.str()?,
        evaluations: frame.column("evaluations")?.u64()?,
        first_feasible: frame.column("first_feasible")?.u64()?,
        cost: frame.column("certified_j")?.f64()?,
        residual: frame.column("residual_deg")?.f64()?,
        duration: frame.column("t_f")?.f64()?,
        seconds: frame.column("seconds")?.f64()?,
        coefficients: frame.column("coefficients")?.list()?,
    };
    for row in 0..frame.height() {
        if let Some(key) = columns.key.get(row) {
            visitor(key, &Row { columns: &columns, row })?;
        }
    }
    Ok(())
}

impl Row<'_> {
    fn run(&self, spec: &RunSpec) -> PolarsResult<Run> {
        let &Self { columns, row } = self;
        let failed = columns.status.get(row).is_some_and(Status::is_failure);
        let cost = columns.cost.get(row).filter(|cost| !failed && cost.is_finite());
        let coefficients = match columns.coefficients.get_as_series(row) {
            Some(list) => list.f64()?.into_no_null_iter().collect(),
            None => Vec::new(),
        };
        Ok(Run {
            key: spec.key.clone(),
            optimiser: spec.optimiser,
            instance: spec.instance,
            seed: spec.seed,
            budget: spec.budget,
            cost: cost.unwrap_or(f64::INFINITY),
            residual_deg: columns.residual.get(row).unwrap_or(f64::NAN),
            duration: columns.duration.get(row).unwrap_or(f64::NAN),
            evaluations: columns.evaluations.get(row).unwrap_or_default(),
            first_feasible: columns.first_feasible.get(row),
            seconds: columns.seconds.get(row).unwrap_or(f64::NAN),
            coefficients,
            trace: Vec::new(),
        })
    }
}

/// The run with the lowest cost, unless all failed.
pub fn best_run<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    runs.filter(|run| run.cost.is_finite()).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Groups runs by optimiser and the instances' groups, in the order of their first row.
pub(super) fn groups<'a>(plan: &Plan, runs: &'a [Run]) -> Vec<Vec<&'a Run>> {
    let mut places = HashMap::new();
    let mut groups: Vec<Vec<&Run>> = Vec::new();
    for run in runs {
        let of = (run.optimiser, plan.instances[run.instance].group.as_str());
        let place = *places.entry(of).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(run);
    }
    groups
}
