//! The `[task]` table.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::{PoseTable, Posture, PostureParts, Task};
use crate::input::{Document, Finite, Fraction, InputError, PerJoint, Positive, nearest};
use crate::robot::Robot;
use crate::trajectory::Limits;

/// The key of the base's weight.
const WEIGHT: &str = "weights.base";

/// How far from its goal the base may end where a file says nothing of it.
const TOLERANCE_DEG: f64 = 0.001;

/// The robot of the paper's task, whose values a file need not state.
const PAPERS_ROBOT: &str = "xiao2023";

/// The `[task]` table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TaskTable {
    robot: Spanned<String>,
    start: PostureTable,
    goal: PostureTable,
    limits: LimitsTable,
    weights: WeightsTable,
    /// Limits on rate, acceleration and jerk that a sweep states.
    #[serde(skip)]
    swept: [bool; 3],
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct PostureTable {
    joints_deg: Spanned<Vec<Finite>>,
    base_zyx_deg: Spanned<[Finite; 3]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tolerance_deg: Option<Spanned<Positive>>,
    /// Whether a pose states the joints' angles, and the base's attitude.
    #[serde(skip)]
    posed: [bool; 2],
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct LimitsTable {
    rate_deg_s: Spanned<PerJoint>,
    acceleration_deg_s2: Spanned<PerJoint>,
    jerk_deg_s3: Spanned<PerJoint>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct WeightsTable {
    base: Spanned<Fraction>,
}

impl TaskTable {
    /// The robot's file, unless it comes with the program.
    pub fn robot_file(&self, document: &Document) -> Option<PathBuf> {
        let name = self.robot.get_ref();
        Robot::embedded(name).is_none().then(|| document.resolve(name))
    }

    /// The same task with another start or goal.
    #[must_use]
    pub fn with_pose(&self, pose: &PoseTable) -> Self {
        Self {
            start: self.start.with(&pose.start),
            goal: self.goal.with(&pose.goal),
            ..self.clone()
        }
    }

    /// The same with the goal's tolerance written out.
    #[must_use]
    pub fn resolved(mut self) -> Self {
        let default = || Spanned::new(0..0, Positive(TOLERANCE_DEG));
        self.goal.tolerance_deg.get_or_insert_with(default);
        self
    }

    /// The robot, read from its file unless it comes with the program.
    pub fn robot(&self, document: &Document) -> Result<Robot, InputError> {
        find_robot(&self.robot, document)
    }

    /// The same task with another robot.
    #[must_use]
    pub fn with_robot(self, robot: Spanned<String>) -> Self {
        Self { robot, ..self }
    }

    /// The same task where a sweep states these limits on rate, acceleration and jerk.
    #[must_use]
    pub fn with_swept_limits(self, swept: [bool; 3]) -> Self {
        Self { swept, ..self }
    }

    /// The keys that the file leaves to the paper's task.
    pub fn inherited(&self) -> Vec<&'static str> {
        let is_stated = |span: Range<usize>, elsewhere: bool| !span.is_empty() || elsewhere;
        let Self { start, goal, limits, weights, swept, .. } = self;
        let keys = [
            ("start.joints_deg", is_stated(start.joints_deg.span(), start.posed[0])),
            ("start.base_zyx_deg", is_stated(start.base_zyx_deg.span(), start.posed[1])),
            ("goal.joints_deg", is_stated(goal.joints_deg.span(), goal.posed[0])),
            ("goal.base_zyx_deg", is_stated(goal.base_zyx_deg.span(), goal.posed[1])),
            ("limits.rate_deg_s", is_stated(limits.rate_deg_s.span(), swept[0])),
            ("limits.acceleration_deg_s2", is_stated(limits.acceleration_deg_s2.span(), swept[1])),
            ("limits.jerk_deg_s3", is_stated(limits.jerk_deg_s3.span(), swept[2])),
            (WEIGHT, is_stated(weights.base.span(), false)),
        ];
        keys.into_iter().filter(|(_, is_stated)| !is_stated).map(|(key, _)| key).collect()
    }

    /// Whether nothing is left to the paper's task that is for another robot. A weight is for all.
    fn check_stated(&self, document: &Document) -> Result<(), InputError> {
        let mut missing = self.inherited();
        missing.retain(|key| *key != WEIGHT);
        if missing.is_empty() || self.robot.get_ref() == PAPERS_ROBOT {
            return Ok(());
        }
        let keys: Vec<String> = missing.iter().map(|key| format!("`{key}`")).collect();
        let message = format!(
            "the task does not state {}, which this robot has no defaults for",
            keys.join(", ")
        );
        let help = "the defaults are those of the paper's task and robot".to_owned();
        Err(document.error_at(self.robot.span(), message, Some(help)))
    }

    /// The task. A robot that does not come with the program is a file, sought beside `document`.
    pub fn build(&self, document: &Document) -> Result<Task, InputError> {
        let robot = self.robot(document)?;
        self.check_stated(document)?;
        let reader = Reader { document, robot: &robot };
        let [rate, acceleration, jerk] = [
            reader.limit(&self.limits.rate_deg_s)?,
            reader.limit(&self.limits.acceleration_deg_s2)?,
            reader.limit(&self.limits.jerk_deg_s3)?,
        ];
        if let Some(tolerance) = &self.start.tolerance_deg {
            let message = "found `tolerance_deg`, which is for the goal alone";
            return Err(document.error_at(tolerance.span(), message, None));
        }
        let tolerance = self.goal.tolerance_deg.as_ref().map_or(TOLERANCE_DEG, |t| t.get_ref().0);
        let limits = (0..robot.joint_count()).map(|i| [rate[i], acceleration[i], jerk[i]]);
        Ok(Task {
            start: reader.posture(&self.start)?,
            goal: reader.posture(&self.goal)?,
            limits: Limits(limits.collect()),
            base_weight: self.weights.base.get_ref().0,
            goal_tolerance: tolerance.to_radians(),
            robot: Arc::new(robot),
        })
    }
}

impl PostureTable {
    /// The same posture but for some parts.
    fn with(&self, parts: &PostureParts) -> Self {
        let Self { joints_deg, base_zyx_deg, tolerance_deg, posed } = self;
        let base = parts.base_zyx_deg.map(|base| Spanned::new(0..0, base));
        Self {
            joints_deg: parts.joints_deg.as_ref().unwrap_or(joints_deg).clone(),
            posed: [posed[0] || parts.joints_deg.is_some(), posed[1] || base.is_some()],
            base_zyx_deg: base.unwrap_or_else(|| base_zyx_deg.clone()),
            tolerance_deg: tolerance_deg.clone(),
        }
    }
}

fn find_robot(name: &Spanned<String>, document: &Document) -> Result<Robot, InputError> {
    let known = name.get_ref();
    if let Some(embedded) = Robot::embedded(known) {
        return Robot::from_document(&embedded);
    }
    let path = document.resolve(known);
    if path.exists() {
        return Robot::from_document(&Document::read(&path)?);
    }
    let message = format!(
        "no robot `{known}`: neither one that comes with the program nor a file at {}",
        path.display()
    );
    let help = nearest(known, Robot::embedded_names()).map(|n| format!("did you mean `{n}`?"));
    Err(document.error_at(name.span(), message, help))
}

/// Reads what is listed joint by joint, in degrees, into radians.
struct Reader<'a> {
    document: &'a Document,
    robot: &'a Robot,
}

