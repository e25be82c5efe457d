//! Plans one motion: the arm goes where it should be, and the base turns home without fuel.
//!
//! `cargo run --release --example plan_a_motion`

use std::error::Error;
use std::num::NonZeroUsize;
use std::sync::Arc;

use driftless::optimiser::{Optimiser as _, Scp};
use driftless::reorientation::{Formulated, Formulation, TaskFile};
use driftless::search::{Oracle, Rng, Watch};

fn main() -> Result<(), Box<dyn Error>> {
    // The task of Xiao et al. (2023); `Document::read` takes a file of yours instead.
    let document = TaskFile::paper();
    let (task, boxes) = TaskFile::read(&document)?.build(&document)?;
    let problem = Formulated::new(Formulation::TimeFree, Arc::new(task), &boxes)?;

    // The oracle counts what the optimiser asks for, and keeps the best.
    let watch = Watch::default();
    let mut oracle = Oracle::new(&problem, 20_000, &watch);
    let scp = Scp { starts: NonZeroUsize::new(10), ..Scp::default() };
    scp.minimise(&mut oracle, &mut Rng::new(1))?;

    let best = oracle.best().ok_or("no motion was found")?;
    let (_, motion) = problem.certify(&best.x);
    println!("J {:.6}", motion.cost);
    println!("duration {:.3} s", motion.duration);
    println!("base {:.6}° off its goal", motion.residual().to_degrees());
    Ok(())
}
