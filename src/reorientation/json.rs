//! What is known of a motion, as JSON: the fields that `plan --json` and `replay --json` share.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::Serialize;

use super::any::AnyReorientation;
use super::excursions::{Excursions, ToolEnd, Used};
use super::fitness::Assessment;
use crate::robot::{Robot, ShapeSource};
use crate::task::{Task, ToolGoal};
use crate::trajectory::Peaks;

/// Intervals in which a motion is looked at between its start and its end.
const LOOKS: usize = 2000;

impl Excursions {
    /// How far base and joints go on the way of a motion.
    pub fn on_the_way(
        problem: &dyn AnyReorientation,
        coefficients: &[f64],
        duration: f64,
    ) -> Excursions {
        Excursions::of(problem.task(), &problem.sample(coefficients, duration, LOOKS))
    }
}

/// Cost and its parts.
#[derive(Debug, Serialize)]
pub struct AssessmentJson {
    j: f64,
    t_f: f64,
    residual_deg: f64,
    /// Null where it was not estimated, or the motion is too wild to.
    residual_error_deg: Option<f64>,
    penalty: f64,
    peaks: PeaksJson,
}

/// Largest derivatives, joint by joint.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum PeaksJson {
    /// Of robots whose joints all turn.
    Degrees { rate_deg_s: Vec<f64>, acceleration_deg_s2: Vec<f64>, jerk_deg_s3: Vec<f64> },
    /// In degrees or metres, and seconds.
    ByJoint { unit: Vec<&'static str>, rate: Vec<f64>, acceleration: Vec<f64>, jerk: Vec<f64> },
}

impl PeaksJson {
    pub(super) fn new(peaks: &Peaks, robot: &Robot) -> Self {
        let all = |order: usize| -> Vec<f64> {
            let peaks = robot.joints().zip(&peaks.0);
            peaks.map(|(joint, peaks)| joint.kind.to_file_units(peaks[order].value)).collect()
        };
        if robot.sliding_joint().is_some() {
            let unit = robot.joints().map(|joint| joint.kind.file_unit()).collect();
            return Self::ByJoint { unit, rate: all(0), acceleration: all(1), jerk: all(2) };
        }
        Self::Degrees { rate_deg_s: all(0), acceleration_deg_s2: all(1), jerk_deg_s3: all(2) }
    }
}

impl AssessmentJson {
    /// Of a motion of a robot.
    pub fn new(assessment: &Assessment, robot: &Robot) -> Self {
        Self {
            j: assessment.cost,
            t_f: assessment.duration,
            residual_deg: assessment.residual().to_degrees(),
            residual_error_deg: assessment.residual_error.map(f64::to_degrees),
            penalty: assessment.penalty(),
            peaks: PeaksJson::new(&assessment.peaks, robot),
        }
    }
}

/// How far base and joints go on the way.
#[derive(Debug, Serialize)]
pub struct ExcursionsJson {
    largest_base_turn_deg: f64,
    largest_base_turn_at: f64,
    largest_base_rate_deg_s: f64,
    range_used: Vec<f64>,
    #[serde(flatten)]
    way: WayJson,
}

