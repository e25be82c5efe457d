//! What is kept of a run, and the columns it is kept in.

use std::any::Any;
use std::time::Duration;

use chrono::Utc;
use polars::prelude::*;

use super::{Plan, RunSpec};
use crate::oracle::{Oracle, Stop, TracePoint};
use crate::problem::{Assessment, Evaluation};

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// The optimiser had nothing more to do.
    Finished,
    /// Every evaluation was spent.
    BudgetSpent,
    /// The optimiser or the problem panicked.
    Panicked(String),
}

impl Status {
    /// What to record; nothing for a run that the user interrupted.
    pub(super) fn from_outcome(
        outcome: Result<Result<(), Stop>, Box<dyn Any + Send>>,
    ) -> Option<Self> {
        match outcome {
            Ok(Ok(())) => Some(Self::Finished),
            Ok(Err(Stop::BudgetSpent)) => Some(Self::BudgetSpent),
            Ok(Err(stop @ Stop::NoDerivatives)) => Some(Self::Panicked(stop.to_string())),
            Ok(Err(Stop::Interrupted)) => None,
            Err(payload) => {
                let message = payload.downcast_ref::<String>().map(String::as_str);
                let message = message.or_else(|| payload.downcast_ref::<&str>().copied());
                Some(Self::Panicked(message.unwrap_or("no message").to_owned()))
            }
        }
    }

    /// The word in the `status` column.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::BudgetSpent => "budget-spent",
            Self::Panicked(_) => "panicked",
        }
    }
}

/// One run, ready to be stored.
#[derive(Debug)]
pub struct Record {
    /// The run's key.
    pub key: String,
    /// Best cost, certified; NaN when there is none.
    pub cost: f64,
    /// How the run ended.
    pub status: Status,
    /// One row of the `runs` table.
    pub(super) row: DataFrame,
    /// The run's rows of the `traces` table.
    pub(super) trace: DataFrame,
    /// The wall time of each row of the trace.
    pub(super) clock: DataFrame,
}

/// The best point of a run: as the search evaluated it, and its motion, certified.
pub(super) type BestFound = (Evaluation, (Vec<f64>, Assessment));

/// Version of the stored tables; raised when a column changes.
const FORMAT: u64 = 1;

impl Record {
    pub(super) fn new(
        plan: &Plan,
        run: &RunSpec,
        status: Status,
        best: Option<BestFound>,
        seconds: Duration,
        oracle: Oracle<'_>,
    ) -> PolarsResult<Self> {
        let cost = best.as_ref().map_or(f64::NAN, |(_, (_, certified))| certified.cost);
        let row = row(plan, run, &status, best, seconds, &oracle)?;
        let trace = oracle.into_trace();
        Ok(Self {
            key: run.key.clone(),
            cost,
            status,
            row,
            clock: clock_table(&run.key, &trace)?,
            trace: trace_table(&run.key, &trace)?,
        })
    }
}

/// The `runs` table. Costs are `J`; angles are in degrees, all else in SI units.
fn row(
    plan: &Plan,
    run: &RunSpec,
    status: &Status,
    best: Option<BestFound>,
    seconds: Duration,
    oracle: &Oracle<'_>,
) -> PolarsResult<DataFrame> {
    let entrant = &plan.optimisers[run.optimiser];
    let instance = &plan.instances[run.instance];
    let task = instance.problem.task();
    let settings = serde_json::to_string(&entrant.settings).unwrap_or_default();
    let message = if let Status::Panicked(message) = status { message.as_str() } else { "" };
    let (search, certified, coefficients) = match best {
        Some((evaluation, (coefficients, assessment))) => {
            (Some(evaluation), Some(assessment), coefficients)
        }
        None => (None, None, Vec::new()),
    };
    let found = |value: fn(&Assessment) -> f64| certified.as_ref().map(value);
    // The same limit for all joints, or none to show.
    let limit = |order: usize| {
        let first = task.limits.0[0][order];
        let uniform = task.limits.0.iter().all(|l| l[order] == first);
        // Degrees as written, without the rounding of their way through radians.
        uniform.then(|| (first.to_degrees() * 1e9).round() / 1e9)
    };
    df!(
        "format" => [FORMAT],
        "key" => [run.key.as_str()],
        "recipe" => [run.recipe.as_str()],
        "experiment" => [plan.name.as_str()],
        "optimiser" => [entrant.label.as_str()],
        "formulation" => [entrant.settings.formulation().name()],
        "settings" => [settings],
        "instance" => [instance.label.as_str()],
        "robot" => [task.robot.name.as_str()],
        "weight_base" => [task.base_weight],
        "rate_limit_deg_s" => [limit(0)],
        "acceleration_limit_deg_s2" => [limit(1)],
        "jerk_limit_deg_s3" => [limit(2)],
        "terms" => [instance.problem.family().terms() as u64],
        "seed" => [run.seed],
        "budget" => [run.budget],
        "j" => [search.map(|e| e.cost)],
        "violation" => [search.map(|e| e.violation)],
        "certified_j" => [found(|a| a.cost)],
        "residual_deg" => [found(|a| a.residual().to_degrees())],
        "t_f" => [found(|a| a.duration)],
        "penalty" => [found(Assessment::penalty)],
        "coefficients" => [Series::new("".into(), coefficients)],
        "evaluations" => [oracle.evaluations()],
        "linearisations" => [oracle.linearisations()],
        "conic_solves" => [oracle.conic_solves()],
        "conic_failures" => [oracle.conic_failures()],
        "seconds" => [seconds.as_secs_f64()],
        "seconds_in_problem" => [oracle.time_in_problem().as_secs_f64()],
        "status" => [status.name()],
        "message" => [message],
        "version" => [env!("CARGO_PKG_VERSION")],
        "commit" => [git_version::git_version!(args = ["--always", "--dirty"], fallback = "unknown")],
        "date" => [Utc::now().to_rfc3339()],
    )
}

/// The `traces` table: improvements and the last evaluation. It holds no wall time, so that equal
/// runs give equal files.
fn trace_table(key: &str, trace: &[TracePoint]) -> PolarsResult<DataFrame> {
    df!(
        "key" => vec![key; trace.len()],
        "evaluation" => trace.iter().map(|p| p.evaluation).collect::<Vec<_>>(),
        "j" => trace.iter().map(|p| p.best.cost).collect::<Vec<_>>(),
        "violation" => trace.iter().map(|p| p.best.violation).collect::<Vec<_>>(),
    )
}

/// The `clocks` table: when each row of the trace was reached \[s\].
fn clock_table(key: &str, trace: &[TracePoint]) -> PolarsResult<DataFrame> {
    df!(
        "key" => vec![key; trace.len()],
        "evaluation" => trace.iter().map(|p| p.evaluation).collect::<Vec<_>>(),
        "seconds" => trace.iter().map(|p| p.elapsed.as_secs_f64()).collect::<Vec<_>>(),
    )
}
