//! `scp` from one random start after the other, a line of JSON for each.
//!
//! `cargo run --release --example peers_starts -- [STARTS] [FIRST_SEED] [PIECES]`: of every seed the first start
//! that `driftless plan --seed` would follow; with pieces, that of free-form motions of degree 3. Both clocks run while
//! one start is followed, and only then; the values printed are those of the fine evaluation.

use std::error::Error;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use driftless::optimiser::Scp;
use driftless::reorientation::{Accuracy, Formulated, Formulation, Reorientation, TaskFile};
use driftless::search::{Oracle, Problem, Rng, Watch};
use driftless::trajectory::{Family, Spline};
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let starts = arguments.next().unwrap_or(Ok(100))?;
    let first = arguments.next().unwrap_or(Ok(1))?;
    let document = TaskFile::paper();
    let (problem, boxes) = TaskFile::read(&document)?.build(&document)?;
    let seeds = first..first + starts;
    let Some(pieces) = arguments.next().transpose()? else {
        let problem = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes)?;
        return tell(&problem, seeds, |rng| Scp::start(problem.bounds(), rng), |_, _, _| ());
    };
    let task = problem.task();
    let family = Spline::new(&task.start.joints, &task.goal.joints, pieces as usize, 3);
    let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 1 };
    let problem = Reorientation::over(task.clone(), family, accuracy);
    let problem = Formulated::free_form(Arc::new(problem))?;
    let timed = problem.timed().ok_or("not linear")?;
    let more = |told: &mut Value, start: &[f64], found: &[f64]| {
        let fine = problem.task().with_accuracy(Accuracy::FINE);
        let end = task.goal.base.inverse() * task.start.base * fine.net_rotation(start);
        told["start_points"] = points(fine.family(), start).into();
        told["start_t_f"] = fine.assess(start, None).duration.into();
        told["start_end"] = json!([end.w, end.i, end.j, end.k]);
        told["points"] = points(fine.family(), found).into();
    };
    tell(&problem, seeds, |rng| timed.start(rng, 0.0), more)
}

/// Follows the start of every seed to its end and says what comes of it, and more of start and end.
fn tell<F: Family>(
    problem: &Formulated<F>,
    seeds: Range<u64>,
    start: impl Fn(&mut Rng) -> Vec<f64>,
    more: impl Fn(&mut Value, &[f64], &[f64]),
) -> Result<(), Box<dyn Error>> {
    // Not printed: whatever a process pays only once is paid here.
    follow(problem, &start(&mut Rng::new(seeds.start)))?;
    for seed in seeds {
        let start = start(&mut Rng::new(seed));
        let (found, mut told) = follow(problem, &start)?;
        told["seed"] = seed.into();
        more(&mut told, &start, &found);
        println!("{told}");
    }
    Ok(())
}

/// Follows a start to its end.
fn follow<F: Family>(
    problem: &Formulated<F>,
    start: &[f64],
) -> Result<(Vec<f64>, Value), Box<dyn Error>> {
    let watch = Watch::default();
    let mut oracle = Oracle::new(problem, u64::MAX, &watch);
    let (clock, busy) = (Instant::now(), processor_seconds());
    let ending = Scp::default().follow(&mut oracle, start)?;
    let seconds = clock.elapsed().as_secs_f64();
    let busy = busy.zip(processor_seconds()).map(|(before, after)| after - before);
    let best = oracle.best().ok_or("no cost was a number")?;
    let (coefficients, motion) = problem.certify(&best.x);
    let told = json!({
        "start": start,
        "coefficients": coefficients,
        "j": motion.cost,
        "t_f": motion.duration,
        "residual_deg": motion.residual().to_degrees(),
        "seconds": seconds,
        "processor_seconds": busy,
        "ending": format!("{ending:?}").to_lowercase(),
        "evaluations": oracle.evaluations(),
        "linearisations": oracle.linearisations(),
        "conic_solves": oracle.conic_solves(),
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