impl Reader<'_> {
    fn posture(&self, table: &PostureTable) -> Result<Posture, InputError> {
        let angles = table.joints_deg.get_ref();
        self.check_length(&table.joints_deg, angles.len())?;
        for (joint, Finite(angle)) in self.robot.joints().zip(angles) {
            let [lower, upper] = joint.range.map(f64::to_degrees);
            // A hair's breadth for the rounding of degrees to radians and back.
            if !(lower - 1e-9..=upper + 1e-9).contains(angle) {
                let message =
                    format!("{angle}° is out of the range {lower}° to {upper}° of {}", joint.name);
                return Err(self.document.error_at(table.joints_deg.span(), message, None));
            }
        }
        let [yaw, pitch, roll] = table.base_zyx_deg.get_ref().map(|angle| angle.0.to_radians());
        Ok(Posture {
            joints: angles.iter().map(|a| a.0.to_radians()).collect(),
            base: UnitQuaternion::from_euler_angles(roll, pitch, yaw),
        })
    }

    fn limit(&self, limit: &Spanned<PerJoint>) -> Result<Vec<f64>, InputError> {
        let values = match limit.get_ref() {
            PerJoint::All(value) => vec![*value; self.robot.joint_count()],
            PerJoint::Each(values) => values.clone(),
        };
        self.check_length(limit, values.len())?;
        Ok(values.into_iter().map(f64::to_radians).collect())
    }

    fn check_length<T>(&self, list: &Spanned<T>, found: usize) -> Result<(), InputError> {
        let expected = self.robot.joint_count();
        if found == expected {
            return Ok(());
        }
        let message = format!(
            "found {found} values, expected {expected}, one for each joint of robot `{}`",
            self.robot.name()
        );
        Err(self.document.error_at(list.span(), message, None))
    }
}
