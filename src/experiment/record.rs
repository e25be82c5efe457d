//! What is kept of a run, and the columns it is kept in.

use std::sync::LazyLock;
use std::time::{Duration, SystemTime};

use chrono::{DateTime, Utc};
use polars::prelude::*;

use super::foreign::{ForeignRun, ForeignStep};
use super::plan::Plan;
use super::schema::{FORMAT, clocks, runs, traces};
use super::specs::RunSpec;
use super::value::{Judgement, Quantity, Value, ValueKind};
use crate::search::{Oracle, Stop, TracePoint};

/// The word for imported runs in the `status` column.
pub(super) const IMPORTED_STATUS: &str = "imported";

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// The optimiser had nothing more to do.
    Finished,
    /// Every evaluation was spent.
    BudgetSpent,
    /// The optimiser needs derivatives that the problem does not have.
    NoDerivatives,
    /// The problem failed; why.
    Failed(String),
    /// The optimiser or the problem panicked; what the panic said and where.
    Panicked(String),
    /// Another program made the run; how it ended is not known.
    Imported,
}

impl Status {
    /// What to record; nothing for a run that the user interrupted.
    pub(super) fn from_outcome(outcome: Result<Result<(), Stop>, String>) -> Option<Self> {
        match outcome {
            Ok(Ok(())) => Some(Self::Finished),
            Ok(Err(Stop::BudgetSpent)) => Some(Self::BudgetSpent),
            Ok(Err(Stop::NoDerivatives)) => Some(Self::NoDerivatives),
            Ok(Err(Stop::Interrupted)) => None,
            Ok(Err(Stop::Failed(failure))) => Some(Self::Failed(failure.to_string())),
            Err(panic) => Some(Self::Panicked(panic)),
        }
    }

    /// The word in the `status` column.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::BudgetSpent => "budget-spent",
            Self::NoDerivatives => "no-derivatives",
            Self::Failed(_) => "failed",
            Self::Panicked(_) => "panicked",
            Self::Imported => IMPORTED_STATUS,
        }
    }

    /// Whether a run with this word in its `status` column came to an end that it should not.
    pub fn is_failure(name: &str) -> bool {
        ["no-derivatives", "failed", "panicked"].contains(&name)
    }

    /// What there is to say beyond the word; empty for most.
    pub fn message(&self) -> String {
        match self {
            Self::NoDerivatives => Stop::NoDerivatives.to_string(),
            Self::Failed(message) | Self::Panicked(message) => message.clone(),
            Self::Finished | Self::BudgetSpent | Self::Imported => String::new(),
        }
    }
}

/// One run, ready to be stored.
#[derive(Debug)]
pub struct Record {
    /// The run's key.
    pub key: String,
    /// Best cost, certified where the subject does so; NaN where nothing was found.
    pub cost: f64,
    /// How the run ended.
    pub status: Status,
    /// What there is to say beyond that; empty for most.
    pub message: String,
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
    /// What the subject says of the best point.
    pub(super) judgement: Option<Judgement>,
    pub(super) seconds: Duration,
    /// Whether the best point should have been judged and could not be.
    pub(super) is_unjudged: bool,
    /// How many runs were made at a time.
    pub(super) threads: usize,
    pub(super) oracle: Oracle<'a>,
}

impl Record {
    pub(super) fn new(plan: &Plan, run: &RunSpec, ended: Ended<'_>) -> PolarsResult<Self> {
        let outcome = ended.outcome();
        let (row, cost, message) = (row(plan, run, &outcome)?, outcome.certified, outcome.message);
        let threads = Some(ended.threads as u64);
        let steps: Vec<Step> = ended.oracle.into_trace().iter().map(Step::of).collect();
        Ok(Self {
            key: run.key.clone(),
            cost: cost.unwrap_or(f64::NAN),
            message,
            status: ended.status,
            row,
            clock: clock_table(&run.key, &steps, threads)?,
            trace: trace_table(&run.key, &steps)?,
        })
    }

