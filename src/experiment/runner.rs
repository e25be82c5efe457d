//! Runs what is missing, on as many threads as asked for.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use rayon::prelude::*;

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
/// nothing behind; one that fails leaves a record that says so.
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
    pool.install(|| {
        missing.par_iter().with_max_len(1).try_for_each(|run| {
            if let Some(record) = one(plan, run, watch)? {
                store.write(&record)?;
                progress.finished(run, &record);
            }
            Ok(())
        })
    })
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
    let problem = plan.problem(run);
    let optimiser = plan.optimisers[run.optimiser].settings.optimiser();
    let mut oracle = Oracle::new(&problem, run.budget, watch);
    let started = Instant::now();
    let searched =
        catch_unwind(AssertUnwindSafe(|| optimiser.minimise(&mut oracle, &mut Rng::new(run.seed))));
    let seconds = started.elapsed();
    let certified = catch_unwind(AssertUnwindSafe(|| {
        oracle.best().map(|best| (best.evaluation, problem.certify(&best.x)))
    }));
    let (outcome, best) = match certified {
        Ok(best) => (searched, best),
        Err(panic) => (Err(panic), None),
    };
    let Some(status) = Status::from_outcome(outcome) else {
        return Ok(None);
    };
    // What the run did not spend will not be spent.
    watch.add_evaluations(oracle.remaining());
    Ok(Some(Record::new(plan, run, status, best, seconds, oracle)?))
}
