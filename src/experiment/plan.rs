//! An experiment spelt out: every instance, every run, every key.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroU64;

use serde::Serialize;
use toml::Spanned;

use super::field::entrants;
use super::record::FORMAT;
use super::{EntrantTable, ExperimentFile, Instance, Subject, TargetTable, sweep};
use crate::digest::digest;
use crate::input::{Document, InputError};
use crate::optimiser::Settings;
use crate::reorientation::{Accuracy, Boxes};
use crate::task::Task;

/// Raised when a change makes the same run give another result.
const RESULT_VERSION: u32 = 4;

/// Most runs of an experiment; each takes some kilobytes until all are done.
const MOST_RUNS: u64 = 1_000_000;

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
    /// The label given, or optimiser and, on the task, formulation; with changed settings where the
    /// field has these more than once.
    pub label: String,
    /// The settings.
    pub settings: Settings,
    /// Number of seeds, instead of the experiment's.
    pub seeds: Option<NonZeroU64>,
    /// Evaluations that each of its runs may spend, instead of the experiment's or the instance's
    /// budget.
    pub budget: Option<NonZeroU64>,
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
            TargetTable::give(targets, &mut instances, document)?;
        }
        check_budgets(file, document)?;
        let field = file.optimiser.get_ref();
        let seeds = field.iter().map(|table| table.seeds.unwrap_or(file.seeds).get()).sum::<u64>();
        let count = seeds.saturating_mul(instances.len() as u64);
        if count > MOST_RUNS {
            let message = format!("found {count} runs, expected {MOST_RUNS} at most");
            let help = "make several experiments of it".to_owned();
            return Err(document.error_at(file.optimiser.span(), message, Some(help)));
        }
        let plan = Self::of(&file.name, instances, field, file.seeds, file.budget.evaluations);
        let mut keys = HashSet::new();
        if let Some(twin) = plan.runs.iter().find(|run| !keys.insert(&run.key)) {
            let message = format!(
                "{} stands twice with the same settings, or a list of the sweep or of the functions repeats a value",
                plan.optimisers[twin.optimiser].label
            );
            return Err(document.error_at(file.optimiser.span(), message, None));
        }
        check_labels(&plan, field, document)?;
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
        let field: Vec<EntrantTable> = field.iter().cloned().map(EntrantTable::from).collect();
        Self::of(name, instances, &field, seeds, budget)
    }

    fn of(
        name: &str,
        instances: Vec<Instance>,
        field: &[EntrantTable],
        seeds: NonZeroU64,
        budget: NonZeroU64,
    ) -> Self {
        let optimisers = entrants(field, instances.iter().any(Instance::is_task));
        let mut runs = Vec::new();
        for (i, instance) in instances.iter().enumerate() {
            for (o, entrant) in optimisers.iter().enumerate() {
                let budget = entrant.budget.or(instance.budget).unwrap_or(budget).get();
                runs.extend((1..=entrant.seeds.unwrap_or(seeds).get()).map(|seed| {
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

    /// Whether some optimisers may spend more than others on the same instance.
    pub fn is_uneven(&self) -> bool {
        let mut pairs = self.runs.iter().zip(self.runs.iter().skip(1));
        pairs.any(|(a, b)| a.instance == b.instance && a.budget != b.budget)
    }

    /// For every instance the first one with the same problem: instances may differ in budget alone.
    pub fn problems(&self) -> Vec<usize> {
        let mut first = HashMap::new();
        let same = |(i, instance): (usize, &Instance)| {
            let identity = serde_json::to_string(&identity(instance)).unwrap_or_default();
            *first.entry(identity).or_insert(i)
        };
        self.instances.iter().enumerate().map(same).collect()
    }

    /// The places of all runs by their keys.
    pub fn places(&self) -> HashMap<&str, usize> {
        self.runs.iter().enumerate().map(|(i, run)| (run.key.as_str(), i)).collect()
    }

    /// The letter for costs: the paper's `J` where its task is among the instances.
    pub fn cost_symbol(&self) -> &'static str {
        if self.instances.iter().any(Instance::is_task) { "J" } else { "f" }
    }
}

/// Whether every optimiser of a field can search test functions: those have no derivatives, and
/// none of the task's formulations.
fn check_field(field: &[EntrantTable], document: &Document) -> Result<(), InputError> {
    for EntrantTable { settings: spanned, .. } in field {
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

/// Whether budgets are set in one way only: for each optimiser, or for each instance.
fn check_budgets(file: &ExperimentFile, document: &Document) -> Result<(), InputError> {
    let own = file.optimiser.get_ref().iter().find_map(|entrant| entrant.budget.as_ref());
    match own.filter(|_| !file.sweep.budget.is_empty()) {
        Some(budget) => {
            let message = "found a budget of an optimiser's own beside a sweep of budgets, expected one of them";
            Err(document.error_at(budget.span(), message, None))
        }
        None => Ok(()),
    }
}

/// Whether labels tell the optimisers apart.
fn check_labels(
    plan: &Plan,
    field: &[EntrantTable],
    document: &Document,
) -> Result<(), InputError> {
    let mut labels = HashSet::new();
    for (entrant, table) in plan.optimisers.iter().zip(field) {
        if entrant.label.is_empty() || !labels.insert(&entrant.label) {
            let message = format!(
                "found label `{}`, expected one that tells this optimiser from the others",
                entrant.label
            );
            let span = table.label.as_ref().map_or(table.settings.span(), Spanned::span);
            return Err(document.error_at(span, message, None));
        }
    }
    Ok(())
}

/// Which problem an instance is.
#[derive(Serialize)]
#[serde(untagged)]
enum Identity<'a> {
    Task { task: &'a Task, terms: usize, accuracy: Accuracy, boxes: &'a Boxes },
    Other { problem: &'a str, instance: &'a str },
}

fn identity(instance: &Instance) -> Identity<'_> {
    match &instance.subject {
        Subject::Task { problem, boxes } => Identity::Task {
            task: problem.task(),
            terms: problem.family().terms(),
            accuracy: problem.accuracy(),
            boxes,
        },
        Subject::Other { name, .. } => Identity::Other { problem: name, instance: &instance.label },
    }
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
    let subject = identity(instance);
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
