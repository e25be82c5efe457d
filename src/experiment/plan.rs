//! An experiment spelt out: every instance, every run, every key.

use std::collections::{HashMap, HashSet};
use std::fmt::Write as _;
use std::str::FromStr;
use std::sync::Arc;

use serde::Serialize;
use sha2::{Digest, Sha256};

use super::ExperimentFile;
use crate::input::{Document, InputError, Positive};
use crate::optimiser::Settings;
use crate::problem::{Accuracy, Boxes, Formulated, Reorientation};
use crate::task::Task;

/// Raised when a change makes the same run give another result.
const PROBLEM_VERSION: u32 = 1;

/// An experiment spelt out.
#[derive(Debug, Clone)]
pub struct Plan {
    /// The experiment's name.
    pub name: String,
    /// Costs whose success rate is asked for.
    pub targets: Vec<f64>,
    /// The instances.
    pub instances: Vec<Instance>,
    /// The field.
    pub optimisers: Vec<Entrant>,
    /// All runs, instance by instance, optimiser by optimiser, seed by seed.
    pub runs: Vec<RunSpec>,
}

/// One point of the sweep.
#[derive(Debug, Clone)]
pub struct Instance {
    /// What the sweep set, such as `weight_base=0.5 terms=4`; empty without a sweep.
    pub label: String,
    /// The problem.
    pub problem: Arc<Reorientation>,
    /// Where to search.
    pub boxes: Boxes,
}

/// One optimiser of the field.
#[derive(Debug, Clone)]
pub struct Entrant {
    /// Optimiser and formulation, with changed settings where the field has both more than once.
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

/// A disjoint part of an experiment, `index` of `count`, counted from zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl FromStr for Shard {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (index, count) = text.split_once('/').ok_or("expected I/N, such as 0/4")?;
        match (index.parse(), count.parse()) {
            (Ok(index), Ok(count)) if index < count => Ok(Self { index, count }),
            (Ok(_), Ok(_)) => Err("expected I/N with I from 0 to N - 1"),
            _ => Err("expected I/N with two whole numbers, such as 0/4"),
        }
    }
}

impl Shard {
    /// Whether the run at this place of a plan belongs to the shard.
    pub fn holds(self, place: usize) -> bool {
        place % self.count == self.index
    }
}

impl Plan {
    /// Spells an experiment out. Two runs that would be the same are a mistake.
    pub fn new(file: &ExperimentFile, document: &Document) -> Result<Self, InputError> {
        let task = file.task.build(document)?;
        let instances = instances(file, &task, document)?;
        let optimisers = entrants(file.optimiser.get_ref());
        let budget = file.budget.evaluations.get();
        let mut runs = Vec::new();
        for (i, instance) in instances.iter().enumerate() {
            for (o, entrant) in optimisers.iter().enumerate() {
                runs.extend((1..=file.seeds.get()).map(|seed| {
                    let recipe = recipe(instance, &entrant.settings, seed, budget);
                    RunSpec { key: hash(&recipe), recipe, instance: i, optimiser: o, seed, budget }
                }));
            }
        }
        let mut keys = HashSet::new();
        if let Some(twin) = runs.iter().find(|run| !keys.insert(&run.key)) {
            let message = format!(
                "{} stands twice with the same settings, or a list of the sweep repeats a value",
                optimisers[twin.optimiser].label
            );
            return Err(document.error_at(file.optimiser.span(), message, None));
        }
        let targets = file.targets.iter().map(|target| target.0).collect();
        Ok(Self { name: file.name.clone(), targets, instances, optimisers, runs })
    }

    /// The problem as a run's optimiser sees it.
    pub fn problem(&self, run: &RunSpec) -> Formulated {
        let instance = &self.instances[run.instance];
        let formulation = self.optimisers[run.optimiser].settings.formulation();
        Formulated::new(formulation, instance.problem.clone(), &instance.boxes)
    }
}

/// Labels the field: optimiser and formulation, with the settings that differ from the default where
/// the field has both more than once.
fn entrants(field: &[Settings]) -> Vec<Entrant> {
    let plain = |s: &Settings| format!("{}/{}", s.name(), s.formulation().name());
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

/// The cross product of the sweep's lists.
fn instances(
    file: &ExperimentFile,
    task: &Task,
    document: &Document,
) -> Result<Vec<Instance>, InputError> {
    /// A task on its way through the lists, with what they have set so far.
    #[derive(Clone)]
    struct Draft {
        label: String,
        task: Task,
        terms: toml::Spanned<usize>,
    }
    /// Every draft with every value of one list; a list without values leaves the drafts alone.
    fn cross<T>(
        drafts: Vec<Draft>,
        name: &str,
        values: &[T],
        set: impl Fn(&mut Draft, &T) -> String,
    ) -> Vec<Draft> {
        if values.is_empty() {
            return drafts;
        }
        let with = |draft: &Draft, value: &T| {
            let mut draft = draft.clone();
            let shown = set(&mut draft, value);
            let space = if draft.label.is_empty() { "" } else { " " };
            let _ = write!(draft.label, "{space}{name}={shown}");
            draft
        };
        drafts.iter().flat_map(|draft| values.iter().map(|value| with(draft, value))).collect()
    }
    let limit = |order: usize| {
        move |draft: &mut Draft, limit: &Positive| {
            draft.task.limits.0.iter_mut().for_each(|l| l[order] = limit.0.to_radians());
            limit.0.to_string()
        }
    };
    let sweep = &file.sweep;
    let terms = file.trajectory.terms().clone();
    let mut drafts = vec![Draft { label: String::new(), task: task.clone(), terms }];
    drafts = cross(drafts, "weight_base", &sweep.weight_base, |draft, weight| {
        draft.task.base_weight = weight.0;
        weight.0.to_string()
    });
    drafts = cross(drafts, "rate_limit_deg_s", &sweep.rate_limit_deg_s, limit(0));
    drafts = cross(drafts, "acceleration_limit_deg_s2", &sweep.acceleration_limit_deg_s2, limit(1));
    drafts = cross(drafts, "jerk_limit_deg_s3", &sweep.jerk_limit_deg_s3, limit(2));
    drafts = cross(drafts, "terms", &sweep.terms, |draft, terms| {
        draft.terms = terms.clone();
        terms.get_ref().to_string()
    });
    let build = |draft: Draft| {
        let table = file.trajectory.with_terms(draft.terms);
        let (problem, boxes) = table.build(Arc::new(draft.task), document)?;
        Ok(Instance { label: draft.label, problem: Arc::new(problem), boxes })
    };
    drafts.into_iter().map(build).collect()
}

/// Everything that determines a run's result, as JSON.
#[expect(clippy::expect_used, reason = "plain data has a JSON form")]
fn recipe(instance: &Instance, settings: &Settings, seed: u64, budget: u64) -> String {
    #[derive(Serialize)]
    struct Recipe<'a> {
        version: u32,
        task: &'a Task,
        terms: usize,
        accuracy: Accuracy,
        boxes: &'a Boxes,
        optimiser: &'a Settings,
        seed: u64,
        evaluations: u64,
    }
    let recipe = Recipe {
        version: PROBLEM_VERSION,
        task: instance.problem.task(),
        terms: instance.problem.family().terms(),
        accuracy: instance.problem.accuracy(),
        boxes: &instance.boxes,
        optimiser: settings,
        seed,
        evaluations: budget,
    };
    serde_json::to_string(&recipe).expect("a recipe is plain data")
}

/// The first 16 hexadecimal digits of a text's SHA-256.
fn hash(text: &str) -> String {
    Sha256::digest(text).iter().take(8).fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}