/// What else happens on the way, and how much of all limits is used.
#[derive(Debug, Serialize)]
pub(super) struct WayJson {
    largest_tool_speed_m_s: f64,
    /// N·m of joints that turn, N of those that slide.
    largest_torque_n_m: Vec<f64>,
    /// Null where no two bodies could meet; negative where they overlap.
    clearance_m: Option<f64>,
    clearance_between: Option<[String; 2]>,
    clearance_at: Option<f64>,
    /// Whether shapes are `stated` or `derived`.
    shapes: Option<ShapeSource>,
    /// Of every limit the share that is used by what uses most of it, null where bodies touch.
    limits_used: BTreeMap<&'static str, Option<f64>>,
    not_checked: [&'static str; 4],
    /// Of tasks that state where the tool is to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<ToolJson>,
    /// Of robots that have angular momentum.
    #[serde(skip_serializing_if = "Option::is_none")]
    drift: Option<DriftJson>,
}

/// What turns the base beside the joints.
#[derive(Debug, Serialize)]
struct DriftJson {
    /// Inertial axes \[N·m·s\].
    angular_momentum: [f64; 3],
    /// What the base keeps at the end, base axes.
    end_base_rate_deg_s: [f64; 3],
}

impl DriftJson {
    fn new(momentum: Vector3<f64>, end_rate: Vector3<f64>) -> Self {
        Self {
            angular_momentum: momentum.into(),
            end_base_rate_deg_s: end_rate.map(f64::to_degrees).into(),
        }
    }
}

/// How the tool comes to its goal.
#[derive(Debug, Serialize)]
struct ToolJson {
    position_error_m: f64,
    angle_error_deg: f64,
    /// The joints' positions at the goal, in degrees or metres.
    joints: Vec<f64>,
    /// Which of the configurations that were found that is, the nearest to the start being 1; null if it is another one.
    branch: Option<usize>,
    /// How many configurations were found that bring the tool there.
    branches: usize,
}

impl ToolJson {
    fn new(goal: &ToolGoal, end: &ToolEnd, task: &Task) -> Self {
        let joints = task.robot.joints().zip(&end.joints);
        Self {
            position_error_m: end.miss.position,
            angle_error_deg: end.miss.angle.to_degrees(),
            joints: joints.map(|(joint, at)| joint.kind.to_file_units(*at)).collect(),
            branch: goal.branch_at(&end.joints),
            branches: goal.branches.len(),
        }
    }
}

/// What no motion is checked for.
pub const NOT_CHECKED: [&str; 4] =
    ["flexibility of joints and links", "contact", "dynamics of actuators", "orbital motion"];

impl ExcursionsJson {
    /// Of a motion of a task with these peaks.
    pub fn new(excursions: &Excursions, task: &Task, peaks: &Peaks) -> Self {
        Self {
            largest_base_turn_deg: excursions.base_turn.to_degrees(),
            largest_base_turn_at: excursions.base_turn_at,
            largest_base_rate_deg_s: excursions.base_rate.to_degrees(),
            range_used: excursions.range_used(task),
            way: WayJson::new(excursions, task, peaks),
        }
    }
}

impl WayJson {
    /// Of a motion of a task with these peaks.
    pub(super) fn new(excursions: &Excursions, task: &Task, peaks: &Peaks) -> Self {
        let closest = excursions.closest.as_ref();
        let ranges = excursions.range_used(task).into_iter().fold(0.0, f64::max);
        let of_joints = [("rate", 0), ("acceleration", 1), ("jerk", 2)].map(|(limit, order)| {
            let shares = peaks.0.iter().zip(&task.limits.0);
            let shares = shares.map(|(peaks, limits)| peaks[order].value / limits[order]);
            (limit, Some(shares.fold(0.0, f64::max)))
        });
        let of_joints = of_joints.into_iter().chain([("range", Some(ranges))]);
        let tool = task.tool.as_ref().zip(excursions.tool.as_ref());
        let drift = task.angular_momentum.zip(excursions.end_rate);
        let used = |used: &Used| (used.limit.name(), used.share.is_finite().then_some(used.share));
        Self {
            largest_tool_speed_m_s: excursions.tool_speed,
            largest_torque_n_m: excursions.torques.clone(),
            clearance_m: closest.map(|closest| closest.distance),
            clearance_between: closest.map(|closest| closest.between.clone()),
            clearance_at: closest.map(|closest| closest.at),
            shapes: closest.map(|closest| closest.shapes),
            limits_used: of_joints.chain(excursions.used.iter().map(used)).collect(),
            not_checked: NOT_CHECKED,
            tool: tool.map(|(goal, end)| ToolJson::new(goal, end, task)),
            drift: drift.map(|(momentum, rate)| DriftJson::new(momentum, rate)),
        }
    }
}

/// The shape of a motion: the paper's parameters only where it has them.
#[derive(Debug, Serialize)]
pub struct ShapeJson {
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha6: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha7: Option<Vec<f64>>,
    coefficients: Vec<Vec<f64>>,
}

impl ShapeJson {
    /// Of the motion with these coefficients, which takes so long \[s\].
    pub fn new(problem: &dyn AnyReorientation, coefficients: &[f64], duration: f64) -> Self {
        let powers = problem.powers(coefficients, duration);
        let mut papers = powers.filter(|powers| powers.len() == 2).into_iter().flatten();
        Self {
            alpha6: papers.next(),
            alpha7: papers.next(),
            coefficients: problem.rows(coefficients),
        }
    }
}
