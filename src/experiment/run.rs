//! Stored runs.

/// A stored run.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
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
    /// Best cost, certified where the subject does so; infinite for a run that failed.
    pub cost: f64,
    /// What the subject measured of the best point, in the order of [`Results::measures`](super::Results::measures); NaN where it did not.
    pub measures: Vec<f64>,
    /// Evaluations made.
    pub evaluations: u64,
    /// The first evaluation within all limits, if there was one.
    pub first_feasible: Option<u64>,
    /// Wall time \[s\].
    pub seconds: f64,
    /// The best point, in the variables of the optimiser's formulation; empty where nothing was found.
    pub x: Vec<f64>,
    /// Improvements of the best cost and the last evaluation, in order; none where nothing was found.
    pub trace: Vec<Improvement>,
}

/// A row of a run's trace: an improvement, or the last evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Improvement {
    /// Which evaluation, counted from one.
    pub evaluation: u64,
    /// Best cost so far, as the search evaluated it.
    pub cost: f64,
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

    /// One of the measures, by its place among those of the plan; NaN where there is none.
    pub fn measure(&self, place: usize) -> f64 {
        self.measures.get(place).copied().unwrap_or(f64::NAN)
    }
}

/// Share of a cost by which one that an imported run tells may be lower than the same cost, certified.
const UNCERTIFIED: f64 = 1e-6;

/// The run with the lowest cost, unless all failed. One whose point is not known is no better than the same cost with a point.
pub fn best_run<'a>(runs: impl Iterator<Item = &'a Run>) -> Option<&'a Run> {
    let found: Vec<&Run> = runs.filter(|run| run.cost.is_finite()).collect();
    let lowest = found.iter().copied().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let same = lowest.cost + UNCERTIFIED * lowest.cost.abs();
    let known = found.into_iter().filter(|run| !run.x.is_empty() && run.cost <= same);
    known.min_by(|a, b| a.cost.total_cmp(&b.cost)).or(Some(lowest))
}
