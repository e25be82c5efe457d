//! The task in experiment files: its keys `task`, `trajectory` and `sweep`.

use std::num::NonZeroU64;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use toml::Spanned;

use super::poses::RandomPoses;
use super::settings::{DEFAULTS, TrajectoryTable};
use super::subject::{KIND, SPACES};
use super::sweep;
use crate::experiment::{Instance, Kind, Source, written};
use crate::input::{Document, Fraction, InputError, Positive, count, non_empty};
use crate::robot::RobotFile;
use crate::task::{PoseTable, TaskTable};

/// The reorientation task. What an experiment file leaves out is the paper's.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReorientationTask;

/// A file's keys that are the task's.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct TaskKeys {
    /// The task that the sweep varies.
    pub(super) task: TaskTable,
    /// The family to search and how.
    pub(super) trajectory: TrajectoryTable,
    /// What is varied.
    #[serde(default, skip_serializing_if = "Sweep::is_empty")]
    pub(super) sweep: Sweep,
}

/// The `[sweep]` table: the instances are the cross product of its lists.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct Sweep {
    /// `K_b`.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) weight_base: Vec<Fraction>,
    /// The same limit for all joints \[°/s\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) rate_limit_deg_s: Vec<Positive>,
    /// The same limit for all joints \[°/s²\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) acceleration_limit_deg_s2: Vec<Positive>,
    /// The same limit for all joints \[°/s³\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) jerk_limit_deg_s3: Vec<Positive>,
    /// Free coefficients per joint.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) terms: Vec<Spanned<usize>>,
    /// Evaluations per run, instead of the budget's.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) budget: Vec<Evaluations>,
    /// Pairs of start and goal; what one leaves out is the task's.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) pose: Vec<PoseTable>,
    /// Pairs drawn at random instead.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) random_poses: Option<Spanned<RandomPoses>>,
}

/// Evaluations that a run may make, checked where they stand in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Evaluations(
    #[serde(deserialize_with = "count::<1_000_000_000_000, _, _>")] pub(super) NonZeroU64,
);

impl Sweep {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl Kind for ReorientationTask {
    fn name(&self) -> &'static str {
        KIND
    }

    fn keys(&self) -> &'static [&'static str] {
        &["task", "trajectory", "sweep"]
    }

    fn spaces(&self) -> &'static [&'static str] {
        &SPACES
    }

    fn read(&self, document: &Document) -> Result<Arc<dyn Source>, InputError> {
        let keys: TaskKeys = document.parse_keys(self.keys(), &[DEFAULTS])?;
        Ok(Arc::new(keys))
    }
}

impl Source for TaskKeys {
    fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
        sweep::instances(self, document)
    }

    fn written(&self) -> Map<String, Value> {
        written(self)
    }

    fn sets_budgets(&self) -> bool {
        !self.sweep.budget.is_empty()
    }

    fn without_budgets(&self) -> Option<Arc<dyn Source>> {
        let sweep = Sweep { budget: Vec::new(), ..self.sweep.clone() };
        self.sets_budgets().then(|| Arc::new(Self { sweep, ..self.clone() }) as Arc<dyn Source>)
    }

    fn kept(
        &self,
        document: &Document,
    ) -> Result<Option<(Arc<dyn Source>, Vec<(String, String)>)>, InputError> {
        const ROBOT: &str = "robot.toml";
        let Some(path) = self.task.robot_file(document) else { return Ok(None) };
        let robot = RobotFile::read(&Document::read(&path)?)?;
        let text = toml::to_string(&robot).map_err(|error| {
            document.error_at(0..0, format!("cannot keep the robot: {error}"), None)
        })?;
        let keys = Self { task: self.task.clone().with_robot(ROBOT), ..self.clone() };
        Ok(Some((Arc::new(keys), vec![(ROBOT.to_owned(), text)])))
    }
}
