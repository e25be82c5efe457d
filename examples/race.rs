//! Races the optimisers that come with the crate, stores their runs and makes the report.
//!
//! `cargo run --release --example race -- FOLDER`; the same again does what is missing.

use std::error::Error;

use driftless::experiment::{Experiment, Folder, Options};
use driftless::input::Document;
use driftless::search::Watch;
use driftless::{registry, report};

const EXPERIMENT: &str = "
    name = 'race'
    seeds = 5
    budget = { evaluations = 5000 }

    [functions]
    name = ['sphere', 'rosenbrock']
    dimension = [5]

    [[optimiser]]
    cma-es = {}

    [[optimiser]]
    de = {}
";

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected a folder for the results")?;
    let document = Document::embedded("race.toml", EXPERIMENT);
    let plan = Experiment::read(&document, &registry())?.plan()?;
    let folder = Folder::create(path.as_ref(), plan)?;
    folder.run(Options::default(), &Watch::default(), &())?;
    let report = report::write(&folder.plan, &folder.store, &report::Target::of(folder.path()))?;
    println!("{}\n{}", report.summary, report.page.display());
    Ok(())
}
