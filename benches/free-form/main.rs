//! What `scp` makes of free-form motions from random starts: a table by number of pieces.
//!
//! `cargo bench --bench free_form -- [TASK.toml [DEGREE [STARTS [PIECES …]]]]`, one start after the other on one core. A
//! clock runs while a start is followed, and only then; durations are those of the fine evaluation.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use driftless::input::Document;
use driftless::optimiser::{Ending, Scp};
use driftless::reorientation::{Accuracy, Formulated, Reorientation, TaskFile};
use driftless::search::{Oracle, Problem as _, Rng, Watch};
use driftless::task::Task;
use driftless::trajectory::Spline;

/// A residual below it is none \[°\].
const REACHED_DEG: f64 = 1e-6;

/// Durations that differ by less than this share are one.
const SAME: f64 = 1e-4;

/// One start, followed to its end.
struct Run {
    duration: f64,
    reached: bool,
    optimal: bool,
    seconds: f64,
    evaluations: u64,
    solves: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds an argument of its own.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let document = match arguments.first() {
        Some(path) if path != "-" => Document::read(Path::new(path))?,
        _ => TaskFile::paper(),
    };
    let number = |i: usize, default: usize| arguments.get(i).map_or(Ok(default), |a| a.parse());
    let (degree, starts) = (number(1, 3)?, number(2, 20)?);
    let mut pieces: Vec<usize> =
        arguments.iter().skip(3).map(|a| a.parse()).collect::<Result<_, _>>()?;
    if pieces.is_empty() {
        pieces = vec![20, 40, 80, 160, 320];
    }
    let (problem, _) = TaskFile::read(&document)?.build(&document)?;
    println!(
        "{:>6} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>9} {:>9} {:>11}",
        "pieces",
        "least",
        "median",
        "most",
        "at least",
        "reached",
        "optimal",
        "seconds",
        "steps",
        "ms per step"
    );
    for pieces in pieces {
        let runs: Vec<Run> = (1..=starts as u64)
            .map(|seed| follow(problem.task(), pieces, degree, seed))
            .collect::<Result<_, _>>()?;
        tell(pieces, &runs);
    }
    Ok(())
}

fn follow(
    task: &Arc<Task>,
    pieces: usize,
    degree: usize,
    seed: u64,
) -> Result<Run, Box<dyn Error>> {
    let family = Spline::new(&task.start.joints, &task.goal.joints, pieces, degree);
    let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
    let problem =
        Formulated::free_form(Arc::new(Reorientation::over(task.clone(), family, accuracy)))?;
    let start = problem.timed().ok_or("not linear")?.start(&mut Rng::new(seed), 0.0);
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, u64::MAX, &watch);
    let clock = Instant::now();
    let ending = Scp::default().follow(&mut oracle, &start)?;
    let seconds = clock.elapsed().as_secs_f64();
    let best = oracle.best().ok_or("no cost was finite")?;
    let (_, motion) = problem.certify(&best.x);
    Ok(Run {
        duration: motion.duration,
        reached: motion.residual().to_degrees() < REACHED_DEG && motion.range_excess < 1e-9,
        optimal: ending == Ending::Optimal,
        seconds,
        evaluations: oracle.evaluations(),
        solves: oracle.conic_solves(),
    })
}

fn tell(pieces: usize, runs: &[Run]) {
    let median = |value: &dyn Fn(&Run) -> f64| {
        let mut all: Vec<f64> = runs.iter().map(value).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let count = |wanted: &dyn Fn(&Run) -> bool| runs.iter().filter(|run| wanted(run)).count();
    let reached = runs.iter().filter(|run| run.reached);
    let least = reached.map(|run| run.duration).fold(f64::INFINITY, f64::min);
    println!(
        "{pieces:>6} {least:>9.5} {:>9.5} {:>9.5} {:>8} {:>8} {:>8} {:>9.3} {:>9.0} {:>11.2}",
        median(&|run| run.duration),
        runs.iter().map(|run| run.duration).fold(0.0, f64::max),
        count(&|run| run.reached && run.duration <= least * (1.0 + SAME)),
        count(&|run| run.reached),
        count(&|run| run.optimal),
        median(&|run| run.seconds),
        median(&|run| run.evaluations as f64),
        median(&|run| 1e3 * run.seconds / run.solves as f64),
    );
}
