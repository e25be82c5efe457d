//! A motion as the page shows it: where everything is while the robot floats.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use super::best::BestMotion;
use crate::exhibit::Scene;
use crate::posture::{Posture, Satellite};
use crate::reorientation::any::AnyReorientation;
use crate::reorientation::excursions::Excursions;
use crate::reorientation::motion::Motion;
use crate::robot::{MovingJoint, Robot};
use crate::task::Task;

/// Most instances whose best motion is shown: some five megabytes of a page.
const MOST_SCENES: usize = 200;

/// Intervals between the frames of a motion, and where there are more than a few motions; the page draws what is between.
const INTERVALS: usize = 120;
const FEW: usize = 24;
const INTERVALS_OF_MANY: usize = 60;

/// The best motion of an instance.
#[derive(Debug, Clone, Serialize)]
struct MotionScene<'a> {
    /// The instance's label; empty where there is but one.
    label: &'a str,
    /// Who found it.
    optimiser: &'a str,
    /// With which seed.
    seed: u64,
    /// Its certified cost.
    cost: f64,
    /// How long it takes \[s\].
    duration: f64,
    /// How far the base turns from its attitude at the start, at most \[°\], and when \[s\].
    largest_turn: f64,
    largest_turn_at: f64,
    /// What the base looks like.
    satellite: Satellite,
    /// The joints, from the base outward.
    joints: Vec<JointScene>,
    /// Equally spaced in time, from start to end.
    frames: Vec<Posture>,
    /// The goal.
    goal: Posture,
}

/// A joint over time, in degrees.
#[derive(Debug, Clone, Serialize)]
struct JointScene {
    /// Its name.
    name: String,
    /// Smallest and largest angle \[°\].
    range: [f64; 2],
    /// Limits on rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\].
    limits: [f64; 3],
    /// Angle \[°\], rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\] in every frame.
    states: Vec<[f64; 4]>,
}

/// Who found a motion, where.
#[derive(Debug, Clone, Copy)]
pub struct FoundBy<'a> {
    /// The instance's label; empty where there is but one.
    pub label: &'a str,
    /// Who found it.
    pub optimiser: &'a str,
    /// With which seed.
    pub seed: u64,
    /// Its certified cost.
    pub cost: f64,
}

impl<'a> MotionScene<'a> {
    fn new(task: &Task, motion: &Motion, found: FoundBy<'a>) -> Self {
        let FoundBy { label, optimiser, seed, cost } = found;
        let excursions = Excursions::of(task, motion);
        Self {
            label,
            optimiser,
            seed,
            cost,
            duration: motion.time.last().copied().unwrap_or_default(),
            largest_turn: excursions.base_turn.to_degrees(),
            largest_turn_at: excursions.base_turn_at,
            satellite: Satellite::of(&task.robot),
            frames: frames(&task.robot, motion),
            joints: joints(task, motion),
            goal: Posture::of(&task.robot, &task.goal.joints, task.goal.base),
        }
    }

    fn of(best: &'a BestMotion<'_>, intervals: usize) -> Self {
        let (label, optimiser) = (&*best.instance.label, best.optimiser);
        let found = FoundBy { label, optimiser, seed: best.run.seed, cost: best.run.cost };
        Self::new(best.problem.task(), &best.sample(intervals), found)
    }
}

/// A motion of a task for a page to show.
pub fn motion_scene(
    problem: &dyn AnyReorientation,
    coefficients: &[f64],
    duration: f64,
    found: FoundBy<'_>,
) -> Option<Scene> {
    let motion = problem.sample(coefficients, duration, INTERVALS);
    Scene::new(&MotionScene::new(problem.task(), &motion, found))
}

/// The first of the best motions.
pub(super) fn scenes(best: &[BestMotion<'_>]) -> Vec<Scene> {
    let first = best.iter().take(MOST_SCENES);
    let intervals = if best.len() > FEW { INTERVALS_OF_MANY } else { INTERVALS };
    first.filter_map(|motion| Scene::new(&MotionScene::of(motion, intervals))).collect()
}

fn frames(robot: &Robot, motion: &Motion) -> Vec<Posture> {
    let frame = |(i, attitude): (usize, &UnitQuaternion<f64>)| {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        Posture::of(robot, &angles, *attitude)
    };
    motion.base.iter().enumerate().map(frame).collect()
}

fn joints(task: &Task, motion: &Motion) -> Vec<JointScene> {
    let joint = |(i, joint): (usize, MovingJoint<'_>)| JointScene {
        name: joint.name.to_owned(),
        range: joint.range.map(f64::to_degrees),
        limits: task.limits.0[i].map(f64::to_degrees),
        states: motion.joints[i].derivatives.iter().map(|s| s.map(f64::to_degrees)).collect(),
    };
    task.robot.joints().enumerate().map(joint).collect()
}
