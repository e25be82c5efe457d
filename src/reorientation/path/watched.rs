//! What is watched along a path, at one place of it.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clearance::Scene;
use crate::dynamics::{self, Dynamics, Quantity, State};
use crate::momentum::drifting_twist;
use crate::task::{Task, TurnFrom};
use crate::vec3::Vec3;

/// What is watched along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Watched {
    /// The turn of the base.
    BaseTurn,
    /// Where an axis of the base points: an index into [`PathLimits::base_cones`](crate::task::PathLimits).
    BaseCone(usize),
    /// The base's angular speed.
    BaseRate,
    /// The speed of the tool's origin in inertial axes.
    ToolSpeed,
    /// The torque or force of a joint.
    Torque(usize),
    /// How far two bodies are apart: a pair of [`Bodies::pairs`](crate::clearance::Bodies::pairs).
    Clearance(usize),
}

/// Limits whose excess counts once, whatever breaks them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Turn,
    Cone,
    Clearance,
    BaseRate,
    ToolSpeed,
    Torque,
}

/// All of them, in order.
pub(super) const KINDS: [Kind; 6] =
    [Kind::Turn, Kind::Cone, Kind::Clearance, Kind::BaseRate, Kind::ToolSpeed, Kind::Torque];

impl Kind {
    /// `p`, where a limit asks for a duration.
    pub(super) fn power(self) -> Option<i32> {
        match self {
            Self::BaseRate | Self::ToolSpeed => Some(1),
            Self::Torque => Some(2),
            Self::Turn | Self::Cone | Self::Clearance => None,
        }
    }
}

/// All that follows from a path at one place of it.
#[derive(Debug, Clone)]
pub(in crate::reorientation) struct Place {
    pub(super) tau: f64,
    pub(super) positions: Vec<f64>,
    /// By `τ`.
    pub(super) rates: Vec<f64>,
    pub(super) accelerations: Vec<f64>,
    pub(super) attitude: UnitQuaternion<f64>,
    /// Total angular momentum, base axes, times the duration where derivatives are by `τ`.
    pub(super) momentum: Vec3<f64>,
}

impl Place {
    /// A time with the joints' positions, rates and accelerations, the base's attitude and the total angular momentum along base
    /// axes.
    pub(in crate::reorientation) fn new(
        tau: f64,
        [positions, rates, accelerations]: [Vec<f64>; 3],
        attitude: UnitQuaternion<f64>,
        momentum: Vec3<f64>,
    ) -> Self {
        Self { tau, positions, rates, accelerations, attitude, momentum }
    }

    fn state(&self) -> State<'_, f64> {
        let Self { positions, rates, accelerations, momentum, .. } = self;
        State { positions, rates, accelerations, angular_momentum: *momentum }
    }

    fn quantity(&self, task: &Task, quantity: Quantity) -> f64 {
        Dynamics::new(&task.robot).value(&task.robot, quantity, self.state())
    }

    fn scene<'a>(&self, task: &'a Task) -> Option<Scene<'a>> {
        let limit = task.path.clearance.as_ref()?;
        Some(limit.bodies.at(&self.positions, self.attitude.into()))
    }

    /// The base's angular velocity by `τ`, base axes.
    pub(in crate::reorientation) fn base_rate(&self, task: &Task) -> Vector3<f64> {
        let Self { positions, rates, momentum, .. } = self;
        Vector3::from(drifting_twist(&task.robot, positions, rates, *momentum).angular)
    }
}

impl Watched {
    /// What a task asks to be watched.
    pub(super) fn all(task: &Task) -> Vec<Self> {
        let path = &task.path;
        let is_turn_watched = path.base_turn.is_some() || path.turn_weights != [0.0; 2];
        let mut all: Vec<Self> = is_turn_watched.then_some(Self::BaseTurn).into_iter().collect();
        all.extend((0..path.base_cones.len()).map(Self::BaseCone));
        all.extend(path.base_rate.map(|_| Self::BaseRate));
        all.extend(path.tool_speed.map(|_| Self::ToolSpeed));
        all.extend((0..path.torque.as_ref().map_or(0, Vec::len)).map(Self::Torque));
        let pairs = path.clearance.as_ref().map_or(0, |limit| limit.bodies.pairs().len());
        all.extend((0..pairs).map(Self::Clearance));
        all
    }

