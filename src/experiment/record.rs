//! What is kept of a run, and the columns it is kept in.

use std::sync::LazyLock;
use std::time::Duration;

use chrono::Utc;
use polars::prelude::*;

use super::{Plan, RunSpec};
use crate::reorientation::Assessment;
use crate::search::{Oracle, Stop, TracePoint};

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// The optimiser had nothing more to do.
    Finished,
    /// Every evaluation was spent.
    BudgetSpent,
    /// The optimiser needs derivatives that the problem does not have.
    NoDerivatives,
    /// The optimiser or the problem panicked; what the panic said and where.
    Panicked(String),
}

impl Status {
    /// What to record; nothing for a run that the user interrupted.
    pub(super) fn from_outcome(outcome: Result<Result<(), Stop>, String>) -> Option<Self> {
        match outcome {
            Ok(Ok(())) => Some(Self::Finished),
            Ok(Err(Stop::BudgetSpent)) => Some(Self::BudgetSpent),
            Ok(Err(Stop::NoDerivatives)) => Some(Self::NoDerivatives),
            Ok(Err(Stop::Interrupted)) => None,
            Err(panic) => Some(Self::Panicked(panic)),
        }
    }

    /// The word in the `status` column.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::BudgetSpent => "budget-spent",
            Self::NoDerivatives => "no-derivatives",
            Self::Panicked(_) => "panicked",
        }
    }

    /// Whether a run with this word in its `status` column came to an end that it should not.
    pub fn is_failure(name: &str) -> bool {
        ["no-derivatives", "panicked"].contains(&name)
    }

    /// What there is to say beyond the word; empty for most.
    pub fn message(&self) -> String {
        match self {
            Self::NoDerivatives => Stop::NoDerivatives.to_string(),
            Self::Panicked(message) => message.clone(),
            Self::Finished | Self::BudgetSpent => String::new(),
        }
    }
}

/// One run, ready to be stored.
#[derive(Debug)]
pub struct Record {
    /// The run's key.
    pub key: String,
    /// Best cost, certified where there is a motion to certify; NaN when there is none.
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

/// A run that has just ended.
pub(super) struct Ended<'a> {
    pub(super) status: Status,
    /// The best point's motion, certified: its coefficients and what is known of it.
    pub(super) motion: Option<(Vec<f64>, Assessment)>,
    pub(super) seconds: Duration,
    /// How many runs were made at a time.
    pub(super) threads: usize,
    pub(super) oracle: Oracle<'a>,
}

/// Version of the stored tables; raised when a column changes.
pub(super) const FORMAT: u64 = 5;

impl Record {
    pub(super) fn new(plan: &Plan, run: &RunSpec, ended: Ended<'_>) -> PolarsResult<Self> {
        let cost = ended.cost(plan, run);
        let row = row(plan, run, cost, &ended)?;
        let threads = ended.threads;
        let trace = ended.oracle.into_trace();
        Ok(Self {
            key: run.key.clone(),
            cost: cost.unwrap_or(f64::NAN),
            status: ended.status,
            row,
            clock: clock_table(&run.key, &trace, threads)?,
            trace: trace_table(&run.key, &trace)?,
        })
    }
}

impl Ended<'_> {
    /// The best cost: the certified motion's, or the search's own where there are no motions.
    fn cost(&self, plan: &Plan, run: &RunSpec) -> Option<f64> {
        if plan.instances[run.instance].is_task() {
            self.motion.as_ref().map(|(_, certified)| certified.cost)
        } else {
            self.oracle.best().map(|best| best.evaluation.cost)
        }
    }
}

