//! What is to be done: from where to where, within which limits, weighed how.

mod file;
mod pose;

use std::sync::Arc;

use nalgebra::UnitQuaternion;
use serde::Serialize;

use crate::robot::Robot;
use crate::trajectory::Limits;
pub use file::TaskTable;
pub use pose::{PoseTable, PostureParts};

/// A rest-to-rest motion of the arm that is also to turn the base.
#[derive(Debug, Clone, Serialize)]
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
}

impl Task {
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
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Posture {
    /// Joint angles \[rad\].
    pub joints: Vec<f64>,
    /// Turns base axes into inertial axes.
    pub base: UnitQuaternion<f64>,
}