    /// How much of it there is at a place; where less is worse, with the other sign.
    pub(super) fn height(self, task: &Task, place: &Place) -> f64 {
        match self {
            Self::BaseTurn => task.path.turn_at(task, &place.attitude),
            Self::BaseCone(k) => {
                let cone = &task.path.base_cones[k];
                let angle = cone.angle_at(&place.attitude);
                if cone.outside { -angle } else { angle }
            }
            Self::BaseRate => place.base_rate(task).norm(),
            Self::ToolSpeed => place.quantity(task, Quantity::ToolSpeed),
            Self::Torque(joint) => place.quantity(task, Quantity::Torque(joint)).abs(),
            Self::Clearance(pair) => {
                place.scene(task).map_or(f64::NEG_INFINITY, |scene| -scene.distance(pair))
            }
        }
    }

    /// How many orders of the joints' derivatives its height and its slopes follow, from zero on.
    pub(super) fn orders(self) -> usize {
        match self {
            Self::BaseCone(_) | Self::Clearance(_) => 1,
            // Where start and goal are equally near, its slopes follow the base's rate.
            Self::BaseTurn | Self::BaseRate | Self::ToolSpeed => 2,
            Self::Torque(_) => 3,
        }
    }

    /// Whether its height follows the base's attitude.
    pub(super) fn follows_attitude(self, task: &Task) -> bool {
        let has_inertial =
            || task.path.clearance.as_ref().is_some_and(|limit| limit.bodies.needs_attitude());
        match self {
            Self::BaseTurn | Self::BaseCone(_) => true,
            Self::BaseRate | Self::ToolSpeed | Self::Torque(_) => false,
            Self::Clearance(_) => has_inertial(),
        }
    }

    /// What there is so much of, from its height: the angle of a cone and a distance are lower the worse.
    pub(super) fn value(self, task: &Task, height: f64) -> f64 {
        match self {
            Self::BaseCone(k) if task.path.base_cones[k].outside => -height,
            Self::Clearance(_) => -height,
            _ => height,
        }
    }

    pub(super) fn kind(self) -> Kind {
        match self {
            Self::BaseTurn => Kind::Turn,
            Self::BaseCone(_) => Kind::Cone,
            Self::Clearance(_) => Kind::Clearance,
            Self::BaseRate => Kind::BaseRate,
            Self::ToolSpeed => Kind::ToolSpeed,
            Self::Torque(_) => Kind::Torque,
        }
    }

    /// The duration \[s\] that its limit asks for where there is so much of it, or else the excess; how fast that grows.
    pub(super) fn demand(self, task: &Task, height: f64) -> Option<[f64; 2]> {
        let path = &task.path;
        let share = |limit: f64, offset: f64| Some([height / limit + offset, 1.0 / limit]);
        match self {
            Self::BaseTurn => share(path.base_turn?, -1.0),
            Self::BaseCone(k) => {
                let cone = &path.base_cones[k];
                share(cone.angle, if cone.outside { 1.0 } else { -1.0 })
            }
            Self::BaseRate => share(path.base_rate?, 0.0),
            Self::ToolSpeed => share(path.tool_speed?, 0.0),
            Self::Torque(joint) => {
                let limit = path.torque.as_ref()?[joint];
                let asked = (height / limit).sqrt();
                Some([asked, if asked > 0.0 { 0.5 / (asked * limit) } else { 0.0 }])
            }
            Self::Clearance(pair) => {
                let limit = path.clearance.as_ref()?;
                share(limit.reach, limit.least_of_pairs[pair] / limit.reach)
            }
        }
    }
}

/// How a height follows the joints and the base's attitude at its place.
#[derive(Debug, Clone, Default)]
pub(super) struct Slopes {
    /// By positions, rates and accelerations, joint by joint; empty where it does not follow them.
    pub(super) by_joints: [Vec<f64>; 3],
    /// By a turn of the base about base axes.
    pub(super) by_turn: Vector3<f64>,
}

