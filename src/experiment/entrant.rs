//! Who competes: an optimiser with all that determines its runs.

use std::fmt;
use std::num::NonZeroU64;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::external::ExternalTable;
use super::identity::Identity;
use super::subject::Instance;
use crate::input::{Document, InputError};
use crate::optimiser::{Optimiser, Settings};
use crate::process::Command;
use crate::search::{Failure, Oracle, Problem, Rng, Stop};

/// One optimiser of the field.
#[derive(Clone)]
#[non_exhaustive]
pub struct Entrant {
    /// The label given, or optimiser and, on subjects with several formulations, formulation; with changed settings
    /// where the field has these more than once.
    pub label: String,
    /// The optimiser's name: what it is a kind of.
    pub(crate) kind: String,
    /// The name of the optimiser that searches first, of one that has two phases.
    pub(crate) search: Option<String>,
    /// All settings; together with the formulation they determine a run.
    pub(crate) settings: Identity,
    /// The formulation asked for; without it each subject's preferred one.
    pub(crate) formulation: Option<String>,
    /// Whether it can search only problems with derivatives.
    pub(crate) needs_derivatives: bool,
    /// Number of seeds, instead of the experiment's.
    pub seeds: Option<NonZeroU64>,
    /// Evaluations that each of its runs may spend, instead of the experiment's or the instance's
    /// budget.
    pub budget: Option<NonZeroU64>,
    /// None for an optimiser of the program that made the results.
    pub(super) optimiser: Option<Arc<dyn Optimiser>>,
    pub(super) origin: Origin,
    pub(super) is_labelled: bool,
    /// Of an optimiser whose runs were imported: what from, in words.
    pub(super) imported: Option<Arc<str>>,
}

/// Where an entrant comes from.
#[derive(Clone)]
pub(super) enum Origin {
    /// The catalogue.
    Catalogue(Settings),
    /// A program that an experiment file names.
    External {
        /// As the file has it.
        table: Box<ExternalTable>,
        /// What is started.
        command: Command,
    },
    /// The program that made the experiment.
    Outside,
}

impl fmt::Debug for Entrant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Entrant");
        shown.field("label", &self.label).field("settings", &self.settings);
        shown.finish_non_exhaustive()
    }
}

/// An optimiser of the catalogue as a value of its own.
struct Catalogued(Settings);

impl Optimiser for Catalogued {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        self.0.optimiser().minimise(oracle, rng)
    }

    fn formulation(&self) -> Option<&str> {
        self.0.optimiser().formulation()
    }

    fn needs_derivatives(&self) -> bool {
        self.0.optimiser().needs_derivatives()
    }

    fn lacks(&self, problem: &dyn Problem) -> Option<&'static str> {
        self.0.optimiser().lacks(problem)
    }

    fn parts(&self) -> Option<(Box<dyn Optimiser>, usize)> {
        self.0.optimiser().parts()
    }
}

impl From<Settings> for Entrant {
    fn from(settings: Settings) -> Self {
        let search = match &settings {
            Settings::Hybrid(hybrid) => Some(hybrid.search.name().to_owned()),
            _ => None,
        };
        Self {
            label: settings.title(),
            kind: settings.name().to_owned(),
            search,
            settings: Identity::of(serde_json::to_value(&settings).unwrap_or_default()),
            formulation: settings.formulation().map(str::to_owned),
            needs_derivatives: settings.optimiser().needs_derivatives(),
            seeds: None,
            budget: None,
            optimiser: Some(Arc::new(Catalogued(settings.clone()))),
            origin: Origin::Catalogue(settings),
            is_labelled: false,
            imported: None,
        }
    }
}

impl Entrant {
    /// An optimiser of one's own. `settings` is all that determines its runs beside the seed, a version of its
    /// code included: a stored run with the same is not done again.
    pub fn new(name: &str, settings: Identity, optimiser: impl Optimiser + 'static) -> Self {
        Self::of(name, settings, Origin::Outside, optimiser)
    }

    /// A program that an experiment file names.
    pub(super) fn external(table: ExternalTable, document: &Document) -> Result<Self, InputError> {
        let solver = table.solver(document)?;
        let command = solver.command().clone();
        let (name, identity) = (table.name(&command), table.identity(&command));
        let origin = Origin::External { table: Box::new(table), command };
        Ok(Self::of(&name, identity, origin, solver))
    }

    fn of(
        name: &str,
        settings: Identity,
        origin: Origin,
        optimiser: impl Optimiser + 'static,
    ) -> Self {
        Self {
            label: name.to_owned(),
            kind: name.to_owned(),
            search: None,
            settings,
            formulation: optimiser.formulation().map(str::to_owned),
            needs_derivatives: optimiser.needs_derivatives(),
            seeds: None,
            budget: None,
            optimiser: Some(Arc::new(optimiser)),
            origin,
            is_labelled: false,
            imported: None,
        }
    }

