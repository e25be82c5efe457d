//! Runs what is missing, on as many threads as asked for.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use super::caught::caught;
use super::plan::Plan;
use super::record::{Ended, Record, Status};
use super::specs::RunSpec;
use super::store::{Damage, Store, StoreError};
use super::subject::Subject;
use super::value::Judgement;
use crate::search::{Failure, Oracle, Rng, Watch};
use crate::words::plural;

/// Told of every run that ends.
pub trait Progress: Sync {
    /// A run is stored.
    fn finished(&self, run: &RunSpec, record: &Record);

    /// A stored file is damaged: its batch was moved into the folder `damaged`, and its runs are done again.
    fn set_aside(&self, damage: &Damage) {
        let _ = damage;
    }

    /// Another process is merging files, and is waited for.
    fn waiting(&self) {}
}

/// Tells nobody.
impl Progress for () {
    fn finished(&self, _: &RunSpec, _: &Record) {}
}

/// Runs that together are allowed fewer evaluations than this are stored as one batch.
const EVALUATIONS_PER_BATCH: u64 = 500;
/// After so many batches the store is tidied.
const BATCHES_TO_TIDY: usize = 1_000;
/// What is done waits no longer to be stored, however few evaluations it took.
const LONGEST_WAIT: Duration = Duration::from_secs(1);

/// Does those of `runs` that the store does not have, on `jobs` threads. What is damaged is set aside before. Those that only another program can do
/// are an error once all others are done.
///
/// What a run gives does not depend on the other runs. A run that the user interrupts leaves
/// nothing behind; one that fails, be it by a panic, leaves a record that says so.
pub fn run(
    plan: &Plan,
    runs: &[&RunSpec],
    store: &Store,
    jobs: usize,
    watch: &Watch,
    progress: &dyn Progress,
) -> Result<(), RunError> {
    let damaged = store.set_aside(&|| progress.waiting())?;
    for damage in &damaged {
        progress.set_aside(damage);
    }
    let stored = store.keys()?;
    let missing = runs.iter().copied().filter(|run| !stored.contains(&run.key));
    let (missing, foreign): (Vec<_>, Vec<_>) =
        missing.partition(|run| plan.obstacle(run).is_none());
    let batches = batches(&missing);
    // More threads than batches would have nothing to do.
    let jobs = jobs.min(batches.len()).max(1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| RunError::Threads(error.to_string()))?;
    // Each thread takes the next batch. Shared out as tasks of the pool, a run could begin within another's:
    // polars has threads of its own, and a worker that waits for them takes up whatever task there is.
    let next = AtomicUsize::new(0);
    let work = || -> Result<(), RunError> {
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(batch) = batches.get(place) else { return Ok(()) };
            run_batch(plan, batch, jobs, store, watch, progress)?;
            if (place + 1).is_multiple_of(BATCHES_TO_TIDY) {
                store.tidy(watch)?;
            }
        }
    };
    // After a failure no thread begins another batch.
    let outcomes =
        pool.broadcast(|_| work().inspect_err(|_| next.store(batches.len(), Ordering::Relaxed)));
    outcomes.into_iter().collect::<Result<(), _>>()?;
    store.tidy(watch)?;
    match foreign.first().and_then(|run| plan.obstacle(run)) {
        Some(reason) => Err(RunError::foreign(&reason)),
        None => Ok(()),
    }
}

