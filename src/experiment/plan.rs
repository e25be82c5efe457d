//! An experiment spelt out: every instance, every run, every key.

use std::collections::{HashMap, HashSet};
use std::num::NonZeroU64;

use super::entrant::Entrant;
use super::field::{Entry, labelled};
use super::file::Experiment;
use super::import_table::ImportTable;
use super::run::Run;
use super::schema::runs;
use super::specs::{RunSpec, crossed, imported, problem_identity};
use super::subject::{Instance, Results};
use super::targets::TargetTable;
use super::value::Quantity;
use crate::input::{Document, InputError};
use crate::search::Failure;

/// Most runs of an experiment; each takes some kilobytes until all are done.
const MOST_RUNS: u64 = 1_000_000;

/// An experiment spelt out.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Plan {
    /// The experiment's name.
    pub name: String,
    /// The instances.
    pub instances: Vec<Instance>,
    /// The field.
    pub optimisers: Vec<Entrant>,
    /// All runs, instance by instance, optimiser by optimiser, seed by seed.
    pub runs: Vec<RunSpec>,
    /// The experiment that is spelt out.
    pub experiment: Experiment,
    facts: Vec<Quantity>,
    measures: Vec<Quantity>,
}

impl Experiment {
    /// Spells the experiment out. Two runs that would be the same are a mistake.
    pub fn plan(&self) -> Result<Plan, InputError> {
        let document = &self.document;
        self.check_count(self.source.as_ref().map_or(0, |source| source.count()))?;
        let mut instances = match &self.source {
            Some(source) => source.instances(document)?,
            None => Vec::new(),
        };
        instances.extend(self.instances.iter().cloned());
        if instances.is_empty() {
            let message = "found nothing to minimise, expected at least one instance";
            return Err(document.error_at(0..0, message, None));
        }
        self.field.iter().try_for_each(|entry| check_entry(entry, &instances, document))?;
        if let Some(targets) = &self.targets {
            TargetTable::give(targets, &mut instances, document)?;
        }
        self.check_budgets()?;
        self.check_count(instances.len() as u64)?;
        let optimisers = labelled(&self.field, &instances);
        let runs = match &self.imported {
            Some(table) => {
                let cells = table.runs([instances.len(), optimisers.len()], document)?;
                imported(&instances, &optimisers, cells)
            }
            None => crossed(&instances, &optimisers, self.seeds, self.budget),
        };
        let mut keys = HashSet::new();
        if let Some(twin) = runs.iter().find(|run| !keys.insert(&run.key)) {
            let message = format!(
                "{} stands twice with the same settings, or a list of the sweep or of the functions repeats a value",
                optimisers[twin.optimiser].label
            );
            return Err(document.error_at(self.field_place.clone(), message, None));
        }
        check_instances(&instances, document)?;
        self.check_labels(&optimisers)?;
        let plan = self.spelt_out(instances, optimisers, runs);
        check_quantities(&plan, document)?;
        Ok(plan)
    }

    /// Whether so many instances make few enough runs.
    fn check_count(&self, instances: u64) -> Result<(), InputError> {
        let seeds = |entry: &Entry| entry.entrant.seeds.unwrap_or(self.seeds).get();
        let seeds = self.field.iter().map(seeds).fold(0, u64::saturating_add);
        let crossed = || seeds.saturating_mul(instances);
        let count = self.imported.as_ref().map_or_else(crossed, ImportTable::count);
        if count <= MOST_RUNS {
            return Ok(());
        }
        let message = format!("found {count} runs, expected {MOST_RUNS} at most");
        let help = "make several experiments of it".to_owned();
        Err(self.document.error_at(self.field_place.clone(), message, Some(help)))
    }

    pub(super) fn spelt_out(
        &self,
        instances: Vec<Instance>,
        optimisers: Vec<Entrant>,
        runs: Vec<RunSpec>,
    ) -> Plan {
        let subjects = || instances.iter().map(|instance| &instance.subject);
        let facts = unlike(subjects().flat_map(|s| s.facts()).map(|(quantity, _)| quantity));
        let measures = unlike(subjects().flat_map(|s| s.measures()));
        let experiment = self.clone().with_targets(&instances);
        let name = self.name.clone();
        Plan { name, instances, optimisers, runs, experiment, facts, measures }
    }

