//! What is to be done: from where to where, within which limits, weighed how.

mod file;
mod pose;

use std::sync::Arc;

use nalgebra::UnitQuaternion;
#[cfg(feature = "harness")]
use serde_json::{Value, json};

use crate::robot::Robot;
use crate::trajectory::Limits;
pub use file::TaskTable;
pub use pose::{PoseTable, PostureParts};

/// A rest-to-rest motion of the arm that is also to turn the base.
#[derive(Debug, Clone)]
pub struct Task {
    /// The robot.
    pub robot: Arc<Robot>,
    /// Where the motion starts.
    pub start: Posture,
    /// Where it is to end.
    pub goal: Posture,
    /// What each joint may do.
    pub limits: Limits,
    /// `K_b`, the weight of the base's attitude; time weighs `K_t = 1 − K_b`.
    pub base_weight: f64,
    /// How far from its goal the base may end where the goal is a demand \[rad\]; the cost does not depend on it.
    pub goal_tolerance: f64,
}

impl Task {
    /// All that a motion's cost follows from, as JSON: [`Robot::identity`], `start` and `goal` with `joints`
    /// \[rad or m\] and `base`, a quaternion `w, x, y, z` from base axes to inertial axes, `limits` on rate,
    /// acceleration and jerk per joint, and `base_weight`.
    #[cfg(feature = "harness")]
    pub(crate) fn identity(&self) -> Value {
        json!({
            "robot": self.robot.identity(),
            "start": self.start.identity(),
            "goal": self.goal.identity(),
            "limits": self.limits.0,
            "base_weight": self.base_weight,
        })
    }

    /// What is left to do at the start, if it is nothing: the angle \[rad\], within the goal's tolerance, by which the base is off.
    pub fn already_there(&self) -> Option<f64> {
        let residual = self.start.base.angle_to(&self.goal.base);
        let is_there = self.start.joints == self.goal.joints && residual <= self.goal_tolerance;
        is_there.then_some(residual)
    }

    /// The goal's tolerance in degrees, as written, without the rounding of its way through radians.
    pub fn goal_tolerance_deg(&self) -> f64 {
        let degrees = self.goal_tolerance.to_degrees();
        format!("{degrees:.12e}").parse().unwrap_or(degrees)
    }

    /// The limit of all joints on rate, acceleration or jerk (order 0, 1, 2), in degrees; none where
    /// joints differ. As written, without the rounding of its way through radians.
    pub fn uniform_limit_deg(&self, order: usize) -> Option<f64> {
        let limit = |limits: &[f64; 3]| limits.get(order).copied();
        let first = self.limits.0.first().and_then(limit)?;
        let uniform = self.limits.0.iter().all(|limits| limit(limits) == Some(first));
        uniform.then(|| (first.to_degrees() * 1e9).round() / 1e9)
    }
}

/// Joint angles and base attitude, at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Joint angles \[rad\].
    pub joints: Vec<f64>,
    /// Turns base axes into inertial axes.
    pub base: UnitQuaternion<f64>,
}

#[cfg(feature = "harness")]
impl Posture {
    fn identity(&self) -> Value {
        let [x, y, z, w]: [f64; 4] = self.base.coords.into();
        json!({ "joints": self.joints, "base": [w, x, y, z] })
    }
}
