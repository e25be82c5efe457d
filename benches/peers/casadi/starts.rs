//! `scp` from one random start after the other, a line of JSON for each.
//!
//! `cargo run --release --example peers_starts -- [STARTS] [FIRST_SEED]`: of every seed the first start
//! that `driftless plan --seed` would follow. The clock runs while one start is followed, and only
//! then; the values printed are those of the fine evaluation.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use driftless::optimiser::Scp;
use driftless::reorientation::{Formulated, Formulation, TaskFile};
use driftless::search::Problem;
use driftless::search::{Oracle, Rng, Watch};
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let starts = arguments.next().unwrap_or(Ok(100))?;
    let first = arguments.next().unwrap_or(Ok(1))?;
    let document = TaskFile::paper();
    let (task, boxes) = TaskFile::read(&document)?.build(&document)?;
    let problem =
        Formulated::new(Formulation::TimeFree, Arc::new(task), &boxes).expect("sound boxes");
    // Not printed: whatever a process pays only once is paid here.
    follow(&problem, first)?;
    for seed in first..first + starts {
        println!("{}", follow(&problem, seed)?);
    }
    Ok(())
}

/// Follows the first start of a seed to its end.
fn follow(problem: &Formulated, seed: u64) -> Result<Value, Box<dyn Error>> {
    let start = Scp::start(problem.bounds(), &mut Rng::new(seed));
    let watch = Watch::default();
    let mut oracle = Oracle::new(problem, u64::MAX, &watch);
    let clock = Instant::now();
    let ending = Scp::default().follow(&mut oracle, &start)?;
    let seconds = clock.elapsed().as_secs_f64();
    let best = oracle.best().ok_or("no cost was a number")?;
    let (coefficients, motion) = problem.certify(&best.x);
    Ok(json!({
        "seed": seed,
        "start": start,
        "coefficients": coefficients,
        "j": motion.cost,
        "t_f": motion.duration,
        "residual_deg": motion.residual().to_degrees(),
        "seconds": seconds,
        "ending": format!("{ending:?}").to_lowercase(),
        "evaluations": oracle.evaluations(),
        "linearisations": oracle.linearisations(),
        "conic_solves": oracle.conic_solves(),
    }))
}