    /// Whether budgets are set in one way only: for each optimiser, or for each instance.
    fn check_budgets(&self) -> Result<(), InputError> {
        let own = self.field.iter().find_map(|entry| entry.budget_place.clone());
        let sets_budgets = self.source.as_ref().is_some_and(|source| source.sets_budgets());
        match own.filter(|_| sets_budgets) {
            Some(place) => {
                let message = "found an optimiser with a budget of its own beside a sweep of budgets, expected one of them";
                Err(self.document.error_at(place, message, None))
            }
            None => Ok(()),
        }
    }

    /// Whether labels tell the optimisers apart.
    fn check_labels(&self, optimisers: &[Entrant]) -> Result<(), InputError> {
        let mut labels = HashSet::new();
        for (entrant, entry) in optimisers.iter().zip(&self.field) {
            if entrant.label.is_empty() || !labels.insert(&entrant.label) {
                let message = format!(
                    "found label `{}`, expected one that tells this optimiser from the others",
                    entrant.label
                );
                let place = entry.label_place.clone().unwrap_or_else(|| entry.place.clone());
                return Err(self.document.error_at(place, message, None));
            }
        }
        Ok(())
    }
}

/// Whether labels tell the instances apart.
fn check_instances(instances: &[Instance], document: &Document) -> Result<(), InputError> {
    let mut labels = HashSet::new();
    match instances.iter().find(|instance| !labels.insert(&instance.label)) {
        Some(twin) => {
            let message = format!(
                "found two instances labelled `{}`, expected labels that tell them apart",
                twin.label
            );
            Err(document.error_at(0..0, message, None))
        }
        None => Ok(()),
    }
}

/// Whether every fact and measure has a column of its own, and one kind of values.
fn check_quantities(plan: &Plan, document: &Document) -> Result<(), InputError> {
    let columns = runs::COLUMNS.iter().map(|column| column.name);
    let mut taken: HashSet<&str> = columns.collect();
    let mut quantities = plan.facts.iter().chain(&plan.measures);
    match quantities.find(|quantity| !taken.insert(&quantity.name)) {
        Some(Quantity { name, .. }) => {
            let message = format!(
                "found the quantity `{name}`, expected a name that neither a column of `runs` nor another fact or \
                 measure has"
            );
            Err(document.error_at(0..0, message, None))
        }
        None => Ok(()),
    }
}

/// Whether an optimiser can search every instance: whether it has the formulation asked for and, where need be,
/// derivatives.
fn check_entry(entry: &Entry, all: &[Instance], document: &Document) -> Result<(), InputError> {
    let Entry { entrant, place, .. } = entry;
    let error = |message: String| Err(document.error_at(place.clone(), message, None));
    for instance in all {
        let (name, spaces) = (instance.subject.name(), instance.subject.spaces());
        if let Some(asked) = entrant.formulation.as_ref().filter(|asked| !spaces.contains(asked)) {
            return error(if spaces.is_empty() {
                format!("found the formulation `{asked}`, which `{name}` does not have")
            } else if let Err(reason) = instance.subject.problem(asked) {
                format!("found the formulation `{asked}`: {reason}")
            } else {
                let spaces = spaces.join(", ");
                format!("found the formulation `{asked}`, expected one of `{name}`: {spaces}")
            });
        }
        let space = entrant.space(instance);
        let problem = instance.subject.problem(&space).ok();
        if let Some(lacks) = problem.and_then(|problem| entrant.lacks(&*problem)) {
            let of = if space.is_empty() { String::new() } else { format!(" in `{space}`") };
            return error(format!(
                "`{}` needs {lacks}, which `{name}`{of} does not give",
                entrant.kind
            ));
        }
    }
    Ok(())
}

