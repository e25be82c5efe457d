//! An experiment: read from a file, or put together in a program.

use std::num::NonZeroU64;
use std::ops::Range;
use std::sync::Arc;

use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::budget::BudgetTable;
use super::entrant::Entrant;
use super::external::{ExternalProblem, ExternalProblemTable};
use super::field::{self, EntrantTable, Entry, WrittenEntrant};
use super::import_table::ImportTable;
use super::kind::{Registry, Source};
use super::stored::ProblemTable;
use super::subject::Instance;
use super::targets::TargetTable;
use crate::input::{Document, InputError, count, keep, nearest};
use crate::process::Command;

const DEFAULTS: &str = include_str!("defaults.toml");

/// The keys of a file that are the same for all kinds of subjects.
const KEYS: [&str; 7] = ["name", "seeds", "budget", "targets", "imported", "problem", "optimiser"];

/// An experiment: every optimiser on every instance, for every seed.
#[derive(Debug, Clone)]
pub struct Experiment {
    pub(super) name: String,
    pub(super) seeds: NonZeroU64,
    pub(super) budget: NonZeroU64,
    pub(super) targets: Option<Spanned<TargetTable>>,
    /// Where the instances of a file come from.
    pub(super) source: Option<Arc<dyn Source>>,
    /// Instances that a program has entered.
    pub(super) instances: Vec<Instance>,
    pub(super) field: Vec<Entry>,
    /// Of imported results: where they come from, and which there are.
    pub(super) imported: Option<ImportTable>,
    /// Where the field stands.
    pub(super) field_place: Range<usize>,
    pub(super) document: Document,
}

/// What a file has beside the tables of its subjects.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct FileTable {
    #[serde(deserialize_with = "folder_name")]
    name: String,
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    seeds: NonZeroU64,
    budget: BudgetTable,
    #[serde(default)]
    targets: Option<Spanned<TargetTable>>,
    #[serde(default)]
    imported: Option<Spanned<ImportTable>>,
    #[serde(default)]
    problem: Vec<ProblemTable>,
    /// Those of `problem` that are programs.
    #[serde(default)]
    external_problem: Vec<ExternalProblemTable>,
    optimiser: Spanned<Vec<EntrantTable>>,
}

impl Experiment {
    /// An experiment without instances and optimisers, of 15 seeds and 150,000 evaluations per run. The name, of
    /// letters, digits, `-`, `_` and `.`, is that of its folder of results.
    pub fn new(name: &str) -> Result<Self, InputError> {
        let document = Document::embedded(&format!("the experiment {name:?}"), "");
        checked_name(name).map_err(|message| document.error_at(0..0, message, None))?;
        Ok(Self {
            name: name.to_owned(),
            seeds: NonZeroU64::MIN.saturating_add(14),
            budget: NonZeroU64::MIN.saturating_add(149_999),
            targets: None,
            source: None,
            instances: Vec::new(),
            field: Vec::new(),
            imported: None,
            field_place: 0..0,
            document,
        })
    }

