//! Enters a swarm written in Rust into an experiment that is a file, beside the optimisers of the file; `docs/solvers/swarm.py` is
//! the same swarm as a process.
//!
//! `cargo run --release --example swarm -- docs/solvers/swarms.toml FOLDER`; killed, the same again goes on.

use std::error::Error;
use std::path::Path;

use driftless::experiment::{Entrant, Experiment, Folder, Identity, Options};
use driftless::input::Document;
use driftless::optimiser::Optimiser;
use driftless::search::{Evaluation, Oracle, Points, Rng, Stop, Watch};
use driftless::{registry, report};

/// Particles.
const SIZE: usize = 64;

const INERTIA: f64 = 0.729_844;
const PULL: f64 = 1.496_18;

/// A particle swarm with a ring of neighbours (DOI 10.1109/4235.985692 for its constants).
struct Swarm;

impl Optimiser for Swarm {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let bounds: Vec<[f64; 2]> = oracle.bounds().iter().collect();
        let mut x = Points::zeros(bounds.len(), SIZE);
        let mut velocity = x.clone();
        for i in 0..SIZE {
            for (k, &[low, high]) in bounds.iter().enumerate() {
                x[i][k] = rng.uniform(low, high);
                velocity[i][k] = rng.uniform(low, high) - x[i][k];
            }
        }
        let mut best = x.clone();
        let mut least = vec![f64::INFINITY; SIZE];
        let mut found = vec![Evaluation::default(); SIZE];
        loop {
            oracle.evaluate_batch(&x, &mut found)?;
            for i in 0..SIZE {
                if found[i].cost < least[i] {
                    least[i] = found[i].cost;
                    best[i].copy_from_slice(&x[i]);
                }
            }
            for i in 0..SIZE {
                let ring = [(i + SIZE - 1) % SIZE, i, (i + 1) % SIZE];
                let leader = ring.into_iter().min_by(|&a, &b| least[a].total_cmp(&least[b]));
                let leader = leader.unwrap_or(i);
                for (k, &[low, high]) in bounds.iter().enumerate() {
                    let to_best = rng.unit() * (best[i][k] - x[i][k]);
                    let to_leader = rng.unit() * (best[leader][k] - x[i][k]);
                    velocity[i][k] = INERTIA * velocity[i][k] + PULL * (to_best + to_leader);
                    x[i][k] += velocity[i][k];
                    if x[i][k] < low || x[i][k] > high {
                        velocity[i][k] *= -0.5;
                        x[i][k] = x[i][k].clamp(low, high);
                    }
                }
            }
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, path] = &arguments[..] else { return Err("expected EXPERIMENT.toml FOLDER".into()) };
    let experiment = Experiment::read(&Document::read(Path::new(file))?, &registry())?;
    let swarm = Entrant::new("swarm in Rust", Identity::new().with("version", 1), Swarm);
    let folder = Folder::create(path.as_ref(), experiment.with_optimiser(swarm).plan()?)?;
    folder.run(Options::default(), &Watch::default(), &())?;
    let target = report::Target::of(folder.path());
    println!("{}", report::write(&folder.plan, &folder.store, &target)?.summary);
    Ok(())
}
