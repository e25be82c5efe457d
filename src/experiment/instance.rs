//! One problem of an experiment.

use std::fmt;
use std::num::NonZeroU64;
use std::sync::Arc;

use super::caught::caught;
use super::plain::Plain;
use super::subject::{Subject, Value};
use crate::search::Problem;

/// One problem of an experiment.
#[derive(Clone)]
#[non_exhaustive]
pub struct Instance {
    /// What tells it from the others, such as `weight_base=0.5 terms=4`; empty where there is but one.
    pub label: String,
    /// What it shares with those it is summarised and drawn with; the label where there are none.
    pub group: String,
    /// The group as charts write it.
    pub title: String,
    /// The settings that a sweep has given it.
    pub coordinates: Vec<Coordinate>,
    /// What is minimised.
    pub subject: Arc<dyn Subject>,
    /// Evaluations that each run may spend, instead of the experiment's budget.
    pub budget: Option<NonZeroU64>,
    /// Costs that runs are asked to reach.
    pub targets: Vec<f64>,
}

/// A setting and its value on one instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Coordinate {
    /// The setting.
    pub setting: String,
    /// Its value.
    pub value: Value,
}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = f.debug_struct("Instance");
        shown.field("label", &self.label).field("subject", &self.subject.name());
        shown.finish_non_exhaustive()
    }
}

impl Instance {
    /// An instance on a subject.
    pub fn new(label: impl Into<String>, subject: Arc<dyn Subject>) -> Self {
        let label = label.into();
        Self {
            group: label.clone(),
            title: label.clone(),
            label,
            coordinates: Vec::new(),
            subject,
            budget: None,
            targets: Vec::new(),
        }
    }

    /// An instance on a problem of one's own, with the name as label. `identity` is all that determines its costs,
    /// a version of its code included: see [`Subject::identity`].
    pub fn of_problem(
        name: &str,
        identity: impl Into<serde_json::Value>,
        problem: impl Problem + 'static,
    ) -> Self {
        Self::new(name, Arc::new(Plain::new(name, identity.into(), Arc::new(problem))))
    }

    /// With costs that runs are asked to reach.
    #[must_use]
    pub fn with_targets(self, targets: impl Into<Vec<f64>>) -> Self {
        Self { targets: targets.into(), ..self }
    }

    /// The cost in the middle of the box; NaN where the problem panics there.
    pub(crate) fn start_cost(&self) -> f64 {
        caught(|| self.subject.start_cost()).unwrap_or(f64::NAN)
    }

    /// The value of a setting of the sweep.
    pub fn coordinate(&self, setting: &str) -> Option<&Value> {
        let found = self.coordinates.iter().find(|coordinate| coordinate.setting == setting);
        found.map(|coordinate| &coordinate.value)
    }
}
