//! The keys of an experiment file that are the task's.

use std::num::NonZeroU64;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::poses::RandomPoses;
use super::settings::TrajectoryTable;
use crate::input::{Fraction, Positive, count, non_empty};
use crate::task::{PoseTable, TaskTable};

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