/// The `runs` table. Angles are in degrees, all else in SI units; what only a task has is null for
/// other problems.
fn row(
    plan: &Plan,
    run: &RunSpec,
    cost: Option<f64>,
    ended: &Ended<'_>,
) -> PolarsResult<DataFrame> {
    let Ended { status, motion, seconds, threads: _, oracle } = ended;
    let entrant = &plan.optimisers[run.optimiser];
    let instance = &plan.instances[run.instance];
    let problem = instance.reorientation();
    let task = problem.map(|problem| &**problem.task());
    let settings = serde_json::to_string(&entrant.settings).unwrap_or_default();
    let best = oracle.best();
    let found = |value: fn(&Assessment) -> f64| motion.as_ref().map(|(_, motion)| value(motion));
    let limit = |order: usize| task.and_then(|task| task.uniform_limit_deg(order));
    df!(
        "format" => [FORMAT],
        "key" => [run.key.as_str()],
        "recipe" => [run.recipe.as_str()],
        "experiment" => [plan.name.as_str()],
        "problem" => [instance.subject.name()],
        "instance" => [instance.label.as_str()],
        "group" => [instance.group.as_str()],
        "optimiser" => [entrant.label.as_str()],
        "formulation" => [problem.map(|_| entrant.settings.formulation().name())],
        "settings" => [settings],
        "robot" => [task.map(|task| task.robot.name.as_str())],
        "weight_base" => [task.map(|task| task.base_weight)],
        "rate_limit_deg_s" => [limit(0)],
        "acceleration_limit_deg_s2" => [limit(1)],
        "jerk_limit_deg_s3" => [limit(2)],
        "terms" => [problem.map(|problem| problem.family().terms() as u64)],
        "lanes" => [problem.map(|problem| problem.width().lanes() as u64)],
        "targets" => list(Some(&instance.targets)),
        "seed" => [run.seed],
        "budget" => [run.budget],
        "j" => [best.map(|best| best.evaluation.cost)],
        "violation" => [best.map(|best| best.evaluation.violation)],
        "x" => list(best.map(|best| &best.x)),
        "certified_j" => [cost],
        "residual_deg" => [found(|a| a.residual().to_degrees())],
        "t_f" => [found(|a| a.duration)],
        "penalty" => [found(Assessment::penalty)],
        "coefficients" => list(motion.as_ref().map(|(coefficients, _)| coefficients)),
        "evaluations" => [oracle.evaluations()],
        "first_feasible" => [oracle.first_feasible()],
        "linearisations" => [oracle.linearisations()],
        "curvatures" => [oracle.curvatures()],
        "conic_solves" => [oracle.conic_solves()],
        "conic_failures" => [oracle.conic_failures()],
        "seconds" => [seconds.as_secs_f64()],
        "seconds_in_problem" => [oracle.time_in_problem().as_secs_f64()],
        "status" => [status.name()],
        "message" => [status.message()],
        "version" => [env!("CARGO_PKG_VERSION")],
        "commit" => [git_version::git_version!(args = ["--always", "--dirty"], fallback = "unknown")],
        "cpu" => [cpu()],
        "date" => [Utc::now().to_rfc3339()],
    )
}

/// One cell that holds a list of numbers, or null.
fn list(values: Option<&Vec<f64>>) -> Series {
    let size = values.map_or(0, Vec::len);
    let mut cell =
        ListPrimitiveChunkedBuilder::<Float64Type>::new("".into(), 1, size, DataType::Float64);
    cell.append_opt_slice(values.map(Vec::as_slice));
    cell.finish().into_series()
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

/// The `clocks` table: when each row of the trace was reached \[s\], and how many runs were made at a time.
fn clock_table(key: &str, trace: &[TracePoint], threads: usize) -> PolarsResult<DataFrame> {
    df!(
        "key" => vec![key; trace.len()],
        "evaluation" => trace.iter().map(|p| p.evaluation).collect::<Vec<_>>(),
        "seconds" => trace.iter().map(|p| p.elapsed.as_secs_f64()).collect::<Vec<_>>(),
        "threads" => vec![threads as u64; trace.len()],
    )
}

/// What the processor calls itself, or its architecture.
fn cpu() -> &'static str {
    static NAME: LazyLock<String> = LazyLock::new(|| {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let name = raw_cpuid::CpuId::new().get_processor_brand_string();
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        let name = name.map(|name| name.as_str().trim().to_owned());
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        let name = None;
        name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
    });
    &NAME
}
