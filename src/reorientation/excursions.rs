//! How far the base and the joints go on the way.

use std::sync::Arc;

use nalgebra::Vector3;
use serde::Serialize;

use super::motion::Motion;
use super::path::{Heights, Place, Watched};
use crate::inverse_kinematics::Miss;
use crate::lanes::Width;
use crate::robot::ShapeSource;
use crate::task::{ClearanceLimit, Cone, Task, bodies_of};

/// The extremes of a motion between its start and its end. They are read off the samples of a motion and parabolas through
/// these.
#[derive(Debug, Clone, PartialEq)]
pub struct Excursions {
    /// Largest turn of the base from its attitude at the start \[rad\].
    pub base_turn: f64,
    /// When it is turned so far \[s\].
    pub base_turn_at: f64,
    /// Largest angular speed of the base \[rad/s\].
    pub base_rate: f64,
    /// Largest speed of the tool's origin in inertial axes \[m/s\].
    pub tool_speed: f64,
    /// Each joint's largest torque or force \[N·m or N\].
    pub torques: Vec<f64>,
    /// Where bodies come closest to each other; nothing of a robot without pairs of bodies that could.
    pub closest: Option<Closest>,
    /// Each joint's least and largest position \[rad\].
    pub positions: Vec<[f64; 2]>,
    /// How much of each limit on the way is used.
    pub used: Vec<Used>,
    /// How the tool comes to its goal, where the task states one.
    pub tool: Option<ToolEnd>,
    /// Angular velocity that the base keeps at the end, base axes \[rad/s\], of a robot that has angular momentum.
    pub end_rate: Option<Vector3<f64>>,
}

/// How the tool comes to its goal.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolEnd {
    /// By how much it misses its goal.
    pub miss: Miss,
    /// Where the joints are then \[rad or m\].
    pub joints: Vec<f64>,
}

/// Two bodies, or a body and what it is kept out of, where they are closest.
#[derive(Debug, Clone, PartialEq)]
pub struct Closest {
    /// What they are called.
    pub between: [String; 2],
    /// How far they are apart \[m\]; negative where they overlap.
    pub distance: f64,
    /// When \[s\].
    pub at: f64,
    /// Where their shapes come from.
    pub shapes: ShapeSource,
}

/// How much of a limit on the way a motion uses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Used {
    /// The limit.
    pub limit: PathLimit,
    /// The share; one at the limit. Infinite where bodies touch that are to keep a distance.
    pub share: f64,
    /// When most of it is used \[s\].
    pub at: f64,
}

/// A limit on what happens on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "as in `PathLimits`")]
pub enum PathLimit {
    BaseTurn,
    BaseCone,
    BaseRate,
    ToolSpeed,
    Torque,
    Clearance,
}

impl PathLimit {
    /// The name used in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::BaseTurn => "base_turn",
            Self::BaseCone => "base_cone",
            Self::BaseRate => "base_rate",
            Self::ToolSpeed => "tool_speed",
            Self::Torque => "torque",
            Self::Clearance => "clearance",
        }
    }
}

/// What is looked at, whatever the task's limits.
fn watched(task: &Task, pairs: usize) -> Vec<Watched> {
    let cones = (0..task.path.base_cones.len()).map(Watched::BaseCone);
    let joints = (0..task.robot.joint_count()).map(Watched::Torque);
    [Watched::BaseTurn, Watched::BaseRate, Watched::ToolSpeed]
        .into_iter()
        .chain(cones)
        .chain(joints)
        .chain((0..pairs).map(Watched::Clearance))
        .collect()
}

/// The samples of a motion.
pub(super) fn places(task: &Task, motion: &Motion) -> Vec<Place> {
    let place = |at: usize| {
        let joints = || motion.joints.iter().map(|joint| joint.derivatives[at]);
        let derivatives = [0, 1, 2].map(|order| joints().map(|all| all[order]).collect());
        let momentum = task.momentum_at(&motion.base[at]);
        Place::new(motion.time[at], derivatives, motion.base[at], momentum)
    };
    (0..motion.time.len()).map(place).collect()
}

