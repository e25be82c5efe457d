//! The `[task]` table.

use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::{PoseTable, Posture, PostureParts, Task};
use crate::input::{
    Document, Finite, InputError, PerJoint, Positive, finite_array, fraction, nearest,
};
use crate::robot::Robot;
use crate::trajectory::Limits;

/// How far from its goal the base may end where a file says nothing of it.
const TOLERANCE_DEG: f64 = 0.001;

/// The `[task]` table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct TaskTable {
    robot: Spanned<String>,
    start: PostureTable,
    goal: PostureTable,
    limits: LimitsTable,
    weights: WeightsTable,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
#[expect(clippy::struct_field_names, reason = "keys of files have their units")]
struct PostureTable {
    joints_deg: Spanned<Vec<Finite>>,
    #[serde(deserialize_with = "finite_array")]
    base_zyx_deg: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tolerance_deg: Option<Spanned<Positive>>,
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
    #[serde(deserialize_with = "fraction")]
    base: f64,
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

    /// The task. A robot that does not come with the program is a file, sought beside `document`.
    pub fn build(&self, document: &Document) -> Result<Task, InputError> {
        let robot = self.robot(document)?;
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
            base_weight: self.weights.base,
            goal_tolerance: tolerance.to_radians(),
            robot: Arc::new(robot),
        })
    }
}

impl PostureTable {
    /// The same posture but for some parts.
    fn with(&self, parts: &PostureParts) -> Self {
        let Self { joints_deg, base_zyx_deg, tolerance_deg } = self;
        Self {
            joints_deg: parts.joints_deg.as_ref().unwrap_or(joints_deg).clone(),
            base_zyx_deg: parts
                .base_zyx_deg
                .map_or(*base_zyx_deg, |base| base.map(|angle| angle.0)),
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
        let [yaw, pitch, roll] = table.base_zyx_deg.map(f64::to_radians);
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
        let help = list.span().is_empty().then(|| {
            "the file leaves this to the paper's task, which is for another robot".to_owned()
        });
        Err(self.document.error_at(list.span(), message, help))
    }
}
