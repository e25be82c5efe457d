//! The `random_poses` of a sweep: pairs of start and goal for any robot.

use std::num::NonZeroU64;

use nalgebra::{Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::input::{count, optional_positive, positive, share};
use crate::robot::{JointKind, Robot};
use crate::search::Rng;
use crate::task::{PoseTable, PostureParts};

/// The `random_poses` table: how to draw pairs of start and goal.
///
/// Uniform draws are the same to the last bit on every machine; angles are rounded to a millionth of a
/// degree, so that the last digits of a library of mathematics change none. Of the 24 pairs that the
/// defaults give for the paper's robot, `scp` brings the base all the way in 24.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct RandomPoses {
    /// Number of pairs; more of them leave the first ones as they are.
    #[serde(deserialize_with = "count::<10_000, _, _>")]
    pub count: NonZeroU64,
    /// Seed of the draws.
    #[serde(deserialize_with = "count::<9_000_000_000_000_000_000, _, _>")]
    pub seed: NonZeroU64,
    /// Share of each joint's range, about its middle, that start and goal stay in.
    #[serde(deserialize_with = "share")]
    pub range_share: f64,
    /// Largest change of a joint from start to goal \[°\].
    #[serde(deserialize_with = "positive")]
    pub joint_change_deg: f64,
    /// The same of a joint that slides \[m\]; anywhere in its share of the range without one.
    #[serde(deserialize_with = "optional_positive", skip_serializing_if = "Option::is_none")]
    pub joint_change_m: Option<f64>,
    /// Largest turn of the base from start to goal \[°\].
    #[serde(deserialize_with = "positive")]
    pub turn_deg: f64,
}

impl Default for RandomPoses {
    fn default() -> Self {
        Self {
            count: NonZeroU64::MIN.saturating_add(23),
            seed: NonZeroU64::MIN,
            range_share: 0.8,
            joint_change_deg: 60.0,
            joint_change_m: None,
            turn_deg: 30.0,
        }
    }
}

impl RandomPoses {
    /// Draws the pairs. Joints start uniformly within their share of the range and end uniformly
    /// within the allowed change of that; the base turns about an axis uniform over all directions, by
    /// an angle uniform from zero, and ends along the inertial axes. Joints that follow others are left out.
    pub(super) fn draw(&self, robot: &Robot) -> Vec<PoseTable> {
        let mut rng = Rng::new(self.seed.get());
        (0..self.count.get()).map(|_| self.pose(robot, &mut rng)).collect()
    }

    fn pose(&self, robot: &Robot, rng: &mut Rng) -> PoseTable {
        let (mut start, mut goal) = (Vec::new(), Vec::new());
        for joint in robot.joints().filter(|joint| joint.follows.is_none()) {
            let [lower, upper] = joint.range.map(|end| joint.kind.to_file_units(end));
            let middle = f64::midpoint(lower, upper);
            let half = self.range_share * (upper - lower) / 2.0;
            let [lower, upper] = [middle - half, middle + half];
            let from = rng.uniform(lower, upper);
            let change = match joint.kind {
                JointKind::Revolute => self.joint_change_deg,
                JointKind::Prismatic => self.joint_change_m.unwrap_or(f64::INFINITY),
            };
            let to = rng.uniform(lower.max(from - change), upper.min(from + change));
            start.push(rounded(from).clamp(lower, upper));
            goal.push(rounded(to).clamp(lower, upper));
        }
        let axis = direction(rng);
        let angle = rng.uniform(0.0, self.turn_deg).to_radians();
        let (roll, pitch, yaw) = UnitQuaternion::from_axis_angle(&axis, angle).euler_angles();
        let base = [yaw, pitch, roll].map(|angle| rounded(angle.to_degrees()));
        PoseTable {
            start: PostureParts::new(robot, start, base),
            goal: PostureParts::new(robot, goal, [0.0; 3]),
        }
    }
}

/// A direction uniform over the sphere: that of a point uniform in the ball, from square roots alone.
fn direction(rng: &mut Rng) -> Unit<Vector3<f64>> {
    loop {
        let point = Vector3::from_fn(|_, _| rng.uniform(-1.0, 1.0));
        if (1e-3..=1.0).contains(&point.norm_squared()) {
            return Unit::new_normalize(point);
        }
    }
}

/// To a millionth of a degree or metre.
fn rounded(position: f64) -> f64 {
    (position * 1e6).round() / 1e6
}
