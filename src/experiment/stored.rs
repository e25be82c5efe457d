//! Subjects of another program, as far as a file of results tells of them.

use std::any::Any;
use std::collections::HashSet;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::budget::BudgetTable;
use super::identity::Identity;
use super::plain::PLAIN;
use super::provenance::{IMPORTED_KIND, Provenance};
use super::subject::{Coordinate, Instance, Number, Numbers, Results, Subject};
use super::value::{Quantity, Value};
use crate::exhibit::{Exhibits, Finding};
use crate::input::{Document, Finite, InputError};
use crate::search::{Failure, Problem};

/// A `[[problem]]` table: an instance that a program has entered, with all that its results need to be read.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ProblemTable {
    kind: String,
    name: String,
    #[serde(default)]
    label: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    group: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    title: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    series: Option<String>,
    dimension: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    least_cost: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    known_cost: Option<Finite>,
    /// May be infinite or NaN.
    start_cost: f64,
    #[serde(default = "letter")]
    symbol: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    spaces: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    targets: Vec<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    budget: Option<BudgetTable>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    coordinates: Vec<Coordinate>,
    /// JSON.
    identity: toml::Spanned<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    facts: Vec<FactTable>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    measures: Vec<Quantity>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FactTable {
    quantity: Quantity,
    value: Value,
}

fn letter() -> String {
    "f".to_owned()
}

impl ProblemTable {
    /// What of an instance its results need to be read.
    pub(super) fn of(instance: &Instance) -> Self {
        let Instance { label, group, title, series, subject, targets, budget, coordinates } =
            instance;
        let finite = |values: &[f64]| {
            values.iter().copied().filter(|value| value.is_finite()).map(Finite).collect()
        };
        let facts = subject.facts().into_iter().filter(|(_, value)| *value != Value::None);
        Self {
            kind: subject.kind().to_owned(),
            name: subject.name().to_owned(),
            label: label.clone(),
            group: (group != label).then(|| group.clone()),
            title: (title != group).then(|| title.clone()),
            series: (series != label).then(|| series.clone()),
            dimension: subject.dimension(),
            least_cost: subject.least_cost().filter(|cost| cost.is_finite()).map(Finite),
            known_cost: subject.known_cost().filter(|cost| cost.is_finite()).map(Finite),
            start_cost: instance.start_cost(),
            symbol: subject.cost_symbol().to_owned(),
            spaces: subject.spaces(),
            targets: finite(targets),
            budget: budget.map(|evaluations| BudgetTable { evaluations }),
            coordinates: coordinates.clone(),
            identity: toml::Spanned::new(0..0, subject.identity().to_string()),
            facts: facts.map(|(quantity, value)| FactTable { quantity, value }).collect(),
            measures: subject.measures(),
        }
    }

    /// Of an imported instance: what determines it, its label, its least known cost, the cost that searches begin with, and
    /// targets.
    pub(super) fn imported(
        provenance: &Provenance,
        label: String,
        optimum: Option<f64>,
        start_cost: f64,
        targets: &[f64],
    ) -> Self {
        let group = provenance.group();
        let known_cost = optimum.filter(|cost| cost.is_finite()).map(Finite);
        Self {
            kind: IMPORTED_KIND.to_owned(),
            series: Some(provenance.subject()),
            name: provenance.subject(),
            title: None,
            group: (group != label).then_some(group),
            label,
            dimension: provenance.dimension.and_then(|n| usize::try_from(n).ok()).unwrap_or(1),
            least_cost: known_cost.filter(|_| provenance.has_least_cost()),
            known_cost,
            start_cost,
            symbol: letter(),
            spaces: Vec::new(),
            targets: targets.iter().copied().map(Finite).collect(),
            budget: None,
            coordinates: Vec::new(),
            identity: toml::Spanned::new(0..0, provenance.identity().to_string()),
            facts: Vec::new(),
            measures: Vec::new(),
        }
    }

