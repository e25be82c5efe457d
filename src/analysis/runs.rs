//! Rows of the `runs` table.

use polars::prelude::*;

/// What the summary needs of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Key.
    pub key: String,
    /// Label of the optimiser.
    pub optimiser: String,
    /// Label of the instance.
    pub instance: String,
    /// Seed.
    pub seed: u64,
    /// Evaluations the run was allowed.
    pub budget: u64,
    /// Best cost found by the search; infinite where it found none.
    pub cost: f64,
    /// Best cost, certified.
    pub certified_cost: f64,
    /// Error of the base \[°\].
    pub residual_deg: f64,
    /// Duration \[s\].
    pub duration: f64,
    /// Evaluations made.
    pub evaluations: u64,
    /// Wall time \[s\].
    pub seconds: f64,
    /// How it ended.
    pub status: String,
}

/// The best motion of a set of runs.
#[derive(Debug, Clone, PartialEq)]
pub struct BestRun {
    /// Label of the optimiser.
    pub optimiser: String,
    /// Label of the instance.
    pub instance: String,
    /// Seed.
    pub seed: u64,
    /// Cost, certified.
    pub certified_cost: f64,
    /// Duration \[s\].
    pub duration: f64,
    /// Bump coefficients, joint by joint.
    pub coefficients: Vec<f64>,
}

/// The rows of a `runs` table.
pub fn runs(frame: &DataFrame) -> PolarsResult<Vec<Run>> {
    if frame.height() == 0 {
        return Ok(Vec::new());
    }
    let text = |name: &str| frame.column(name)?.str();
    let real = |name: &str| frame.column(name)?.f64();
    let whole = |name: &str| frame.column(name)?.u64();
    let (key, optimiser, instance) = (text("key")?, text("optimiser")?, text("instance")?);
    let (status, seed, budget) = (text("status")?, whole("seed")?, whole("budget")?);
    let (evaluations, cost, certified) = (whole("evaluations")?, real("j")?, real("certified_j")?);
    let (residual, duration, seconds) = (real("residual_deg")?, real("t_f")?, real("seconds")?);
    let string = |column: &StringChunked, i| column.get(i).unwrap_or_default().to_owned();
    let row = |i: usize| Run {
        key: string(key, i),
        optimiser: string(optimiser, i),
        instance: string(instance, i),
        seed: seed.get(i).unwrap_or_default(),
        budget: budget.get(i).unwrap_or_default(),
        cost: cost.get(i).unwrap_or(f64::INFINITY),
        certified_cost: certified.get(i).unwrap_or(f64::INFINITY),
        residual_deg: residual.get(i).unwrap_or(f64::NAN),
        duration: duration.get(i).unwrap_or(f64::NAN),
        evaluations: evaluations.get(i).unwrap_or_default(),
        seconds: seconds.get(i).unwrap_or(f64::NAN),
        status: string(status, i),
    };
    Ok((0..frame.height()).map(row).collect())
}

/// The run with the lowest certified cost, if any run found a motion.
pub fn best_run(frame: &DataFrame) -> PolarsResult<Option<BestRun>> {
    let rows = runs(frame)?;
    let costs = rows.iter().map(|run| run.certified_cost).enumerate();
    let best = costs.filter(|(_, c)| c.is_finite()).min_by(|(_, a), (_, b)| a.total_cmp(b));
    let Some((i, _)) = best else { return Ok(None) };
    let coefficients = frame.column("coefficients")?.list()?.get_as_series(i);
    let coefficients = coefficients.unwrap_or_default().f64()?.into_no_null_iter().collect();
    let run = &rows[i];
    Ok(Some(BestRun {
        optimiser: run.optimiser.clone(),
        instance: run.instance.clone(),
        seed: run.seed,
        certified_cost: run.certified_cost,
        duration: run.duration,
        coefficients,
    }))
}

/// Groups runs by instance and optimiser, in the order of their first row.
pub(super) fn groups(runs: &[Run]) -> Vec<Vec<&Run>> {
    let mut groups: Vec<Vec<&Run>> = Vec::new();
    for run in runs {
        let fits =
            |g: &&mut Vec<&Run>| g[0].optimiser == run.optimiser && g[0].instance == run.instance;
        match groups.iter_mut().find(fits) {
            Some(group) => group.push(run),
            None => groups.push(vec![run]),
        }
    }
    groups
}
