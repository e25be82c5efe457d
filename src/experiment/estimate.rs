//! How long an experiment takes, from a short trial of every optimiser.

use std::collections::{BTreeMap, HashMap};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};

use super::balance::{Sensible, sensible};
use super::caught::caught;
use super::external::ExternalProblem;
use super::plan::Plan;
use super::runner::RunError;
use super::specs::RunSpec;
use crate::optimiser::Optimiser;
use crate::search::{Oracle, Rng, Watch};

/// What all trials may take together, on each thread.
const ALLOWANCE: Duration = Duration::from_secs(4);

/// What one trial may take.
const LONGEST: Duration = Duration::from_secs(1);

/// How much longer a trial with derivatives may be: its runs mostly end by themselves, long before
/// their budget, and how soon is to be seen.
const WITH_DERIVATIVES: u32 = 4;

/// Instances of each kind that are tried.
const TRIED: usize = 3;

/// What a run that starts a program is taken to last at least: long enough that many shards make sense.
const UNKNOWN: Duration = Duration::from_mins(1);

/// How long the runs of a plan take.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Of every run, in the order of the plan; none where it was not tried.
    runs: Vec<Option<Duration>>,
}

/// How long the runs of a plan take, from trials of a few seconds in all, as many at a time as `jobs` says.
///
/// Every optimiser is tried on a few instances with each number of variables. A run that ends within
/// its trial takes what it took; of another what it spent of its budget is scaled up to all of it,
/// which is too much for one that would have ended earlier.
pub fn estimate(plan: &Plan, jobs: usize) -> Result<Estimate, RunError> {
    let trials = choose(plan);
    let weights = trials.iter().map(|run| weight(plan, run)).sum::<u32>().max(1);
    let share = ALLOWANCE * u32::try_from(jobs).unwrap_or(u32::MAX).min(1024) / weights;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| RunError::Threads(error.to_string()))?;
    let seconds: Result<Vec<f64>, RunError> = pool.install(|| {
        let timed = |run: &&RunSpec| attempt(plan, run, (share * weight(plan, run)).min(LONGEST));
        trials.par_iter().map(timed).collect()
    });
    // Seconds and number of the trials of each optimiser on each kind of instance.
    let mut found: HashMap<_, (f64, f64)> = HashMap::new();
    for (run, seconds) in trials.iter().zip(seconds?) {
        let (sum, number) = found.entry(kind(plan, run)).or_default();
        *sum += seconds;
        *number += 1.0;
    }
    let mean = |(sum, number): &(f64, f64)| {
        Duration::try_from_secs_f64(sum / number).unwrap_or(Duration::MAX)
    };
    let runs = plan.runs.iter().map(|run| found.get(&kind(plan, run)).map(mean)).collect();
    Ok(Estimate { runs })
}

impl Estimate {
    /// Whether some runs start programs, and were not tried.
    pub fn is_partial(&self) -> bool {
        self.runs.iter().any(Option::is_none)
    }

    /// Wall time of all runs that were tried on so many threads.
    pub fn time(&self, threads: usize) -> Duration {
        let tried = || self.runs.iter().flatten();
        let all = tried().map(Duration::as_secs_f64).sum::<f64>() / threads as f64;
        let all = Duration::try_from_secs_f64(all).unwrap_or(Duration::MAX);
        all.max(tried().max().copied().unwrap_or_default())
    }

    /// How many shards make sense for so many workers that do `jobs` runs at a time each. Runs that were not tried are taken to
    /// last a minute, or as long as the mean of the others if that is longer.
    pub fn shards(&self, workers: usize, jobs: usize) -> Sensible {
        let tried = self.runs.iter().flatten().count();
        let all: f64 = self.runs.iter().flatten().map(Duration::as_secs_f64).sum();
        let mean = Duration::try_from_secs_f64(all / tried as f64).unwrap_or(UNKNOWN);
        let mean = mean.max(UNKNOWN);
        let runs: Vec<Duration> = self.runs.iter().map(|run| run.unwrap_or(mean)).collect();
        sensible(&runs, workers, jobs)
    }
}