    /// The instance, which can be reported and not be run.
    pub(super) fn instance(&self, document: &Document) -> Result<Instance, InputError> {
        let identity = Identity::read(self.identity.get_ref()).map_err(|error| {
            let message = format!("found no JSON, expected the problem's identity: {error}");
            document.error_at(self.identity.span(), message, None)
        })?;
        let is_imported = self.kind == IMPORTED_KIND;
        let provenance = is_imported.then(|| identity.parse()).transpose().map_err(|error| {
            let message = format!("found no origin of an imported problem: {error}");
            document.error_at(self.identity.span(), message, None)
        })?;
        let group = self.group.clone().unwrap_or_else(|| self.label.clone());
        let title = self.title.clone().unwrap_or_else(|| group.clone());
        let series = self.series.clone().unwrap_or_else(|| self.label.clone());
        let targets: Vec<f64> = self.targets.iter().map(|target| target.0).collect();
        let subject = Arc::new(Stored { identity, provenance, table: self.clone() });
        Ok(Instance {
            group,
            title,
            series,
            targets,
            budget: self.budget.map(|budget| budget.evaluations),
            coordinates: self.coordinates.clone(),
            ..Instance::new(&*self.label, subject)
        })
    }
}

/// A subject that this program can only tell of.
#[derive(Debug)]
struct Stored {
    table: ProblemTable,
    identity: Identity,
    /// Of an imported one: where it comes from.
    provenance: Option<Provenance>,
}

/// What determines an imported instance; none for others.
pub(super) fn provenance(instance: &Instance) -> Option<&Provenance> {
    instance.subject.as_any()?.downcast_ref::<Stored>()?.provenance.as_ref()
}

impl Subject for Stored {
    fn kind(&self) -> &str {
        &self.table.kind
    }

    fn name(&self) -> &str {
        &self.table.name
    }

    fn identity(&self) -> Identity {
        self.identity.clone()
    }

    fn spaces(&self) -> Vec<String> {
        self.table.spaces.clone()
    }

    fn problem(&self, _: &str) -> Result<Arc<dyn Problem>, Failure> {
        Err(Failure::new(format!(
            "the problem `{}` belongs to the program that made these results",
            self.table.name
        )))
    }

    fn is_foreign(&self) -> bool {
        true
    }

    fn dimension(&self) -> usize {
        self.table.dimension
    }

    fn least_cost(&self) -> Option<f64> {
        self.table.least_cost.map(|cost| cost.0)
    }

    fn known_cost(&self) -> Option<f64> {
        self.table.known_cost.map(|cost| cost.0)
    }

    fn start_cost(&self) -> f64 {
        self.table.start_cost
    }

    fn facts(&self) -> Vec<(Quantity, Value)> {
        let facts = self.table.facts.iter();
        facts.map(|fact| (fact.quantity.clone(), fact.value.clone())).collect()
    }

    fn measures(&self) -> Vec<Quantity> {
        self.table.measures.clone()
    }

    fn cost_symbol(&self) -> &str {
        &self.table.symbol
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }

    /// An imported function keeps the number that an export of this program gave it; others have one that follows from all that
    /// determines them, since their own stand for other functions here.
    fn numbers(&self) -> Option<Numbers> {
        let provenance = self.provenance.as_ref()?;
        let function = provenance.function_identity();
        let by_identity = || Number::Of(self.identity());
        Some(match (provenance.function, provenance.instance) {
            (Some(number), Some(instance)) if provenance.is_exported() => Numbers {
                function: Number::Exported(number, function),
                instance: Number::Exported(instance, self.identity()),
            },
            (_, instance) => Numbers {
                function: Number::Of(function),
                instance: instance.map_or_else(by_identity, Number::Known),
            },
        })
    }

    fn dependence(&self, instances: &[&Instance]) -> Option<&'static str> {
        let functions = instances.iter().filter_map(|instance| provenance(instance));
        let mut seen = HashSet::new();
        let mut names = functions.map(|provenance| provenance.function_identity().to_string());
        names.any(|name| !seen.insert(name)).then_some(
            "Instances and dimensions of one imported function are not independent functions, so p-values are smaller than \
             they should be.",
        )
    }

    fn exhibits(&self, _: &Results<'_>) -> Exhibits {
        if [PLAIN, IMPORTED_KIND].contains(&self.table.kind.as_str()) {
            return Exhibits::default();
        }
        let left_out = format!(
            "What subjects of the kind `{}` show of their own is left out: only the program that made these results has \
             it.",
            self.table.kind
        );
        let finding = Finding::new("Is anything left out?", left_out.clone());
        Exhibits { findings: vec![finding], lines: vec![left_out], ..Exhibits::default() }
    }
}