impl Slopes {
    /// Of the magnitude of a quantity.
    fn of(task: &Task, quantity: Quantity, place: &Place) -> Self {
        let found = dynamics::Slopes::of(&task.robot, quantity, place.state());
        let dynamics::Slopes { value, by_position, by_rate, by_acceleration } = found;
        let signed = |slopes: Vec<f64>| slopes.into_iter().map(|s| s * value.signum()).collect();
        Self { by_joints: [by_position, by_rate, by_acceleration].map(signed), ..Self::default() }
    }

    fn by_turn(by_turn: Vector3<f64>) -> Self {
        Self { by_turn, ..Self::default() }
    }

    /// The height's derivative along the path, where it follows positions and the base's attitude alone.
    pub(super) fn along(&self, task: &Task, place: &Place) -> f64 {
        let [by_position, ..] = &self.by_joints;
        let by_joints: f64 = by_position.iter().zip(&place.rates).map(|(s, rate)| s * rate).sum();
        if self.turns() { by_joints + self.by_turn.dot(&place.base_rate(task)) } else { by_joints }
    }

    /// The mean with others, which have this share.
    pub(super) fn mean(&self, other: &Self, share: f64) -> Self {
        let mean = |own: &Vec<f64>, other: &Vec<f64>| {
            own.iter().zip(other).map(|(own, other)| own + share * (other - own)).collect()
        };
        Self {
            by_joints: std::array::from_fn(|k| mean(&self.by_joints[k], &other.by_joints[k])),
            by_turn: self.by_turn.lerp(&other.by_turn, share),
        }
    }

    /// Whether the height follows the base's attitude.
    pub(super) fn turns(&self) -> bool {
        self.by_turn != Vector3::zeros()
    }
}

/// Turns whose difference is no larger are the same \[rad\].
const SAME: f64 = 1e-6;

impl Watched {
    /// How its height follows from what there is at a place.
    pub(super) fn slopes(self, task: &Task, place: &Place) -> Slopes {
        match self {
            Self::BaseTurn => Slopes::by_turn(Self::turn_slopes(task, place)),
            Self::BaseCone(k) => {
                let cone = &task.path.base_cones[k];
                // cos α = f · R a, and R a changes by R (ρ × a).
                let from = place.attitude.inverse() * *cone.from;
                let across = from.cross(&cone.axis).try_normalize(0.0).unwrap_or_default();
                Slopes::by_turn(if cone.outside { -across } else { across })
            }
            Self::BaseRate => Slopes::of(task, Quantity::BaseRate, place),
            Self::ToolSpeed => Slopes::of(task, Quantity::ToolSpeed, place),
            Self::Torque(joint) => Slopes::of(task, Quantity::Torque(joint), place),
            Self::Clearance(pair) => {
                let Some(scene) = place.scene(task) else { return Slopes::default() };
                let found = scene.slopes(&scene.clearance(pair));
                let by_position = found.positions.iter().map(|slope| -slope).collect();
                Slopes {
                    by_joints: [by_position, Vec::new(), Vec::new()],
                    by_turn: -Vector3::from(found.rotation),
                }
            }
        }
    }

    /// The derivative of the base's turn by a further one about base axes.
    pub(super) fn turn_slopes(task: &Task, place: &Place) -> Vector3<f64> {
        let [(from_start, start), (from_goal, goal)] = [&task.start, &task.goal].map(|from| {
            let turn = (from.base.inverse() * place.attitude).scaled_axis();
            (turn.norm(), turn.try_normalize(0.0).unwrap_or_default())
        });
        match task.path.turn_from {
            TurnFrom::Start => start,
            TurnFrom::Goal => goal,
            TurnFrom::Nearer => {
                let rate = place.base_rate(task);
                let (rising, falling) = (start.dot(&rate), goal.dot(&rate));
                if (from_start - from_goal).abs() < SAME && rising * falling < 0.0 {
                    // The peak is where both are the same, and moves along the path as one of them changes.
                    (goal * rising - start * falling) / (rising - falling)
                } else if from_start < from_goal {
                    start
                } else {
                    goal
                }
            }
        }
    }
}