    /// An optimiser of another program, which can be reported and not be run.
    pub(super) fn outside(name: String, settings: Identity) -> Self {
        Self {
            label: name.clone(),
            kind: name,
            search: None,
            settings,
            formulation: None,
            needs_derivatives: false,
            seeds: None,
            budget: None,
            optimiser: None,
            origin: Origin::Outside,
            is_labelled: false,
            imported: None,
        }
    }

    /// The same under another label.
    #[must_use]
    pub fn labelled(self, label: &str) -> Self {
        Self { label: label.to_owned(), is_labelled: true, ..self }
    }

    /// The optimiser's name: what it is a kind of.
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// Of an optimiser whose runs were imported: what from, in words. Little is known of such runs beside their traces.
    pub fn imported(&self) -> Option<&str> {
        self.imported.as_deref()
    }

    /// Whether it can search only problems with derivatives.
    pub fn needs_derivatives(&self) -> bool {
        self.needs_derivatives
    }

    /// What it needs of a problem that this one does not give, if anything.
    pub(super) fn lacks(&self, problem: &dyn Problem) -> Option<&'static str> {
        let unknown =
            || (self.needs_derivatives && problem.slopes().is_none()).then_some("derivatives");
        self.optimiser.as_ref().map_or_else(unknown, |optimiser| optimiser.lacks(problem))
    }

    /// The optimiser itself.
    pub fn optimiser(&self) -> Result<&dyn Optimiser, Failure> {
        self.optimiser.as_deref().ok_or_else(|| {
            Failure::new(match &self.imported {
                Some(from) => format!("the runs of `{}` were imported, from {from}", self.label),
                None => format!(
                    "the optimiser `{}` belongs to the program that made these results",
                    self.kind
                ),
            })
        })
    }

    /// The formulation in which it searches an instance; empty where that has but one.
    pub fn space(&self, instance: &Instance) -> String {
        instance.space(self.formulation.as_deref())
    }

    /// All that determines its runs beside formulation, seed and budget.
    pub(super) fn identity(&self) -> Value {
        let mut settings = self.settings.json().clone();
        remove_formulation(&mut settings);
        match self.origin {
            Origin::Catalogue(_) => settings,
            Origin::External { .. } => serde_json::json!({ "external": settings }),
            Origin::Outside => serde_json::json!({ "outside": self.kind, "settings": settings }),
        }
    }

    /// Whether it is another program's, as far as results tell of it.
    pub(super) fn is_outside(&self) -> bool {
        matches!(self.origin, Origin::Outside)
    }

    /// The program that it starts, and whether the file that names it is one of results.
    pub fn program(&self) -> Option<(&Command, bool)> {
        match &self.origin {
            Origin::External { table, command } => Some((command, table.is_kept())),
            Origin::Catalogue(_) | Origin::Outside => None,
        }
    }

    /// The settings that differ from the default, as a label has them.
    pub(super) fn changed_settings(&self) -> Vec<String> {
        match &self.origin {
            Origin::Catalogue(settings) => settings.changed(),
            Origin::External { table, .. } => table.settings(),
            Origin::Outside => Vec::new(),
        }
    }

    /// The same as results keep it.
    pub(super) fn kept(self) -> Self {
        match self.origin {
            Origin::External { table, command } => {
                let table = Box::new(table.kept(&command));
                Self { origin: Origin::External { table, command }, ..self }
            }
            _ => self,
        }
    }
}

/// A run's formulation is part of its recipe, whether it was asked for or the subject's own.
fn remove_formulation(value: &mut Value) {
    if let Value::Object(map) = value {
        map.shift_remove("formulation");
        map.values_mut().for_each(remove_formulation);
    }
}

/// The `outside` table of an `[[optimiser]]`: what results tell of another program's optimiser.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct OutsideTable {
    name: String,
    /// JSON.
    settings: toml::Spanned<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    formulation: Option<String>,
    #[serde(default)]
    needs_derivatives: bool,
}

impl OutsideTable {
    pub(super) fn of(entrant: &Entrant) -> Self {
        Self {
            name: entrant.kind.clone(),
            settings: toml::Spanned::new(0..0, entrant.settings.to_string()),
            formulation: entrant.formulation.clone(),
            needs_derivatives: entrant.needs_derivatives,
        }
    }

    /// An entrant that can be reported and not be run.
    pub(super) fn entrant(self, document: &Document) -> Result<Entrant, InputError> {
        let settings = Identity::read(self.settings.get_ref()).map_err(|error| {
            let message = format!("found no JSON, expected the optimiser's settings: {error}");
            document.error_at(self.settings.span(), message, None)
        })?;
        let Self { formulation, needs_derivatives, .. } = self;
        Ok(Entrant { formulation, needs_derivatives, ..Entrant::outside(self.name, settings) })
    }
}
