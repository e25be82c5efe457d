//! The keys of an experiment file that are the task's.

use std::num::NonZeroU64;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::family::FamilyName;
use super::poses::RandomPoses;
use super::settings::{DEFAULTS, TrajectoryTable};
use crate::input::{Document, Fraction, InputError, NonNegative, Positive, count, non_empty};
use crate::task::{PoseTable, TaskTable};

/// A file's keys that are the task's.
#[derive(Debug, Clone, Deserialize)]
pub(super) struct TaskKeys {
    /// The task that the sweep varies.
    pub(super) task: TaskTable,
    /// The family to search and how.
    pub(super) trajectory: TrajectoryTable,
    /// What is varied.
    #[serde(default)]
    pub(super) sweep: Sweep,
}

/// The same as a file has them; the task is left out where those of files take its place.
#[derive(Serialize)]
pub(super) struct WrittenKeys<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) task: Option<&'a TaskTable>,
    pub(super) trajectory: &'a TrajectoryTable,
    #[serde(skip_serializing_if = "Sweep::is_empty")]
    pub(super) sweep: &'a Sweep,
}

/// The `[sweep]` table: the instances are the cross product of its lists.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct Sweep {
    /// Robots that do the task: names or files.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) robot: Vec<Spanned<String>>,
    /// Files of tasks that take the task's place.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) task: Vec<Spanned<String>>,
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
    /// The largest turn of the base on the way \[°\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) base_turn_deg: Vec<Positive>,
    /// Half the opening angle of the task's one cone \[°\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) base_cone_deg: Vec<Spanned<Positive>>,
    /// The largest angular speed of the base \[°/s\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) base_rate_deg_s: Vec<Positive>,
    /// The largest speed of the tool \[m/s\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) tool_speed_m_s: Vec<Positive>,
    /// The same limit for all joints \[N·m\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) torque_n_m: Vec<Positive>,
    /// How far bodies have to stay apart \[m\].
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) clearance_m: Vec<NonNegative>,
    /// What a degree of the base's largest turn adds to the cost.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) weight_largest_turn: Vec<NonNegative>,
    /// What a degree of the base's mean turn adds to the cost.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) weight_mean_turn: Vec<NonNegative>,
    /// Families of motions.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) family: Vec<FamilyName>,
    /// Free coefficients per joint of sine polynomials.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) terms: Vec<Spanned<usize>>,
    /// Pieces of splines.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) pieces: Vec<Spanned<usize>>,
    /// Degrees of splines.
    #[serde(deserialize_with = "non_empty", skip_serializing_if = "Vec::is_empty")]
    pub(super) degree: Vec<Spanned<usize>>,
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

/// A list of sizes, which is for the instances of one family alone.
pub(super) struct Sizes<'a> {
    pub(super) name: &'static str,
    pub(super) family: FamilyName,
    pub(super) values: &'a [Spanned<usize>],
    pub(super) set: fn(TrajectoryTable, Spanned<usize>) -> TrajectoryTable,
}

impl TaskKeys {
    /// The keys of an experiment file; what they leave out of the task is that of its robot's own.
    pub(super) fn read(keys: &[&str], document: &Document) -> Result<Self, InputError> {
        let Self { task, trajectory, sweep } = document.parse_keys(keys, &[DEFAULTS])?;
        if let (false, Some(place)) = (sweep.task.is_empty(), document.key("task")?) {
            let message = "found a `[task]` beside the tasks of the sweep, expected one of them";
            return Err(document.error_at(place, message, None));
        }
        let trajectory = if sweep.family.is_empty() { trajectory.implied() } else { trajectory };
        let own = [trajectory.family()];
        let families = if sweep.family.is_empty() { &own[..] } else { &sweep.family };
        for Sizes { name, family, values, .. } in sweep.sizes() {
            if let Some(first) = values.first().filter(|_| !families.contains(&family)) {
                return Err(family.alone(name, first.span(), document));
            }
        }
        let trajectory = trajectory.swept_over(families);
        trajectory.check_keys(document)?;
        Ok(Self { task, trajectory, sweep })
    }
}

impl Sweep {
    /// The lists of sizes.
    pub(super) fn sizes(&self) -> [Sizes<'_>; 3] {
        use FamilyName::{SinePolynomial, Spline};
        [
            Sizes {
                name: "terms",
                family: SinePolynomial,
                values: &self.terms,
                set: TrajectoryTable::with_terms,
            },
            Sizes {
                name: "pieces",
                family: Spline,
                values: &self.pieces,
                set: TrajectoryTable::with_pieces,
            },
            Sizes {
                name: "degree",
                family: Spline,
                values: &self.degree,
                set: TrajectoryTable::with_degree,
            },
        ]
    }

    /// How many instances the lists give together.
    pub(super) fn count(&self) -> u64 {
        let lists = [
            self.robot.len(),
            self.task.len(),
            self.weight_base.len(),
            self.rate_limit_deg_s.len(),
            self.acceleration_limit_deg_s2.len(),
            self.jerk_limit_deg_s3.len(),
            self.base_turn_deg.len(),
            self.base_cone_deg.len(),
            self.base_rate_deg_s.len(),
            self.tool_speed_m_s.len(),
            self.torque_n_m.len(),
            self.clearance_m.len(),
            self.weight_largest_turn.len(),
            self.weight_mean_turn.len(),
            self.budget.len(),
            self.pose.len(),
        ];
        let product = |lengths: &[usize]| {
            lengths.iter().fold(1, |all: u64, length| all.saturating_mul((*length).max(1) as u64))
        };
        let of_family = |family: &FamilyName| {
            let own = self.sizes().into_iter().filter(|sizes| sizes.family == *family);
            product(&own.map(|sizes| sizes.values.len()).collect::<Vec<_>>())
        };
        let families = match &self.family[..] {
            // Sizes are those of the one family there is.
            [] => product(&self.sizes().map(|sizes| sizes.values.len())),
            families => families.iter().map(of_family).fold(0, u64::saturating_add),
        };
        let random = self.random_poses.as_ref().map_or(1, |random| random.get_ref().count.get());
        product(&lists).saturating_mul(families).saturating_mul(random)
    }

    fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
