//! Enters an optimiser of one's own into an experiment, beside those of the crate.
//!
//! `cargo run --release --example own_optimiser -- FOLDER`; killed, the same again goes on. `driftless report FOLDER`
//! reads the results without this program.

use std::error::Error;

use driftless::experiment::{Entrant, Experiment, Folder, Identity, Options};
use driftless::optimiser::Optimiser;
use driftless::search::{Oracle, Rng, Stop, Watch};
use driftless::{registry, report};

/// Steps at random, by a share of the box's width at most, and stays where it is unless the step gains.
struct HillClimb(f64);

impl Optimiser for HillClimb {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let bounds = oracle.bounds();
        let mut x: Vec<f64> = bounds.iter().map(|[low, high]| rng.uniform(low, high)).collect();
        let mut lowest = oracle.evaluate(&x)?.cost;
        loop {
            let step = |(x, [low, high]): (&f64, [f64; 2])| {
                let reach = self.0 * (high - low);
                (x + rng.uniform(-reach, reach)).clamp(low, high)
            };
            let next: Vec<f64> = x.iter().zip(bounds.iter()).map(step).collect();
            let cost = oracle.evaluate(&next)?.cost;
            if cost < lowest {
                (x, lowest) = (next, cost);
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected a folder for the results")?;
    // What determines its runs; a version says when the code has changed.
    let settings = Identity::new().with("step", 0.05).with("version", 1);
    let mine = Entrant::new("hill-climb", settings, HillClimb(0.05));
    let plan =
        Experiment::read(&Experiment::embedded(), &registry())?.with_optimiser(mine).plan()?;
    let folder = Folder::create(path.as_ref(), plan)?;
    folder.run(Options::default(), &Watch::default(), &())?;
    println!(
        "{}",
        report::write(&folder.plan, &folder.store, &report::Target::of(folder.path()))?.summary
    );
    Ok(())
}