    /// Reads an experiment file. Its subjects are of the kind whose keys it has; without any, of the registry's first.
    pub fn read(document: &Document, registry: &Registry) -> Result<Self, InputError> {
        check_keys(document, registry)?;
        let has_problems = document.key("problem")?.is_some();
        let kind = registry.kind_of(document)?;
        let has_keys = |keys: &[&str]| -> Result<bool, InputError> {
            keys.iter().try_fold(false, |has, key| Ok(has || document.key(key)?.is_some()))
        };
        let kind = match kind {
            Some(kind) if has_problems && !has_keys(kind.keys())? => None,
            kind => kind,
        };
        let spaces = kind.map_or(&[][..], |kind| kind.spaces());
        let file: FileTable = document.parse_reshaped(&[DEFAULTS], |table| {
            keep(table, &KEYS);
            part_programs(table);
            field::spell_out(table, spaces, document)
        })?;
        let field_place = file.optimiser.span();
        let entries = file.optimiser.into_inner().into_iter();
        let entries: Vec<Entry> = entries.map(|t| t.entry(document)).collect::<Result<_, _>>()?;
        if entries.is_empty() {
            let message = "found no optimiser, expected at least one `[[optimiser]]`";
            return Err(document.error_at(field_place, message, None));
        }
        let programs = file.external_problem.into_iter().map(|table| table.instance(document));
        let instances = file.problem.iter().map(|table| table.instance(document)).chain(programs);
        let mut experiment = Self {
            name: file.name,
            seeds: file.seeds,
            budget: file.budget.evaluations,
            targets: file.targets,
            source: kind.map(|kind| kind.read(document)).transpose()?,
            instances: instances.collect::<Result<_, _>>()?,
            field: entries,
            imported: None,
            field_place,
            document: document.clone(),
        };
        if let Some(table) = file.imported {
            experiment.check_imported(table.span())?;
            experiment.mark_imported(table.into_inner());
        }
        Ok(experiment)
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of seeds, for optimisers that have none of their own; they are 1, 2, … and the same for every
    /// optimiser and instance.
    pub fn seeds(&self) -> NonZeroU64 {
        self.seeds
    }

    /// Of imported results: what they come from, in words.
    pub fn imported(&self) -> Option<String> {
        self.imported.as_ref().map(ImportTable::words)
    }

    /// Marks all of it as imported.
    pub(super) fn mark_imported(&mut self, table: ImportTable) {
        let words: Arc<str> = table.words().into();
        for entry in &mut self.field {
            entry.entrant.imported = Some(words.clone());
        }
        self.imported = Some(table);
    }

    /// Whether nothing stands beside `imported` that could be run.
    fn check_imported(&self, place: Range<usize>) -> Result<(), InputError> {
        let is_foreign = self.source.is_none()
            && self.instances.iter().all(|instance| instance.subject.is_foreign())
            && self.field.iter().all(|entry| entry.entrant.is_outside());
        if is_foreign {
            return Ok(());
        }
        let message = "found optimisers or problems of this program beside `imported`, expected `outside` optimisers and \
                       their problems alone";
        Err(self.document.error_at(place, message, None))
    }

    /// The programs that it starts, and whether the file says that it is one of results.
    pub fn programs(&self) -> impl Iterator<Item = (&Command, bool)> {
        let problems = self.instances.iter().filter_map(ExternalProblem::of);
        let solvers = self.field.iter().filter_map(|entry| entry.entrant.program());
        problems.map(ExternalProblem::program).chain(solvers)
    }

    /// Whether there are the programs that it starts; starts those that are problems and asks what problems they are, where that is
    /// not known.
    pub fn ask_programs(&self) -> Result<(), InputError> {
        for entry in &self.field {
            if let Some((command, _)) = entry.entrant.program() {
                let error = |failure| self.document.error_at(entry.place.clone(), failure, None);
                command.check_program().and_then(|()| command.check_files()).map_err(error)?;
            }
        }
        for problem in self.instances.iter().filter_map(ExternalProblem::of) {
            let error = |failure| self.document.error_at(problem.place(), failure, None);
            let (command, _) = problem.program();
            command.check_program().and_then(|()| command.check_files()).map_err(error)?;
            problem.ask().map_err(error)?;
        }
        Ok(())
    }

    /// The same experiment with this number of seeds for every optimiser.
    #[must_use]
    pub fn with_seeds(mut self, seeds: NonZeroU64) -> Self {
        self.seeds = seeds;
        self.field.iter_mut().for_each(|entry| entry.entrant.seeds = None);
        self
    }

    /// The same experiment with this budget for every run.
    #[must_use]
    pub fn with_budget(mut self, evaluations: NonZeroU64) -> Self {
        self.budget = evaluations;
        if let Some(source) = self.source.as_ref().and_then(|source| source.without_budgets()) {
            self.source = Some(source);
        }
        self.instances.iter_mut().for_each(|instance| instance.budget = None);
        self.field.iter_mut().for_each(|entry| entry.entrant.budget = None);
        self
    }

    /// The same experiment with one more instance.
    #[must_use]
    pub fn with_instance(mut self, instance: Instance) -> Self {
        self.instances.push(instance);
        self
    }

    /// The same experiment with one more optimiser.
    #[must_use]
    pub fn with_optimiser(mut self, entrant: impl Into<Entrant>) -> Self {
        self.field.push(entrant.into().into());
        self
    }

    /// The same experiment with the optimisers of another one, too.
    #[must_use]
    pub fn with_optimisers_of(mut self, other: &Self) -> Self {
        // They stand in no place of this experiment's file.
        self.field.extend(other.field.iter().map(|entry| entry.entrant.clone().into()));
        self
    }

    /// The same experiment without its optimisers.
    #[must_use]
    pub fn without_optimisers(self) -> Self {
        Self { field: Vec::new(), field_place: 0..0, ..self }
    }

    /// The same experiment with the targets that instances have, wherever they came from.
    #[must_use]
    pub(super) fn with_targets(self, instances: &[Instance]) -> Self {
        Self { targets: Some(Spanned::new(0..0, TargetTable::of(instances))), ..self }
    }

    /// The same experiment as it stands in a folder of results, and the files that it needs there.
    pub(super) fn kept(mut self) -> Result<(Self, Vec<(String, String)>), InputError> {
        for entry in &mut self.field {
            entry.entrant = entry.entrant.clone().kept();
        }
        let kept = self.source.as_ref().map(|source| source.kept(&self.document)).transpose()?;
        let Some((source, files)) = kept.flatten() else { return Ok((self, Vec::new())) };
        self.source = Some(source);
        Ok((self, files))
    }

    /// The experiment as a TOML file that says it in full, with every default filled in; or what went wrong.
    pub fn to_toml(&self) -> Result<String, String> {
        /// What stands before the tables of a kind.
        #[derive(Serialize)]
        struct Head<'a> {
            name: &'a str,
            seeds: NonZeroU64,
            budget: BudgetTable,
            #[serde(skip_serializing_if = "Option::is_none")]
            targets: &'a Option<Spanned<TargetTable>>,
            #[serde(skip_serializing_if = "Option::is_none")]
            imported: &'a Option<ImportTable>,
        }
        /// What stands behind them.
        #[derive(Serialize)]
        struct Tail<'a> {
            #[serde(skip_serializing_if = "Vec::is_empty")]
            problem: Vec<WrittenProblem>,
            optimiser: Vec<WrittenEntrant<'a>>,
        }
        #[derive(Serialize)]
        #[serde(untagged)]
        enum WrittenProblem {
            Program(Box<ExternalProblemTable>),
            Stored(Box<ProblemTable>),
        }
        let problem = |instance: &Instance| match ExternalProblemTable::kept(instance) {
            Some(program) => WrittenProblem::Program(Box::new(program)),
            None => WrittenProblem::Stored(Box::new(ProblemTable::of(instance))),
        };
        let wrong = |error: toml::ser::Error| error.to_string();
        let head = Head {
            name: &self.name,
            seeds: self.seeds,
            budget: BudgetTable { evaluations: self.budget },
            targets: &self.targets,
            imported: &self.imported,
        };
        let tail = Tail {
            problem: self.instances.iter().map(problem).collect(),
            optimiser: self.field.iter().map(|e| WrittenEntrant::of(&e.entrant)).collect(),
        };
        let own = self.source.as_ref().map(|source| source.written()).transpose()?;
        let parts = [
            toml::to_string(&head).map_err(wrong)?,
            own.unwrap_or_default(),
            toml::to_string(&tail).map_err(wrong)?,
        ];
        Ok(parts.iter().filter(|part| !part.is_empty()).cloned().collect::<Vec<_>>().join("\n"))
    }

    /// The experiment that runs when none is named.
    pub fn embedded() -> Document {
        Document::embedded("default.toml", include_str!("../../experiments/default.toml"))
    }
}

