//! Runs the race that `race.json` describes and prints, as JSON, after how many evaluations each
//! run came below the target, or null.

use std::collections::BTreeMap;

use driftless::functions::{Analytic, TestFunction};
use driftless::optimiser::Settings;
use driftless::search::{Oracle, Rng, Watch};
use serde::Deserialize;

/// `race.json`.
#[derive(Deserialize)]
struct Race {
    functions: Vec<TestFunction>,
    dimension: usize,
    instance: u64,
    seeds: u64,
    budget: u64,
    target: f64,
    optimisers: BTreeMap<String, Settings>,
}

impl Race {
    /// When one run first met the target.
    fn run(&self, settings: &Settings, problem: &Analytic, seed: u64) -> Option<u64> {
        let watch = Watch::default();
        let mut oracle = Oracle::new(problem, self.budget, &watch);
        // It ends by itself or because the budget is spent; either will do.
        let _ = settings.optimiser().minimise(&mut oracle, &mut Rng::new(seed));
        let trace = oracle.into_trace();
        trace.iter().find(|point| point.best.cost <= self.target).map(|point| point.evaluation)
    }
}

fn main() -> Result<(), serde_json::Error> {
    let race: Race = serde_json::from_str(include_str!("race.json"))?;
    let mut hits = BTreeMap::new();
    for (label, settings) in &race.optimisers {
        for &function in &race.functions {
            let problem = Analytic::new(function, race.dimension, race.instance);
            let runs: Vec<_> =
                (1..=race.seeds).map(|seed| race.run(settings, &problem, seed)).collect();
            hits.entry(label).or_insert_with(BTreeMap::new).insert(function.name(), runs);
        }
    }
    println!("{}", serde_json::to_string(&hits)?);
    Ok(())
}