    /// Of a run of another program, as far as its trace tells.
    pub(super) fn imported(plan: &Plan, run: &RunSpec, found: &ForeignRun) -> PolarsResult<Self> {
        let last = found.trace.last();
        let cost = last.map(|step| step.cost);
        let outcome = Outcome {
            cost,
            certified: cost,
            evaluations: found.evaluations,
            seconds: last.and_then(|step| step.seconds),
            status: IMPORTED_STATUS,
            ..Outcome::default()
        };
        let steps: Vec<Step> = found.trace.iter().map(Step::imported).collect();
        Ok(Self {
            key: run.key.clone(),
            cost: cost.unwrap_or(f64::NAN),
            message: String::new(),
            status: Status::Imported,
            row: row(plan, run, &outcome)?,
            clock: clock_table(&run.key, &steps, None)?,
            trace: trace_table(&run.key, &steps)?,
        })
    }
}

/// What came of a run; what is not known is none.
#[derive(Debug, Default)]
struct Outcome {
    /// Best cost, as the search evaluated it.
    cost: Option<f64>,
    violation: Option<f64>,
    point: Option<Vec<f64>>,
    certified: Option<f64>,
    /// In the order of the subject's.
    measures: Vec<Value>,
    evaluations: u64,
    first_feasible: Option<u64>,
    counts: Option<Counts>,
    /// \[s\]
    seconds: Option<f64>,
    /// \[s\]
    seconds_in_problem: Option<f64>,
    status: &'static str,
    message: String,
    cpu: Option<&'static str>,
    date: Option<String>,
}

/// What the oracle counts beside evaluations.
#[derive(Debug, Clone, Copy)]
struct Counts {
    linearisations: u64,
    curvatures: u64,
    conic_solves: u64,
    conic_failures: u64,
}

/// A row of a trace and its clock; what is not known is none.
struct Step {
    evaluation: u64,
    cost: f64,
    violation: Option<f64>,
    /// \[s\]
    seconds: Option<f64>,
}

impl Step {
    fn of(point: &TracePoint) -> Self {
        Self {
            evaluation: point.evaluation,
            cost: point.best.cost,
            violation: Some(point.best.violation),
            seconds: Some(point.elapsed.as_secs_f64()),
        }
    }

    fn imported(step: &ForeignStep) -> Self {
        let ForeignStep { evaluation, cost, seconds } = *step;
        Self { evaluation, cost, violation: None, seconds }
    }
}

impl Ended<'_> {
    /// The best cost: the certified one, or the search's own.
    fn cost(&self) -> Option<f64> {
        let judged = self.judgement.as_ref().map(|judgement| judgement.cost);
        judged
            .or_else(|| self.oracle.best().filter(|_| !self.is_unjudged).map(|b| b.evaluation.cost))
    }

    fn outcome(&self) -> Outcome {
        let Self { status, judgement, seconds, oracle, .. } = self;
        let best = oracle.best();
        Outcome {
            cost: best.map(|best| best.evaluation.cost),
            violation: best.map(|best| best.evaluation.violation),
            point: best.map(|best| best.x.clone()),
            certified: self.cost(),
            measures: judgement.as_ref().map_or_else(Vec::new, |found| found.measures.clone()),
            evaluations: oracle.evaluations(),
            first_feasible: oracle.first_feasible(),
            counts: Some(Counts {
                linearisations: oracle.linearisations(),
                curvatures: oracle.curvatures(),
                conic_solves: oracle.conic_solves(),
                conic_failures: oracle.conic_failures(),
            }),
            seconds: Some(seconds.as_secs_f64()),
            seconds_in_problem: Some(oracle.time_in_problem().as_secs_f64()),
            status: status.name(),
            message: message(status, oracle),
            cpu: Some(cpu()),
            date: Some(DateTime::<Utc>::from(SystemTime::now()).to_rfc3339()),
        }
    }
}

