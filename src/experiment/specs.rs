//! The runs of an experiment, each with all that determines its result.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use serde::Serialize;

use super::entrant::Entrant;
use super::import_table::ImportedRun;
use super::schema::FORMAT;
use super::subject::Instance;
use crate::digest::digest;

/// Raised when a change makes the same run give another result.
const RESULT_VERSION: u32 = 5;

/// One optimiser on one instance with one seed.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct RunSpec {
    /// Hash of the recipe.
    pub key: String,
    /// Everything that determines the run's result, as JSON.
    pub recipe: String,
    /// Index of the instance.
    pub instance: usize,
    /// Index of the optimiser.
    pub optimiser: usize,
    /// The seed.
    pub seed: u64,
    /// Evaluations that the run may spend.
    pub budget: u64,
}

/// Every optimiser on every instance with every seed.
pub(super) fn crossed(
    instances: &[Instance],
    optimisers: &[Entrant],
    seeds: NonZeroU64,
    budget: NonZeroU64,
) -> Vec<RunSpec> {
    let mut runs = Vec::new();
    for (i, instance) in instances.iter().enumerate() {
        for (o, entrant) in optimisers.iter().enumerate() {
            let budget = entrant.budget.or(instance.budget).unwrap_or(budget).get();
            let cell = Cell::new((i, instance), (o, entrant), budget);
            let seeds = 1..=entrant.seeds.unwrap_or(seeds).get();
            runs.extend(seeds.map(|seed| cell.run(seed)));
        }
    }
    runs
}

/// The runs that were imported.
pub(super) fn imported(
    instances: &[Instance],
    optimisers: &[Entrant],
    runs: BTreeMap<ImportedRun, NonZeroU64>,
) -> Vec<RunSpec> {
    let mut cell: Option<Cell> = None;
    let spec = |((i, o, seed), budget): (ImportedRun, NonZeroU64)| {
        let budget = budget.get();
        let known = cell.take().filter(|cell| cell.is_of(i, o, budget));
        let known =
            known.unwrap_or_else(|| Cell::new((i, &instances[i]), (o, &optimisers[o]), budget));
        cell.insert(known).run(seed)
    };
    runs.into_iter().map(spec).collect()
}

/// All that the runs of an optimiser on an instance share.
struct Cell {
    instance: usize,
    optimiser: usize,
    subject: serde_json::Value,
    formulation: String,
    identity: serde_json::Value,
    budget: u64,
}

impl Cell {
    /// Of an instance and an optimiser, each with its place.
    fn new(
        (instance, on): (usize, &Instance),
        (optimiser, entrant): (usize, &Entrant),
        budget: u64,
    ) -> Self {
        let (subject, formulation) = (problem_identity(on), entrant.space(on));
        Self { instance, optimiser, subject, formulation, identity: entrant.identity(), budget }
    }

    fn is_of(&self, instance: usize, optimiser: usize, budget: u64) -> bool {
        (self.instance, self.optimiser, self.budget) == (instance, optimiser, budget)
    }

    /// One of the runs.
    fn run(&self, seed: u64) -> RunSpec {
        let recipe = Recipe {
            format: FORMAT,
            version: RESULT_VERSION,
            subject: &self.subject,
            formulation: &self.formulation,
            optimiser: &self.identity,
            seed,
            evaluations: self.budget,
        };
        let recipe = serde_json::to_string(&recipe).unwrap_or_default();
        let key = digest(&recipe);
        let (instance, optimiser, budget) = (self.instance, self.optimiser, self.budget);
        RunSpec { key, recipe, instance, optimiser, seed, budget }
    }
}

/// Everything that determines a run's result.
#[derive(Serialize)]
struct Recipe<'a> {
    format: u64,
    version: u32,
    subject: &'a serde_json::Value,
    formulation: &'a str,
    optimiser: &'a serde_json::Value,
    seed: u64,
    evaluations: u64,
}

/// Which problem an instance is.
pub(super) fn problem_identity(instance: &Instance) -> serde_json::Value {
    let subject = &instance.subject;
    serde_json::json!({
        "kind": subject.kind(),
        "name": subject.name(),
        "identity": subject.identity().json(),
    })
}