impl Plan {
    /// Every optimiser of the field on every instance, for seeds 1, 2, … up to `seeds`, with `budget` evaluations
    /// per run. Unlike [`Experiment::plan`] it checks nothing: a run of an optimiser that needs derivatives where there
    /// are none, for instance, ends with a record that says so.
    pub fn over(
        name: &str,
        instances: Vec<Instance>,
        field: impl IntoIterator<Item = impl Into<Entrant>>,
        seeds: NonZeroU64,
        budget: NonZeroU64,
    ) -> Self {
        let entries = field.into_iter().map(|entrant| Entry::from(entrant.into()));
        let experiment = Experiment {
            name: name.to_owned(),
            seeds,
            budget,
            targets: None,
            source: None,
            instances: instances.clone(),
            field: entries.collect(),
            imported: None,
            field_place: 0..0,
            document: Document::embedded(name, ""),
        };
        let optimisers = labelled(&experiment.field, &instances);
        let runs = crossed(&instances, &optimisers, seeds, budget);
        experiment.spelt_out(instances, optimisers, runs)
    }

    /// Why this program cannot do a run, where only the one that made the results can.
    pub fn obstacle(&self, run: &RunSpec) -> Option<Failure> {
        let (instance, entrant) = (&self.instances[run.instance], &self.optimisers[run.optimiser]);
        match entrant.optimiser() {
            Err(failure) => Some(failure),
            Ok(_) if !instance.subject.is_foreign() => None,
            Ok(_) => instance.subject.problem(&entrant.space(instance)).err(),
        }
    }

    /// Of imported results: what they come from, in words.
    pub fn imported(&self) -> Option<String> {
        self.experiment.imported()
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
            *first.entry(problem_identity(instance).to_string()).or_insert(i)
        };
        self.instances.iter().enumerate().map(same).collect()
    }

    /// The places of all runs by their keys.
    pub fn places(&self) -> HashMap<&str, usize> {
        self.runs.iter().enumerate().map(|(i, run)| (run.key.as_str(), i)).collect()
    }

    /// The letter for costs: that of the first subject that has one of its own.
    pub fn cost_symbol(&self) -> &str {
        let mut symbols = self.instances.iter().map(|instance| instance.subject.cost_symbol());
        symbols.find(|symbol| *symbol != "f").unwrap_or("f")
    }

    /// The measures of all subjects, each once.
    pub fn measures(&self) -> &[Quantity] {
        &self.measures
    }

    /// The place of a measure among those of all subjects.
    pub fn measure(&self, name: &str) -> Option<usize> {
        self.measures.iter().position(|measure| measure.name == name)
    }

    /// The facts of all subjects, each once.
    pub fn facts(&self) -> &[Quantity] {
        &self.facts
    }

    /// What its stored runs have found.
    pub fn results<'a>(&'a self, runs: &'a [Run]) -> Results<'a> {
        let optimisers = self.optimisers.iter();
        Results {
            instances: &self.instances,
            optimisers: optimisers.map(|o| (&*o.label, o.formulation.as_deref())).collect(),
            measures: &self.measures,
            runs,
        }
    }

    /// The instances by the kind of their subjects, in the order of the plan.
    pub fn by_kind(&self) -> Vec<(String, Vec<&Instance>)> {
        let mut kinds: Vec<(String, Vec<&Instance>)> = Vec::new();
        for instance in &self.instances {
            let kind = instance.subject.kind();
            match kinds.iter_mut().find(|(name, _)| name == kind) {
                Some((_, own)) => own.push(instance),
                None => kinds.push((kind.to_owned(), vec![instance])),
            }
        }
        kinds
    }
}

/// The quantities of some, each name once with every kind of values that it has.
fn unlike(all: impl Iterator<Item = Quantity>) -> Vec<Quantity> {
    let mut quantities: Vec<Quantity> = Vec::new();
    for quantity in all {
        let is_same =
            |known: &&mut Quantity| known.name == quantity.name && known.kind == quantity.kind;
        match quantities.iter_mut().find(is_same) {
            // What one subject shows is shown of all.
            Some(known) => known.heading = known.heading.take().or(quantity.heading),
            None => quantities.push(quantity),
        }
    }
    quantities
}
