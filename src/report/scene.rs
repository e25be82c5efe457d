//! A motion as the page shows it: where everything is while the robot floats.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use crate::analysis::Run;
use crate::experiment::Plan;
use crate::posture::{Posture, Satellite};
use crate::reorientation::{Motion, Reorientation};
use crate::robot::{Joint, Robot};

/// Most instances whose best motion is shown.
pub const MOST_SCENES: usize = 24;

/// Intervals between the frames of a motion.
const INTERVALS: usize = 120;

/// The best motion of an instance.
#[derive(Debug, Clone, Serialize)]
pub struct Scene {
    /// The instance's label; empty where there is but one.
    pub label: String,
    /// Who found it.
    pub optimiser: String,
    /// With which seed.
    pub seed: u64,
    /// Its certified cost.
    pub cost: f64,
    /// How long it takes \[s\].
    pub duration: f64,
    /// What the base looks like.
    pub satellite: Satellite,
    /// The joints, from the base outward.
    pub joints: Vec<JointScene>,
    /// Equally spaced in time, from start to end.
    pub frames: Vec<Posture>,
    /// The goal.
    pub goal: Posture,
}

/// A joint over time, in degrees.
#[derive(Debug, Clone, Serialize)]
pub struct JointScene {
    /// Its name.
    pub name: String,
    /// Smallest and largest angle \[°\].
    pub range: [f64; 2],
    /// Limits on rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\].
    pub limits: [f64; 3],
    /// Angle \[°\], rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\] in every frame.
    pub states: Vec<[f64; 4]>,
}

impl Scene {
    /// A run's best motion.
    fn of(plan: &Plan, run: &Run, problem: &Reorientation) -> Self {
        let task = problem.task();
        let motion = Motion::sample(problem, &run.coefficients, run.duration, INTERVALS);
        Self {
            label: plan.instances[run.instance].label.clone(),
            optimiser: plan.optimisers[run.optimiser].label.clone(),
            seed: run.seed,
            cost: run.cost,
            duration: run.duration,
            satellite: Satellite::of(&task.robot),
            frames: frames(&task.robot, &motion),
            joints: joints(problem, &motion),
            goal: Posture::of(&task.robot, &task.goal.joints, task.goal.base),
        }
    }
}

/// The first of an experiment's best motions: runs and their tasks.
pub fn scenes(plan: &Plan, best: &[(&Run, &Reorientation)]) -> Vec<Scene> {
    let first = best.iter().take(MOST_SCENES);
    first.map(|(run, problem)| Scene::of(plan, run, problem)).collect()
}

fn frames(robot: &Robot, motion: &Motion) -> Vec<Posture> {
    let frame = |(i, attitude): (usize, &UnitQuaternion<f64>)| {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        Posture::of(robot, &angles, *attitude)
    };
    motion.base.iter().enumerate().map(frame).collect()
}

fn joints(problem: &Reorientation, motion: &Motion) -> Vec<JointScene> {
    let task = problem.task();
    let joint = |(i, joint): (usize, &Joint)| JointScene {
        name: joint.name.clone(),
        range: joint.range.map(f64::to_degrees),
        limits: task.limits.0[i].map(f64::to_degrees),
        states: motion.joints[i].derivatives.iter().map(|s| s.map(f64::to_degrees)).collect(),
    };
    task.robot.joints.iter().enumerate().map(joint).collect()
}