impl Excursions {
    /// Those of a motion that has been sampled finely.
    pub fn of(task: &Task, motion: &Motion) -> Self {
        let (bodies, shapes) = if let Some(limit) = &task.path.clearance {
            (limit.bodies.clone(), task.robot.with_shapes().1)
        } else {
            let (bodies, shapes) = bodies_of(&task.robot, Vec::new());
            (Arc::new(bodies), shapes)
        };
        let watched = watched(task, bodies.pairs().len());
        let places = places(task, motion);
        let heights = Heights {
            task,
            bodies: Some(&bodies),
            far: f64::INFINITY,
            watched: &watched,
            places: &places,
        };
        let heights = Width::widest().run(heights);
        let count = motion.time.len();
        let highest = watched.iter().zip(&heights).map(|(watched, heights)| match watched {
            // Another pair of shapes may be the closest at the next sample, so there is no parabola.
            Watched::Clearance(_) => highest_sample(heights),
            _ => peak(count, |at| heights[at]),
        });
        let highest: Vec<(f64, f64)> = highest.collect();
        let duration = motion.time.last().copied().unwrap_or_default();
        let of = |one: Watched| {
            let index = watched.iter().position(|own| *own == one);
            index.map_or((0.0, 0.0), |index| (highest[index].0, highest[index].1 * duration))
        };
        let turn = |at: usize| motion.base[0].angle_to(&motion.base[at]);
        let (base_turn, place) = peak(count, turn);
        let positions = (0..task.robot.joint_count()).map(|joint| {
            let position = |at: usize| motion.joints[joint].derivatives[at][0];
            [-peak(count, |at| -position(at)).0, peak(count, position).0]
        });
        let mut found = Self {
            base_turn,
            base_turn_at: duration * place,
            base_rate: of(Watched::BaseRate).0,
            tool_speed: of(Watched::ToolSpeed).0,
            torques: (0..task.robot.joint_count()).map(|j| of(Watched::Torque(j)).0).collect(),
            closest: closest(task, &watched, &highest).map(|(pair, height, place)| {
                let between = bodies.names(pair).map(str::to_owned);
                Closest { between, distance: -height, at: duration * place, shapes }
            }),
            positions: positions.collect(),
            used: Vec::new(),
            tool: tool_end(task, motion),
            end_rate: end_rate(task, &places),
        };
        found.used = found.shares(task, of);
        found
    }

    /// How much of each limit is used, given the height of everything and when it is highest.
    fn shares(&self, task: &Task, of: impl Fn(Watched) -> (f64, f64)) -> Vec<Used> {
        let path = &task.path;
        let mut used = Vec::new();
        let mut tell = |limit, shares: &mut dyn Iterator<Item = (f64, f64)>| {
            let most = shares.max_by(|a, b| a.0.total_cmp(&b.0));
            used.extend(most.map(|(share, at)| Used { limit, share, at }));
        };
        let mut simple = |limit, most: Option<f64>, watched| {
            let share = |most| {
                let (height, at) = of(watched);
                (height / most, at)
            };
            tell(limit, &mut most.map(share).into_iter());
        };
        simple(PathLimit::BaseTurn, path.base_turn, Watched::BaseTurn);
        simple(PathLimit::BaseRate, path.base_rate, Watched::BaseRate);
        simple(PathLimit::ToolSpeed, path.tool_speed, Watched::ToolSpeed);
        let cone = |(k, cone): (usize, &Cone)| {
            let (height, at) = of(Watched::BaseCone(k));
            (if cone.outside { cone.angle / -height } else { height / cone.angle }, at)
        };
        tell(PathLimit::BaseCone, &mut path.base_cones.iter().enumerate().map(cone));
        let torque = |(joint, limit): (usize, &f64)| {
            let (height, at) = of(Watched::Torque(joint));
            (height / limit, at)
        };
        tell(PathLimit::Torque, &mut path.torque.iter().flatten().enumerate().map(torque));
        let clearance = path.clearance.as_ref().zip(self.closest.as_ref());
        let share = |(limit, closest): (&ClearanceLimit, &Closest)| {
            let share = if closest.distance > 0.0 {
                limit.least / closest.distance
            } else if closest.distance == 0.0 && limit.least == 0.0 {
                1.0
            } else {
                f64::INFINITY
            };
            (share, closest.at)
        };
        tell(PathLimit::Clearance, &mut clearance.map(share).into_iter());
        used
    }

