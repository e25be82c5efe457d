//! An experiment spelt out: every instance, every run, every key.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroU64;

use serde::Serialize;
use toml::Spanned;

use super::record::FORMAT;
use super::{ExperimentFile, Instance, Subject, Targets, sweep};
use crate::digest::digest;
use crate::input::{Document, InputError};
use crate::optimiser::Settings;
use crate::problem::{Accuracy, Boxes};
use crate::task::Task;

/// Raised when a change makes the same run give another result.
const RESULT_VERSION: u32 = 3;

/// An experiment spelt out.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The experiment's name.
    pub name: String,
    /// The instances.
    pub instances: Vec<Instance>,
    /// The field.
    pub optimisers: Vec<Entrant>,
    /// All runs, instance by instance, optimiser by optimiser, seed by seed.
    pub runs: Vec<RunSpec>,
}

/// One optimiser of the field.
#[derive(Debug, Clone)]
pub struct Entrant {
    /// Optimiser and, on the task, formulation; with changed settings where the field has these more
    /// than once.
    pub label: String,
    /// The settings.
    pub settings: Settings,
}

/// One optimiser on one instance with one seed.
#[derive(Debug, Clone)]
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

impl Plan {
    /// Spells an experiment out. Two runs that would be the same are a mistake.
    pub fn new(file: &ExperimentFile, document: &Document) -> Result<Self, InputError> {
        let mut instances = match file {
            ExperimentFile { functions: Some(functions), .. } => {
                check_field(file.optimiser.get_ref(), document)?;
                functions.instances(document)?
            }
            ExperimentFile { task: Some(task), trajectory: Some(trajectory), sweep, .. } => {
                sweep::instances(task, trajectory, sweep, document)?
            }
            // Reading a file fills in what it leaves out.
            _ => Vec::new(),
        };
        if let Some(targets) = &file.targets {
            Targets::give(targets, &mut instances, document)?;
        }
        let field: Vec<Settings> =
            file.optimiser.get_ref().iter().map(|settings| settings.get_ref().clone()).collect();
        let plan = Self::over(&file.name, instances, &field, file.seeds, file.budget.evaluations);
        let mut keys = HashSet::new();
        if let Some(twin) = plan.runs.iter().find(|run| !keys.insert(&run.key)) {
            let message = format!(
                "{} stands twice with the same settings, or a list of the sweep or of the functions repeats a value",
                plan.optimisers[twin.optimiser].label
            );
            return Err(document.error_at(file.optimiser.span(), message, None));
        }
        Ok(plan)
    }

    /// Every optimiser of the field on every instance, for seeds 1, 2, … up to `seeds`, with `budget`
    /// evaluations a run.
    pub fn over(
        name: &str,
        instances: Vec<Instance>,
        field: &[Settings],
        seeds: NonZeroU64,
        budget: NonZeroU64,
    ) -> Self {
        let budget = budget.get();
        let optimisers = entrants(field, instances.iter().any(Instance::is_task));
        let mut runs = Vec::new();
        for (i, instance) in instances.iter().enumerate() {
            for (o, entrant) in optimisers.iter().enumerate() {
                runs.extend((1..=seeds.get()).map(|seed| {
                    let recipe = recipe(instance, &entrant.settings, seed, budget);
                    RunSpec {
                        key: digest(&recipe),
                        recipe,
                        instance: i,
                        optimiser: o,
                        seed,
                        budget,
                    }
                }));
            }
        }
        Self { name: name.to_owned(), instances, optimisers, runs }
    }

    /// The letter for costs: the paper's `J` where its task is among the instances.
    pub fn cost_symbol(&self) -> &'static str {
        if self.instances.iter().any(Instance::is_task) { "J" } else { "f" }
    }
}

/// Whether every optimiser of a field can search test functions: those have no derivatives, and
/// none of the task's formulations.
fn check_field(field: &[Spanned<Settings>], document: &Document) -> Result<(), InputError> {
    for spanned in field {
        let settings = spanned.get_ref();
        let name = settings.name();
        let default = Settings::by_name(name).map(|default| default.formulation());
        let message = if settings.optimiser().needs_derivatives() {
            format!("`{name}` needs derivatives, which test functions do not give")
        } else if default != Some(settings.formulation()) {
            "found a formulation, which only the reorientation task has".to_owned()
        } else {
            continue;
        };
        return Err(document.error_at(spanned.span(), message, None));
    }
    Ok(())
}

/// Labels the field: optimiser and, on the task, formulation, with the settings that differ from the
/// default where the field has these more than once.
fn entrants(field: &[Settings], on_task: bool) -> Vec<Entrant> {
    let plain = |s: &Settings| {
        if on_task { format!("{}/{}", s.title(), s.formulation().name()) } else { s.title() }
    };
    let mut count = HashMap::new();
    for settings in field {
        *count.entry(plain(settings)).or_insert(0) += 1;
    }
    let label = |settings: &Settings| {
        let plain = plain(settings);
        let changed = if count[&plain] > 1 { settings.changed() } else { Vec::new() };
        std::iter::once(plain).chain(changed).collect::<Vec<_>>().join(" ")
    };
    field.iter().map(|s| Entrant { label: label(s), settings: s.clone() }).collect()
}

/// Everything that determines a run's result, as JSON.
#[expect(clippy::expect_used, reason = "plain data has a JSON form")]
fn recipe(instance: &Instance, settings: &Settings, seed: u64, budget: u64) -> String {
    #[derive(Serialize)]
    struct Recipe<'a> {
        version: u32,
        format: u64,
        #[serde(flatten)]
        subject: Identity<'a>,
        optimiser: &'a Settings,
        seed: u64,
        evaluations: u64,
    }
    #[derive(Serialize)]
    #[serde(untagged)]
    enum Identity<'a> {
        Task { task: &'a Task, terms: usize, accuracy: Accuracy, boxes: &'a Boxes },
        Other { problem: &'a str, instance: &'a str },
    }
    let subject = match &instance.subject {
        Subject::Task { problem, boxes } => Identity::Task {
            task: problem.task(),
            terms: problem.family().terms(),
            accuracy: problem.accuracy(),
            boxes,
        },
        Subject::Other { name, .. } => Identity::Other { problem: name, instance: &instance.label },
    };
    let recipe = Recipe {
        version: RESULT_VERSION,
        format: FORMAT,
        subject,
        optimiser: settings,
        seed,
        evaluations: budget,
    };
    serde_json::to_string(&recipe).expect("a recipe is plain data")
}
