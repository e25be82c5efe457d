//! `scp` from one random start after the other, a line of JSON for each.
//!
//! `cargo run --release --example peers_starts -- [STARTS] [FIRST_SEED] [PIECES]`: of every seed the first start
//! that `driftless plan --seed` would follow; with pieces, that of free-form motions of degree 3, which it first follows on
//! fewer pieces. Both clocks run while one start is followed, and only then; the values printed are those of the fine
//! evaluation.

use std::error::Error;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use driftless::optimiser::{Optimiser as _, Scp};
use driftless::reorientation::{Accuracy, Formulated, Formulation, Reorientation, TaskFile};
use driftless::search::{Oracle, Problem, Rng, Stop, Watch};
use driftless::trajectory::{Family, Spline};
use serde_json::{Value, json};

/// A start ends when a step promises less than this share of the cost, as in `driftless plan`.
const TOLERANCE: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let starts = arguments.next().unwrap_or(Ok(100))?;
    let first = arguments.next().unwrap_or(Ok(1))?;
    let document = TaskFile::paper();
    let (problem, boxes) = TaskFile::read(&document)?.build(&document)?;
    let seeds = first..first + starts;
    let Some(pieces) = arguments.next().transpose()? else {
        let problem = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes)?;
        let start = |rng: &mut Rng| Scp::start(problem.bounds(), rng);
        let search = |oracle: &mut Oracle<'_>, rng: &mut Rng| {
            Scp::default().follow(oracle, &start(rng)).map(drop)
        };
        return tell(&problem, seeds, start, search, |_, _, _| ());
    };
    let task = problem.task();
    let family = Spline::new(&task.start.joints, &task.goal.joints, pieces as usize, 3);
    let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
    let problem = Reorientation::over(task.clone(), family, accuracy);
    let problem = Formulated::free_form(Arc::new(problem))?;
    let more = |told: &mut Value, start: &[f64], found: &[f64]| {
        let fine = problem.task().with_accuracy(Accuracy::FINE);
        let end = task.goal.base.inverse() * task.start.base * fine.net_rotation(start);
        told["start_points"] = points(fine.family(), start).into();
        told["start_t_f"] = fine.assess(start, None).duration.into();
        told["start_end"] = json!([end.w, end.i, end.j, end.k]);
        told["points"] = points(fine.family(), found).into();
    };
    let one = Scp { starts: Some(NonZeroUsize::MIN), tolerance: TOLERANCE, ..Scp::default() };
    let search = |oracle: &mut Oracle<'_>, rng: &mut Rng| one.minimise(oracle, rng);
    tell(&problem, seeds, |rng| coarse_start(&problem, rng), search, more)
}

/// Where `scp` begins on the coarsest problem, as a path of this one.
fn coarse_start(problem: &dyn Problem, rng: &mut Rng) -> Vec<f64> {
    match problem.coarser() {
        Some(coarse) => coarse.prolong(&coarse_start(coarse, rng)),
        None => problem.timed().map(|timed| timed.start(rng, 0.0)).unwrap_or_default(),
    }
}

/// Follows the start of every seed to its end and says what comes of it, and more of start and end.
fn tell<F: Family>(
    problem: &Formulated<F>,
    seeds: Range<u64>,
    start: impl Fn(&mut Rng) -> Vec<f64>,
    search: impl Fn(&mut Oracle<'_>, &mut Rng) -> Result<(), Stop>,
    more: impl Fn(&mut Value, &[f64], &[f64]),
) -> Result<(), Box<dyn Error>> {
    // Not printed: whatever a process pays only once is paid here.
    follow(problem, &search, seeds.start)?;
    for seed in seeds {
        let start = start(&mut Rng::new(seed));
        let (found, mut told) = follow(problem, &search, seed)?;
        told["seed"] = seed.into();
        told["start"] = start.clone().into();
        more(&mut told, &start, &found);
        println!("{told}");
    }
    Ok(())
}

/// Searches from the start of a seed.
fn follow<F: Family>(
    problem: &Formulated<F>,
    search: impl Fn(&mut Oracle<'_>, &mut Rng) -> Result<(), Stop>,
    seed: u64,
) -> Result<(Vec<f64>, Value), Box<dyn Error>> {
    let watch = Watch::default();
    let mut oracle = Oracle::new(problem, u64::MAX, &watch);
    let (clock, busy) = (Instant::now(), processor_seconds());
    search(&mut oracle, &mut Rng::new(seed))?;
    let seconds = clock.elapsed().as_secs_f64();
    let busy = busy.zip(processor_seconds()).map(|(before, after)| after - before);
    let best = oracle.best().ok_or("no cost was finite")?.clone();
    let (coefficients, motion) = problem.certify(&best.x);
    let work = [oracle.evaluations(), oracle.linearisations(), oracle.conic_solves()];
    // Whether a search that begins where this one ended goes on.
    let settled = Scp { first_weight: f64::INFINITY, tolerance: TOLERANCE, ..Scp::default() };
    let ending = settled.follow(&mut oracle, &best.x)?;
    let told = json!({
        "coefficients": coefficients,
        "j": motion.cost,
        "t_f": motion.duration,
        "residual_deg": motion.residual().to_degrees(),
        "seconds": seconds,
        "processor_seconds": busy,
        "ending": format!("{ending:?}").to_lowercase(),
        "evaluations": work[0],
        "linearisations": work[1],
        "conic_solves": work[2],
    });
    Ok((coefficients, told))
}

/// What this thread has had of the processor, where the system says it as Linux does; right to some milliseconds.
fn processor_seconds() -> Option<f64> {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(told.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
}

/// The control points of every joint.
fn points(family: &Spline, coefficients: &[f64]) -> Vec<Vec<f64>> {
    let of = |joint| {
        let mut points = vec![0.0; family.knots().points()];
        let own = &coefficients[family.coefficients_of(joint)];
        family.write_points(joint, own, &mut points);
        points
    };
    (0..family.joints()).map(of).collect()
}
