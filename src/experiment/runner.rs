//! Runs what is missing, on as many threads as asked for.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use super::caught::caught;
use super::record::Ended;
use super::{Plan, Record, RunSpec, Status, Store, StoreError};
use crate::oracle::{Oracle, Rng, Watch};

/// Told of every run that ends.
pub trait Progress: Sync {
    /// A run is stored.
    fn finished(&self, run: &RunSpec, record: &Record);
}

/// Does those of `runs` that the store does not have, on `jobs` threads.
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
    let missing: Vec<_> = runs.iter().filter(|run| !store.has(&run.key)).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build()?;
    // Each thread takes the next run. Shared out as tasks of the pool, a run could begin within another's:
    // polars has threads of its own, and a worker that waits for them takes up whatever task there is.
    let next = AtomicUsize::new(0);
    let work = || -> Result<(), StoreError> {
        while let Some(run) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Some(record) = one(plan, run, watch)? {
                store.write(&record)?;
                progress.finished(run, &record);
            }
        }
        Ok(())
    };
    // After a failure no thread begins another run.
    let outcomes =
        pool.broadcast(|_| work().inspect_err(|_| next.store(missing.len(), Ordering::Relaxed)));
    Ok(outcomes.into_iter().collect::<Result<(), _>>()?)
}

/// Why running came to an end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A result could not be stored.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// No threads to be had.
    #[error("cannot start worker threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// One run, unless it is interrupted.
fn one(plan: &Plan, run: &RunSpec, watch: &Watch) -> Result<Option<Record>, StoreError> {
    if watch.is_interrupted() {
        return Ok(None);
    }
    let instance = &plan.instances[run.instance];
    let settings = &plan.optimisers[run.optimiser].settings;
    let problem = instance.problem(settings.formulation());
    let mut oracle = Oracle::new(&*problem, run.budget, watch);
    let started = Instant::now();
    let mut outcome =
        caught(|| settings.optimiser().minimise(&mut oracle, &mut Rng::new(run.seed)));
    let seconds = started.elapsed();
    let best = oracle.best();
    let motion = caught(|| best.and_then(|b| instance.certify(settings.formulation(), &b.x)));
    let motion = motion.unwrap_or_else(|panic| {
        outcome = Err(panic);
        None
    });
    let Some(status) = Status::from_outcome(outcome) else {
        return Ok(None);
    };
    // What the run did not spend will not be spent.
    watch.add_evaluations(oracle.remaining());
    Ok(Some(Record::new(plan, run, Ended { status, motion, seconds, oracle })?))
}