/// Takes those of `problem`, one table or a list, that have an `external` into a list of their own.
fn part_programs(table: &mut DeTable<'_>) {
    let Some((key, problems)) = table.remove_entry("problem") else { return };
    let span = problems.span();
    let all = match problems.into_inner() {
        DeValue::Array(all) => all,
        one => DeArray::from_iter([Spanned::new(span.clone(), one)]),
    };
    let is_program = |problem: &Spanned<DeValue<'_>>| match problem.get_ref() {
        DeValue::Table(problem) => problem.contains_key("external"),
        _ => false,
    };
    let (programs, others): (Vec<_>, Vec<_>) = all.into_iter().partition(is_program);
    let list = |problems: Vec<_>| {
        Spanned::new(span.clone(), DeValue::Array(problems.into_iter().collect()))
    };
    table.insert(key, list(others));
    table.insert(Spanned::new(span.clone(), "external_problem".into()), list(programs));
}

/// Whether every key of a file is somebody's.
fn check_keys(document: &Document, registry: &Registry) -> Result<(), InputError> {
    let known: Vec<&str> = KEYS.into_iter().chain(registry.keys()).collect();
    for (key, place) in document.keys()? {
        if !known.contains(&key.as_str()) {
            let expected = known.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>();
            let message = format!("unknown field `{key}`, expected one of {}", expected.join(", "));
            let help = nearest(&key, known.iter().copied());
            let help = help.map(|near| format!("did you mean `{near}`?"));
            return Err(document.error_at(place, message, help));
        }
    }
    Ok(())
}

/// A name that is safe as a folder's on any system.
fn folder_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let name = String::deserialize(deserializer)?;
    checked_name(&name).map_err(D::Error::custom)?;
    Ok(name)
}

fn checked_name(name: &str) -> Result<(), String> {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(good) {
        let expected = "letters, digits, `-`, `_` and `.`, since it names a folder";
        return Err(format!("found name {name:?}, expected {expected}"));
    }
    Ok(())
}