/// What is to be said of a run beyond its status.
fn message(status: &Status, oracle: &Oracle<'_>) -> String {
    let parts = [status.message()].into_iter().chain(oracle.remarks().iter().cloned());
    parts.filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

/// The `runs` table.
fn row(plan: &Plan, run: &RunSpec, outcome: &Outcome) -> PolarsResult<DataFrame> {
    let entrant = &plan.optimisers[run.optimiser];
    let instance = &plan.instances[run.instance];
    let space = entrant.space(instance);
    let head = df!(
        runs::FORMAT => [FORMAT],
        runs::KEY => [run.key.as_str()],
        runs::RECIPE => [run.recipe.as_str()],
        runs::EXPERIMENT => [plan.name.as_str()],
        runs::PROBLEM => [instance.subject.name()],
        runs::INSTANCE => [instance.label.as_str()],
        runs::GROUP => [instance.group.as_str()],
        runs::OPTIMISER => [entrant.label.as_str()],
        runs::FORMULATION => [Some(space.as_str()).filter(|space| !space.is_empty())],
        runs::SETTINGS => [entrant.settings.to_string()],
    )?;
    let facts = cells(plan.facts(), &instance.subject.facts());
    let found = df!(
        runs::TARGETS => list(Some(&instance.targets)),
        runs::SEED => [run.seed],
        runs::BUDGET => [run.budget],
        runs::COST => [outcome.cost],
        runs::VIOLATION => [outcome.violation],
        runs::POINT => list(outcome.point.as_ref()),
        runs::CERTIFIED_COST => [outcome.certified],
    )?;
    let values = outcome.measures.iter().cloned();
    let own: Vec<_> = instance.subject.measures().into_iter().zip(values).collect();
    let measures = cells(plan.measures(), &own);
    let tail = df!(
        runs::EVALUATIONS => [outcome.evaluations],
        runs::FIRST_FEASIBLE => [outcome.first_feasible],
        runs::LINEARISATIONS => [outcome.counts.map(|counts| counts.linearisations)],
        runs::CURVATURES => [outcome.counts.map(|counts| counts.curvatures)],
        runs::CONIC_SOLVES => [outcome.counts.map(|counts| counts.conic_solves)],
        runs::CONIC_FAILURES => [outcome.counts.map(|counts| counts.conic_failures)],
        runs::SECONDS => [outcome.seconds],
        runs::SECONDS_IN_PROBLEM => [outcome.seconds_in_problem],
        runs::STATUS => [outcome.status],
        runs::MESSAGE => [outcome.message.as_str()],
        runs::VERSION => [env!("CARGO_PKG_VERSION")],
        runs::COMMIT => [git_version::git_version!(args = ["--always", "--dirty"], fallback = "unknown")],
        runs::CPU => [outcome.cpu],
        runs::DATE => [outcome.date.as_deref()],
    )?;
    head.hstack(&facts)?.hstack(found.columns())?.hstack(&measures)?.hstack(tail.columns())
}

/// One cell for each quantity of a plan; null where the row's subject has none of the name.
fn cells(all: &[Quantity], own: &[(Quantity, Value)]) -> Vec<Column> {
    let cell = |quantity: &Quantity| {
        let value = own.iter().find(|(known, _)| known.name == quantity.name);
        let value = value.map_or(&Value::None, |(_, value)| value);
        let name = quantity.name.as_str().into();
        match quantity.kind {
            ValueKind::Text => {
                let text = if let Value::Text(text) = value { Some(text.as_str()) } else { None };
                Column::new(name, [text])
            }
            ValueKind::Count => {
                let count = if let Value::Count(count) = value { Some(*count) } else { None };
                Column::new(name, [count])
            }
            ValueKind::Real => Column::new(name, [value.real()]),
            ValueKind::Reals => {
                let values = if let Value::Reals(values) = value { Some(values) } else { None };
                list(values).with_name(name).into()
            }
        }
    };
    all.iter().map(cell).collect()
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
fn trace_table(key: &str, trace: &[Step]) -> PolarsResult<DataFrame> {
    df!(
        traces::KEY => vec![key; trace.len()],
        traces::EVALUATION => trace.iter().map(|p| p.evaluation).collect::<Vec<_>>(),
        traces::COST => trace.iter().map(|p| p.cost).collect::<Vec<_>>(),
        traces::VIOLATION => trace.iter().map(|p| p.violation).collect::<Vec<_>>(),
    )
}

/// The `clocks` table: when each row of the trace was reached \[s\], and how many runs were made at a time.
fn clock_table(key: &str, trace: &[Step], threads: Option<u64>) -> PolarsResult<DataFrame> {
    df!(
        clocks::KEY => vec![key; trace.len()],
        clocks::EVALUATION => trace.iter().map(|p| p.evaluation).collect::<Vec<_>>(),
        clocks::SECONDS => trace.iter().map(|p| p.seconds).collect::<Vec<_>>(),
        clocks::THREADS => vec![threads; trace.len()],
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
