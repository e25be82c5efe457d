//! A motion as the page shows it: where everything is while the robot floats.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use super::best::BestMotion;
use crate::clearance::{Anchor, Solid};
use crate::exhibit::Scene;
use crate::posture::{Branches, Posture, Satellite};
use crate::reorientation::any::AnyReorientation;
use crate::reorientation::excursions::{Closest, Excursions};
use crate::reorientation::limited::{Limited, Nearest, limited, nearest};
use crate::reorientation::motion::Motion;
use crate::robot::{JointKind, MovingJoint, Robot, Shape};
use crate::task::{ClearanceLimit, Task};

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
    /// The base's shapes, where the robot's file states them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    base: Vec<ShapeScene>,
    /// The joints, from the base outward.
    joints: Vec<JointScene>,
    /// For each of the joints and, last, the tool the joint that carries it; null for the base.
    carriers: Vec<Option<usize>>,
    /// For each tip the joint that carries it.
    tip_carriers: Vec<usize>,
    /// Equally spaced in time, from start to end.
    frames: Vec<Posture>,
    /// The goal.
    goal: Posture,
    /// What has a limit on the way, in every frame.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    limited: Vec<Limited>,
    /// What the robot has to keep out of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    keep_outs: Vec<SolidScene>,
    /// Where bodies come closest that have to keep a distance.
    #[serde(skip_serializing_if = "Option::is_none")]
    closest: Option<ClosestScene>,
}

/// A solid that the robot has to keep out of.
#[derive(Debug, Clone, Serialize)]
struct SolidScene {
    name: String,
    /// Whether it stands on the base; else in inertial axes.
    on_base: bool,
    #[serde(flatten)]
    shape: ShapeScene,
}

/// A shape, in metres.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
enum ShapeScene {
    Capsule {
        ends: [[f64; 3]; 2],
        radius: f64,
    },
    /// With the directions of its edges.
    Cuboid {
        centre: [f64; 3],
        half: [f64; 3],
        axes: [[f64; 3]; 3],
    },
}

impl From<&Shape> for ShapeScene {
    fn from(shape: &Shape) -> Self {
        match shape {
            Shape::Capsule { ends, radius } => {
                Self::Capsule { ends: ends.map(Into::into), radius: *radius }
            }
            Shape::Cuboid { centre, half, rotation } => Self::Cuboid {
                centre: (*centre).into(),
                half: (*half).into(),
                axes: [Vector3::x(), Vector3::y(), Vector3::z()]
                    .map(|axis| (rotation * axis).into()),
            },
        }
    }
}

/// The closest bodies.
#[derive(Debug, Clone, Serialize)]
struct ClosestScene {
    between: [String; 2],
    /// How far they are apart \[m\], and when \[s\].
    distance: f64,
    at: f64,
    /// In every frame the two closest points, inertial axes.
    points: Vec<Nearest>,
}

/// A joint over time, in degrees or metres.
#[derive(Debug, Clone, Serialize)]
struct JointScene {
    /// Its name.
    name: String,
    /// `°` or `m`.
    unit: &'static str,
    /// Smallest and largest position.
    range: [f64; 2],
    /// Limits on its first three derivatives by time \[s\].
    limits: [f64; 3],
    /// Position and its first three derivatives in every frame.
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
        let branches = Branches::of(&task.robot);
        let satellite = Satellite::of(&task.robot);
        Self {
            frames: frames(&branches, &task.robot, motion),
            carriers: branches.carriers,
            tip_carriers: branches.tip_carriers,
            label,
            optimiser,
            seed,
            cost,
            duration: motion.time.last().copied().unwrap_or_default(),
            largest_turn: excursions.base_turn.to_degrees(),
            largest_turn_at: excursions.base_turn_at,
            base: satellite.stated.iter().map(ShapeScene::from).collect(),
            satellite,
            joints: joints(task, motion),
            goal: Posture::of(&task.robot, &task.goal.joints, task.goal.base),
            limited: limited(task, motion),
            keep_outs: keep_outs(task),
            closest: closest(excursions.closest, task, motion),
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

fn keep_outs(task: &Task) -> Vec<SolidScene> {
    let solids = task.path.clearance.iter().flat_map(ClearanceLimit::solids);
    let solid = |Solid { name, shape, anchor }: &Solid| SolidScene {
        name: name.clone(),
        on_base: *anchor == Anchor::Base,
        shape: shape.into(),
    };
    solids.map(solid).collect()
}

/// What is nearest, where the task asks for a distance.
fn closest(found: Option<Closest>, task: &Task, motion: &Motion) -> Option<ClosestScene> {
    let points = nearest(task, motion)?;
    let Closest { between, distance, at, .. } = found?;
    Some(ClosestScene { between, distance, at, points })
}

fn frames(branches: &Branches, robot: &Robot, motion: &Motion) -> Vec<Posture> {
    let frame = |(i, attitude): (usize, &UnitQuaternion<f64>)| {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        Posture::with(branches, robot, &angles, *attitude)
    };
    motion.base.iter().enumerate().map(frame).collect()
}

fn in_file_units(derivatives: &[[f64; 4]], kind: JointKind) -> Vec<[f64; 4]> {
    derivatives.iter().map(|state| state.map(|value| kind.to_file_units(value))).collect()
}

fn joints(task: &Task, motion: &Motion) -> Vec<JointScene> {
    let joint = |(i, joint): (usize, MovingJoint<'_>)| JointScene {
        name: joint.name.to_owned(),
        unit: joint.kind.symbol(),
        range: joint.range.map(|end| joint.kind.to_file_units(end)),
        limits: task.limits.0[i].map(|limit| joint.kind.to_file_units(limit)),
        states: in_file_units(&motion.joints[i].derivatives, joint.kind),
    };
    task.robot.joints().enumerate().map(joint).collect()
}
