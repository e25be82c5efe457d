//! What the runs of an instance minimise, whoever made it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::instance::Instance;
use super::plan::Plan;
use super::run::Run;
use crate::exhibit::Exhibits;
use crate::search::Problem;

/// What the runs of an instance minimise: a problem with all that the harness has to know of it.
///
/// Only [`kind`](Self::kind), [`name`](Self::name), [`identity`](Self::identity) and
/// [`problem`](Self::problem) have to be written; the rest has defaults.
pub trait Subject: Send + Sync {
    /// Who made it: the name of a kind of subjects, such as `reorientation`.
    fn kind(&self) -> &str;

    /// What it is called in tables, such as `sphere`.
    fn name(&self) -> &str;

    /// Everything that determines its costs. Runs whose identities differ have different keys; a stored
    /// run with the same identity is not done again. So put a version in it, and raise that when
    /// the code changes what a cost is.
    fn identity(&self) -> serde_json::Value;

    /// The formulations in which it can be searched, the preferred one first; empty where there is but one
    /// and it needs no name.
    fn spaces(&self) -> Vec<String> {
        Vec::new()
    }

    /// The problem in one of its formulations; `space` is empty where they need no name.
    fn problem(&self, space: &str) -> Result<Arc<dyn Problem>, Unavailable>;

    /// The number of variables, whatever the formulation, so that formulations of one subject compare.
    fn dimension(&self) -> usize {
        self.start_problem().map_or(1, |problem| problem.bounds().len())
    }

    /// The least cost that there is, where that is known.
    fn least_cost(&self) -> Option<f64> {
        self.start_problem().ok().and_then(|problem| problem.least_cost())
    }

    /// The least cost that anybody has found.
    fn known_cost(&self) -> Option<f64> {
        self.least_cost()
    }

    /// The cost in the middle of the box of the preferred formulation, from which Moré and Wild's targets start;
    /// NaN where it is not known.
    fn start_cost(&self) -> f64 {
        let cost = |problem: Arc<dyn Problem>| {
            let centre =
                problem.bounds().iter().map(|[a, b]| a + 0.5 * (b - a)).collect::<Vec<_>>();
            problem.evaluate(&centre).cost
        };
        self.start_problem().map_or(f64::NAN, cost)
    }

    /// The problem in its preferred formulation.
    fn start_problem(&self) -> Result<Arc<dyn Problem>, Unavailable> {
        self.problem(self.spaces().first().map_or("", String::as_str))
    }

    /// What there is to know of it beside its name, stored with every run.
    fn facts(&self) -> Vec<(Quantity, Value)> {
        Vec::new()
    }

    /// What [`judge`](Self::judge) finds of a point beside its cost.
    fn measures(&self) -> Vec<Quantity> {
        Vec::new()
    }

    /// A run's best point, evaluated as finely as can be: its cost and one value for each of
    /// [`measures`](Self::measures). None where the search's own cost is all there is to know.
    fn judge(&self, space: &str, x: &[f64]) -> Result<Option<Judgement>, Unavailable> {
        let _ = (space, x);
        Ok(None)
    }

    /// The letter for its cost.
    fn cost_symbol(&self) -> &str {
        "f"
    }

    /// A cost as a line for a terminal has it.
    fn cost_text(&self, cost: f64) -> String {
        format!("{cost:.3e}")
    }

    /// By how much a final cost may exceed a lower one and still be taken for the same: where searches end.
    ///
    /// By default COCO's final precision, doi 10.1080/10556788.2020.1808977.
    fn resolution(&self, lowest: f64) -> f64 {
        let _ = lowest;
        1e-8
    }

    /// Why results on these instances of this kind are not independent of each other, if they are not.
    fn dependence(&self, instances: &[&Instance]) -> Option<&'static str> {
        let _ = instances;
        None
    }

    /// What is doubtful about its data but can be computed with.
    fn warning(&self) -> Option<String> {
        None
    }

    /// What is shown of it and of all other instances of its kind beside what every experiment shows.
    /// `runs` are the stored runs of the plan, on whatever subjects.
    fn exhibits(&self, plan: &Plan, runs: &[Run]) -> Exhibits {
        let _ = (plan, runs);
        Exhibits::default()
    }

    /// The subject itself, for exhibits that have to know more of their instances than this trait tells.
    fn as_any(&self) -> Option<&dyn std::any::Any> {
        None
    }
}

/// A problem that this program does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unavailable(String);

impl Unavailable {
    /// With the reason.
    pub fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }
}

/// What was found of a run's best point.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Its cost.
    pub cost: f64,
    /// One value for each measure of the subject.
    pub measures: Vec<Value>,
}

/// Something to know of a subject or of a point: a column of the table `runs`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// Name of its column, such as `t_f`.
    pub name: String,
    /// What its values are.
    pub kind: ValueKind,
    /// What it means, with its unit.
    #[serde(default)]
    pub meaning: String,
    /// Its column in the tables of a report, with its unit, such as `t_f [s]`; where there is none it is only
    /// stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<String>,
    /// What to call it among what there is to know of how runs were made, if it belongs there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<String>,
}

impl Quantity {
    /// A quantity that is stored and not shown.
    pub fn new(name: &str, kind: ValueKind, meaning: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            meaning: meaning.to_owned(),
            heading: None,
            provenance: None,
        }
    }

    /// The same, shown in tables under this heading.
    #[must_use]
    pub fn shown(self, heading: &str) -> Self {
        Self { heading: Some(heading.to_owned()), ..self }
    }

    /// The same, shown under this name where a report says how runs were made.
    #[must_use]
    pub fn telling_provenance(self, name: &str) -> Self {
        Self { provenance: Some(name.to_owned()), ..self }
    }
}

/// What the values of a quantity are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ValueKind {
    /// Texts.
    Text,
    /// Whole numbers from 0.
    Count,
    /// Numbers.
    Real,
    /// Lists of numbers.
    Reals,
}

/// A value of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Value {
    /// Not known, or of no meaning here.
    None,
    /// A text.
    Text(String),
    /// A whole number from 0.
    Count(u64),
    /// A number.
    Real(f64),
    /// A list of numbers.
    Reals(Vec<f64>),
}

impl Value {
    /// The number, if it is one.
    pub fn real(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value),
            Self::Count(value) => Some(*value as f64),
            _ => None,
        }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl From<Option<f64>> for Value {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::None, Self::Real)
    }
}

impl From<u64> for Value {
    fn from(value: u64) -> Self {
        Self::Count(value)
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::Text(value.to_owned())
    }
}

impl From<Vec<f64>> for Value {
    fn from(value: Vec<f64>) -> Self {
        Self::Reals(value)
    }
}
