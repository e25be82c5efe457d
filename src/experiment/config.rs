//! The experiment file.

use std::num::NonZeroU64;

use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::{EntrantTable, Plan, RandomPoses, TargetTable, field};
use crate::functions::{DEFAULTS as FUNCTION_DEFAULTS, FunctionTable};
use crate::input::{Document, Fraction, InputError, Positive, count, non_empty};
use crate::reorientation::{DEFAULTS as TASK_DEFAULTS, TrajectoryTable};
use crate::task::{PoseTable, TaskTable};

const DEFAULTS: &str = include_str!("defaults.toml");

/// An experiment file: every optimiser on every instance of the sweep, for every seed.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct ExperimentFile {
    /// Names the folder of its results.
    #[serde(deserialize_with = "folder_name")]
    pub name: String,
    /// Number of seeds; they are 1, 2, … and the same for every optimiser and instance.
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub seeds: NonZeroU64,
    /// What each run may spend.
    pub budget: BudgetTable,
    /// Costs that runs are asked to reach; by default they follow the best known costs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub targets: Option<Spanned<TargetTable>>,
    /// The task that the sweep varies; none beside functions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<TaskTable>,
    /// The family to search and how; none beside functions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trajectory: Option<TrajectoryTable>,
    /// What is varied.
    #[serde(default, skip_serializing_if = "Sweep::is_empty")]
    pub sweep: Sweep,
    /// Test functions instead of the task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub functions: Option<FunctionTable>,
    /// The field.
    pub optimiser: Spanned<Vec<EntrantTable>>,
}

/// The `budget` table.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table such as `{ evaluations = 150_000 }`")]
pub struct BudgetTable {
    /// Evaluations a run.
    #[serde(deserialize_with = "count::<1_000_000_000_000, _, _>")]
    pub evaluations: NonZeroU64,
}

/// The `[sweep]` table: the instances are the cross product of its lists.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Sweep {
    /// `K_b`.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub weight_base: Vec<Fraction>,
    /// The same limit for all joints \[°/s\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub rate_limit_deg_s: Vec<Positive>,
    /// The same limit for all joints \[°/s²\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub acceleration_limit_deg_s2: Vec<Positive>,
    /// The same limit for all joints \[°/s³\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub jerk_limit_deg_s3: Vec<Positive>,
    /// Free coefficients a joint.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub terms: Vec<Spanned<usize>>,
    /// Evaluations a run, instead of the budget's.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub budget: Vec<Evaluations>,
    /// Pairs of start and goal; what one leaves out is the task's.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub pose: Vec<PoseTable>,
    /// Pairs drawn at random instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub random_poses: Option<Spanned<RandomPoses>>,
}

/// Evaluations that a run may make, checked where they stand in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Evaluations(
    #[serde(deserialize_with = "count::<1_000_000_000_000, _, _>")] pub NonZeroU64,
);

impl Sweep {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl ExperimentFile {
    /// Reads an experiment; the task it leaves out is the paper's, unless it has functions instead.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        let on_functions = document.key("functions")?.is_some();
        for key in ["task", "trajectory", "sweep"] {
            if let (true, Some(place)) = (on_functions, document.key(key)?) {
                let message = format!("found both `functions` and `{key}`, expected one of them");
                return Err(document.error_at(place, message, None));
            }
        }
        let problem = if on_functions { FUNCTION_DEFAULTS } else { TASK_DEFAULTS };
        let file: Self = document
            .parse_reshaped(&[DEFAULTS, problem], |table| field::spell_out(table, document))?;
        if file.optimiser.get_ref().is_empty() {
            let message = "found no optimiser, expected at least one `[[optimiser]]`";
            return Err(document.error_at(file.optimiser.span(), message, None));
        }
        Ok(file)
    }

    /// The same file with this number of seeds for every optimiser.
    #[must_use]
    pub fn with_seeds(mut self, seeds: NonZeroU64) -> Self {
        self.seeds = seeds;
        self.optimiser.get_mut().iter_mut().for_each(|entrant| entrant.seeds = None);
        self
    }

    /// The same file with this budget for every run.
    #[must_use]
    pub fn with_budget(mut self, evaluations: NonZeroU64) -> Self {
        self.budget = BudgetTable { evaluations };
        self.sweep.budget.clear();
        self.optimiser.get_mut().iter_mut().for_each(|entrant| entrant.budget = None);
        self
    }

    /// The same file with the targets that the plan has, wherever they came from.
    #[must_use]
    pub fn with_targets(self, plan: &Plan) -> Self {
        Self { targets: Some(Spanned::new(0..0, TargetTable::of(&plan.instances))), ..self }
    }

    /// The experiment that runs when none is named.
    pub fn embedded() -> Document {
        Document::embedded("default.toml", include_str!("../../experiments/default.toml"))
    }
}

/// A name that is safe as a folder's on any system.
fn folder_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let name = String::deserialize(deserializer)?;
    let good = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(good) {
        let expected = "letters, digits, `-`, `_` and `.`, since it names a folder";
        return Err(D::Error::custom(format!("found name {name:?}, expected {expected}")));
    }
    Ok(name)
}