    /// How far each joint goes from the middle of its range, as a share of half the range: 1 at either end.
    pub fn range_used(&self, task: &Task) -> Vec<f64> {
        let joints = task.robot.joints().zip(&self.positions);
        let used = joints.map(|(joint, [least, largest])| {
            let [lower, upper] = joint.range;
            let (middle, half) = (f64::midpoint(lower, upper), (upper - lower) / 2.0);
            (largest - middle).max(middle - least) / half
        });
        used.collect()
    }
}

fn end_rate(task: &Task, places: &[Place]) -> Option<Vector3<f64>> {
    task.angular_momentum.and_then(|_| Some(places.last()?.base_rate(task)))
}

fn tool_end(task: &Task, motion: &Motion) -> Option<ToolEnd> {
    let (goal, base) = (task.tool.as_ref()?, motion.base.last()?);
    let ends = motion.joints.iter().map(|joint| joint.derivatives.last().map(|at| at[0]));
    let joints: Vec<f64> = ends.collect::<Option<_>>()?;
    let miss = goal.miss(&task.robot, &task.goal.base, &joints, base);
    Some(ToolEnd { miss, joints })
}

/// Bodies that overlap by this share of the reach touch, as far as limits are kept.
const TOUCHING: f64 = 1e-6;

/// The pair that comes closest, its height and where; of pairs that are to keep no distance only those that overlap.
fn closest(task: &Task, watched: &[Watched], highest: &[(f64, f64)]) -> Option<(usize, f64, f64)> {
    let counts = |pair: usize, height: f64| {
        let limit = task.path.clearance.as_ref();
        limit.is_none_or(|limit| {
            height > TOUCHING * limit.reach || limit.least_of_pairs[pair] == limit.least
        })
    };
    let pairs =
        watched.iter().zip(highest).filter_map(|(watched, &(height, place))| match watched {
            Watched::Clearance(pair) if counts(*pair, height) => Some((*pair, height, place)),
            _ => None,
        });
    pairs.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The largest sample, and where it is as a share of the way.
pub(super) fn highest_sample(samples: &[f64]) -> (f64, f64) {
    let highest = samples.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let intervals = (samples.len().max(2) - 1) as f64;
    highest.map_or((f64::NEG_INFINITY, 0.0), |(at, height)| (*height, at as f64 / intervals))
}

/// The largest value, and where it is as a share of the way.
pub(super) fn peak(count: usize, value: impl Fn(usize) -> f64) -> (f64, f64) {
    let values: Vec<f64> = (0..count).map(value).collect();
    let place = (0..count).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or_default();
    let intervals = (count.max(2) - 1) as f64;
    let at = place as f64;
    let [Some(before), Some(after)] =
        [place.checked_sub(1), Some(place + 1)].map(|k| k.and_then(|k| values.get(k)))
    else {
        return (values.get(place).copied().unwrap_or_default(), at / intervals);
    };
    let (slope, bend) = ((after - before) / 2.0, before + after - 2.0 * values[place]);
    if bend < 0.0 {
        let step = -slope / bend;
        (values[place] + slope * step / 2.0, (at + step) / intervals)
    } else {
        (values[place], at / intervals)
    }
}
