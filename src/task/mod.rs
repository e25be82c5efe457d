//! What is to be done: from where to where, within which limits, weighed how.

mod cones;
mod drift;
mod file;
mod frame;
mod joints;
mod keep_out;
mod mission;
mod path_limits;
mod pose;
mod reader;
mod shipped;
mod tables;
mod tool_goal;
mod uncertainty;
mod way;

use std::sync::Arc;

use nalgebra::{Isometry3, Rotation3, UnitQuaternion, Vector3};
#[cfg(feature = "harness")]
use serde_json::{Value, json};

use crate::attitude::Drift;
use crate::kinematics;
use crate::robot::Robot;
use crate::trajectory::{Limits, SinePolynomial, Spline};
use crate::vec3::Vec3;
pub use file::TaskTable;
pub use frame::Frame;
pub(crate) use mission::end_of;
pub use mission::{Leg, Mission, Standing};
pub use path_limits::{ClearanceLimit, Cone, Impossible, PathLimits, TurnFrom, bodies_of};
pub use pose::{PoseTable, PostureParts};
pub use tool_goal::ToolGoal;
pub use uncertainty::{Robust, RobustOf, Uncertainty, Unknown};

/// `K_b` where a file says nothing (eq. 33).
const BASE_WEIGHT: f64 = 0.9;

/// A rest-to-rest motion of the arm that is also to turn the base.
#[derive(Debug, Clone)]
pub struct Task {
    /// The robot.
    pub robot: Arc<Robot>,
    /// Where the motion starts.
    pub start: Posture,
    /// Where it is to end.
    pub goal: Posture,
    /// Where the tool is to be then, where the task states that instead of the joints' positions.
    pub tool: Option<ToolGoal>,
    /// What each joint may do.
    pub limits: Limits,
    /// Total angular momentum about the system's centre of mass, inertial axes \[N·m·s\], where it is not zero. Then where the
    /// base ends follows from the duration, too.
    pub angular_momentum: Option<Vector3<f64>>,
    /// The motion is to last no shorter \[s\].
    pub least_duration: f64,
    /// `K_b`, the weight of the base's attitude; time weighs `K_t = 1 − K_b`.
    pub base_weight: f64,
    /// How far from its goal the base may end where the goal is a demand \[rad\]; the cost does not depend on it.
    pub goal_tolerance: f64,
    /// What the motion has to keep to on its way.
    pub path: PathLimits,
    /// What is not known exactly, where the task says so.
    pub uncertainty: Option<Uncertainty>,
    /// Whether the base is to end near its goal with sampled robots, too.
    pub robust: Option<Robust>,
}

impl Task {
    /// All that a motion's cost follows from, as JSON: [`Robot::identity`], `start` and `goal` with `joints`
    /// \[rad or m\] and `base`, a quaternion `w, x, y, z` from base axes to inertial axes, `limits` on rate,
    /// acceleration and jerk per joint, `base_weight` and, where anything is asked for on the way, `path`, or of sampled robots,
    /// `robust`; `momentum` and `least_duration` where they are not zero.
    #[cfg(feature = "harness")]
    pub(crate) fn identity(&self) -> Value {
        let mut identity = json!({
            "robot": self.robot.identity(),
            "start": self.start.identity(),
            "goal": self.goal.identity(),
            "limits": self.limits.0,
            "base_weight": self.base_weight,
        });
        if let Some(path) = self.path.identity(&self.robot) {
            identity["path"] = path;
        }
        if let Some(robust) = &self.robust {
            identity["robust"] = robust.identity();
        }
        if let Some(momentum) = &self.angular_momentum {
            identity["momentum"] = json!(momentum.as_slice());
        }
        if self.least_duration > 0.0 {
            identity["least_duration"] = json!(self.least_duration);
        }
        identity
    }

    /// All sine polynomials from start to goal, with so many terms.
    ///
    /// # Panics
    ///
    /// Panics without a term, or when start or goal are not the robot's.
    pub fn sine_polynomials(&self, terms: usize) -> SinePolynomial {
        let ranges: Vec<[f64; 2]> = self.robot.joints().map(|joint| joint.range).collect();
        let family = SinePolynomial::new(&ranges, &self.start.joints, &self.goal.joints, terms);
        family.following(self.robot.follows())
    }

    /// All splines from start to goal, over so many pieces.
    ///
    /// # Panics
    ///
    /// Panics where [`Spline::new`] does, or when start or goal are not the robot's.
    pub fn splines(&self, pieces: usize, degree: usize) -> Spline {
        let family = Spline::new(&self.start.joints, &self.goal.joints, pieces, degree);
        family.following(self.robot.follows())
    }

    /// The same task with other joint positions at its goal \[rad or m\].
    #[must_use]
    pub(crate) fn ending_with(&self, joints: &[f64]) -> Self {
        let goal = Posture { joints: joints.to_vec(), base: self.goal.base };
        Self { goal, ..self.clone() }
    }

    /// Where the tool is at the start, in inertial axes whose origin is the base's centre of mass then \[m\].
    pub fn tool_at_start(&self) -> Isometry3<f64> {
        let tool = kinematics::tool(&self.robot, &self.start.joints);
        let base = self.start.base;
        let rotation = Rotation3::from_matrix_unchecked(tool.rotation.into());
        let rotation = base * UnitQuaternion::from_rotation_matrix(&rotation);
        Isometry3::from_parts((base * Vector3::from(tool.position)).into(), rotation)
    }

    /// What turns the base besides the joints, over so many seconds from an attitude on; nothing without momentum.
    pub(crate) fn drift(&self, start: UnitQuaternion<f64>, duration: f64) -> Option<Drift> {
        self.angular_momentum.map(|momentum| Drift { momentum, start, duration })
    }

    /// The total angular momentum along base axes of this attitude \[N·m·s\].
    pub(crate) fn momentum_at(&self, attitude: &UnitQuaternion<f64>) -> Vec3<f64> {
        self.angular_momentum
            .map_or(Vec3::zero(), |momentum| Vec3::of(&(attitude.inverse() * momentum)))
    }

    /// What is left to do at the start, if it is nothing: the angle \[rad\], within the goal's tolerance, by which the base is off.
    pub fn already_there(&self) -> Option<f64> {
        let residual = self.start.base.angle_to(&self.goal.base);
        let is_there = self.start.joints == self.goal.joints
            && residual <= self.goal_tolerance
            && self.angular_momentum.is_none();
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
        (uniform && self.robot.sliding_joint().is_none())
            .then(|| (first.to_degrees() * 1e9).round() / 1e9)
    }
}

/// Joint positions and base attitude, at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Posture {
    /// Joint positions \[rad or m\].
    pub joints: Vec<f64>,
    /// Turns base axes into inertial axes.
    pub base: UnitQuaternion<f64>,
}

impl Posture {
    /// The base's centre of mass from the system's, inertial axes \[m\].
    pub(crate) fn base_position(&self, robot: &Robot) -> Vector3<f64> {
        crate::posture::Posture::of(robot, &self.joints, self.base).position.into()
    }

    #[cfg(feature = "harness")]
    fn identity(&self) -> Value {
        let [x, y, z, w]: [f64; 4] = self.base.coords.into();
        json!({ "joints": self.joints, "base": [w, x, y, z] })
    }
}
