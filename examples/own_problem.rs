//! Races the crate's optimisers on a problem of one's own.
//!
//! `cargo run --release --example own_problem -- FOLDER`; killed, the same again goes on. `driftless report FOLDER`
//! reads the results without this program.

use std::error::Error;

use driftless::experiment::{Experiment, Folder, Identity, Instance, Options};
use driftless::optimiser::{CmaEs, De, NelderMead, Settings};
use driftless::report;
use driftless::search::{Bounds, Evaluation, Failure, Problem, Watch};

/// The lightest of three springs in a row that carry a load: their stiffnesses are the variables.
struct Springs(Bounds);

impl Problem for Springs {
    fn bounds(&self) -> &Bounds {
        &self.0
    }

    fn evaluate(&self, stiffness: &[f64]) -> Result<Evaluation, Failure> {
        let weight: f64 = stiffness.iter().map(|k| k.powi(2)).sum();
        let sag: f64 = stiffness.iter().map(|k| 1.0 / k).sum();
        // It may sag by 3 at most; beyond, every bit is dear.
        let excess = (sag - 3.0).max(0.0);
        Ok(Evaluation::new(weight + 100.0 * excess, excess))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected a folder for the results")?;
    let springs = Springs(Bounds::new(vec![[0.1, 10.0]; 3])?);
    // What determines its costs; a version says when the code has changed.
    let identity = Identity::new().with("springs", 3).with("version", 1);
    let plan = Experiment::new("springs")?
        .with_instance(
            Instance::of_problem("springs", identity, springs).with_targets([3.3, 3.003]),
        )
        .with_optimiser(Settings::CmaEs(CmaEs::default()))
        .with_optimiser(Settings::De(De::default()))
        .with_optimiser(Settings::NelderMead(NelderMead::default()))
        .plan()?;
    let folder = Folder::create(path.as_ref(), plan)?;
    folder.run(Options::default(), &Watch::default(), &())?;
    println!(
        "{}",
        report::write(&folder.plan, &folder.store, &report::Target::of(folder.path()))?.summary
    );
    Ok(())
}