/// Cuts runs, in their order, into batches: long runs alone, short ones together.
fn batches<'a>(mut runs: &'a [&'a RunSpec]) -> Vec<&'a [&'a RunSpec]> {
    let mut batches = Vec::new();
    while !runs.is_empty() {
        let mut sum = 0_u64;
        let short = runs.iter().position(|run| {
            let is_long = run.budget >= EVALUATIONS_PER_BATCH;
            let is_full = sum >= EVALUATIONS_PER_BATCH;
            sum = sum.saturating_add(run.budget);
            is_long || is_full
        });
        let (batch, others) = runs.split_at(short.unwrap_or(runs.len()).max(1));
        batches.push(batch);
        runs = others;
    }
    batches
}

/// Does the runs of a batch and stores them.
fn run_batch(
    plan: &Plan,
    batch: &[&RunSpec],
    threads: usize,
    store: &Store,
    watch: &Watch,
    progress: &dyn Progress,
) -> Result<(), RunError> {
    let mut done = Vec::new();
    let keep = |done: &mut Vec<(&RunSpec, Record)>| -> Result<(), StoreError> {
        if !done.is_empty() {
            store.write(done.iter().map(|(_, record)| record))?;
            done.drain(..).for_each(|(run, record)| progress.finished(run, &record));
        }
        Ok(())
    };
    let mut waiting = Instant::now();
    for run in batch {
        done.extend(one(plan, run, threads, watch)?.map(|record| (*run, record)));
        if waiting.elapsed() > LONGEST_WAIT {
            keep(&mut done)?;
            waiting = Instant::now();
        }
    }
    Ok(keep(&mut done)?)
}

/// Why running came to an end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A result could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A problem or an optimiser is another program's.
    #[error("{0}, which alone can do the runs that are missing")]
    Foreign(String),
    /// A problem could not be made.
    #[error("cannot make a problem")]
    Problem(#[from] Failure),
    /// No threads to be had.
    #[error("cannot start worker threads: {0}")]
    Threads(String),
}

impl RunError {
    /// That only another program can do what is missing, for this reason.
    pub(crate) fn foreign(reason: &Failure) -> Self {
        Self::Foreign(reason.to_string())
    }
}

/// What the subject says of a point, complete.
fn judge(subject: &dyn Subject, space: &str, x: &[f64]) -> Result<Option<Judgement>, Failure> {
    let judgement = subject.judge(space, x)?;
    let expected = subject.measures().len();
    match judgement.as_ref().map(|judgement| judgement.measures.len()) {
        Some(found) if found != expected => Err(Failure::new(format!(
            "found {} in a judgement, expected {expected}, one per measure",
            plural(found, "value")
        ))),
        _ => Ok(judgement),
    }
}

/// One run, unless it is interrupted.
fn one(
    plan: &Plan,
    run: &RunSpec,
    threads: usize,
    watch: &Watch,
) -> Result<Option<Record>, RunError> {
    if watch.is_interrupted() {
        return Ok(None);
    }
    let (instance, entrant) = (&plan.instances[run.instance], &plan.optimisers[run.optimiser]);
    let space = entrant.space(instance);
    let (problem, optimiser) = (instance.subject.problem(&space)?, entrant.optimiser()?);
    // What cannot be prepared is told of when it is evaluated.
    let _ = caught(|| problem.prepare(watch));
    let mut oracle = Oracle::new(&*problem, run.budget, watch);
    let outcome = caught(|| optimiser.minimise(&mut oracle, &mut Rng::new(run.seed)));
    let seconds = oracle.elapsed();
    let Some(mut status) = Status::from_outcome(outcome) else {
        return Ok(None);
    };
    if watch.is_interrupted() && matches!(status, Status::Failed(_)) {
        return Ok(None);
    }
    let best = oracle.best();
    let judged =
        caught(|| best.map_or(Ok(None), |best| judge(&*instance.subject, &space, &best.x)));
    let (judgement, is_unjudged) = match judged {
        Ok(Ok(judgement)) => (judgement, false),
        Ok(Err(failure)) => {
            status = Status::Failed(failure.to_string());
            (None, true)
        }
        Err(panic) => {
            status = Status::Panicked(panic);
            (None, true)
        }
    };
    // What the run did not spend will not be spent.
    watch.add_evaluations(oracle.remaining());
    let ended = Ended { status, judgement, seconds, is_unjudged, threads, oracle };
    Ok(Some(Record::new(plan, run, ended).map_err(StoreError::from)?))
}