/// What runs have in common that take about as long: optimiser, kind of problem, number of variables
/// and budget.
type Alike<'a> = (usize, &'a str, usize, u64);

fn kind<'a>(plan: &'a Plan, run: &RunSpec) -> Alike<'a> {
    let instance = &plan.instances[run.instance];
    let problem = instance.subject.problem(&plan.optimisers[run.optimiser].space(instance));
    let variables = problem.map_or(0, |problem| problem.bounds().len());
    (run.optimiser, instance.subject.name(), variables, run.budget)
}

/// A few runs of every kind, with the first seed, spread evenly over the kind's instances.
fn choose(plan: &Plan) -> Vec<&RunSpec> {
    let mut kinds: BTreeMap<Alike<'_>, Vec<&RunSpec>> = BTreeMap::new();
    // Programs are started by runs alone, whether they search or are searched.
    let is_tried = |run: &&RunSpec| {
        run.seed == 1
            && plan.optimisers[run.optimiser].program().is_none()
            && ExternalProblem::of(&plan.instances[run.instance]).is_none()
    };
    for run in plan.runs.iter().filter(is_tried) {
        kinds.entry(kind(plan, run)).or_default().push(run);
    }
    kinds.values().flat_map(|runs| spread(runs)).collect()
}

/// A few of a list, from its first to its last.
fn spread<'a>(runs: &[&'a RunSpec]) -> Vec<&'a RunSpec> {
    let tried = runs.len().min(TRIED);
    (0..tried).map(|i| runs[i * (runs.len() - 1) / (tried - 1).max(1)]).collect()
}

fn weight(plan: &Plan, run: &RunSpec) -> u32 {
    let needs_derivatives = plan.optimisers[run.optimiser].needs_derivatives;
    if needs_derivatives { WITH_DERIVATIVES } else { 1 }
}

/// Seconds that a run takes, as far as so much time tells.
fn attempt(plan: &Plan, run: &RunSpec, time: Duration) -> Result<f64, RunError> {
    let watch = Watch::default();
    let (over, end) = channel::<()>();
    thread::scope(|scope| {
        let watch = &watch;
        let stop = move || {
            if end.recv_timeout(time) == Err(RecvTimeoutError::Timeout) {
                watch.interrupt();
            }
        };
        let timer = thread::Builder::new().spawn_scoped(scope, stop);
        timer.map_err(|error| RunError::Threads(error.to_string()))?;
        let seconds = projected(plan, run, watch);
        drop(over);
        Ok(seconds)
    })
}

/// Seconds that a run takes, judged when it ends or is interrupted. A run of many starts is made one
/// start at a time, to see how long each takes.
fn projected(plan: &Plan, run: &RunSpec, watch: &Watch) -> f64 {
    let (instance, entrant) = (&plan.instances[run.instance], &plan.optimisers[run.optimiser]);
    let problem = instance.subject.problem(&entrant.space(instance));
    // What cannot be run takes no time.
    let (Ok(whole), Ok(problem)) = (entrant.optimiser(), problem) else { return 0.0 };
    let _ = caught(|| problem.prepare(watch));
    let split = whole.parts();
    let (part, parts): (&dyn Optimiser, usize) =
        split.as_ref().map_or((whole, 1), |(part, parts)| (&**part, *parts));
    let started = Instant::now();
    let (mut done, mut evaluations, mut seconds) = (0, 0, 0.0);
    for seed in (1..).take(parts) {
        let mut oracle = Oracle::new(&*problem, run.budget - evaluations, watch);
        // A run that panics takes as long as until then.
        let _ = caught(|| part.minimise(&mut oracle, &mut Rng::new(seed)));
        evaluations += oracle.evaluations();
        if watch.is_interrupted() {
            let spent = run.budget as f64 / evaluations.max(1) as f64;
            let by_budget = started.elapsed().as_secs_f64() * spent;
            let by_parts = seconds * parts as f64 / f64::from(done);
            return if done > 0 { by_parts.min(by_budget) } else { by_budget };
        }
        done += 1;
        seconds = started.elapsed().as_secs_f64();
        if evaluations >= run.budget {
            break;
        }
    }
    seconds
}
