//! Limits and wishes for the way between start and goal.

use std::sync::Arc;

use nalgebra::{Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::Task;
use crate::clearance::{Anchor, Bodies, Owner, Solid};
use crate::robot::{Robot, Shape, ShapeSource};
use crate::so3::Quat;

/// Start and goal may break a limit by so much \[rad\].
const ROUNDING: f64 = 1e-9;

/// What a motion has to keep to on its way, beside the joints' limits. Nothing at all by default.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathLimits {
    /// The largest turn of the base \[rad\].
    pub base_turn: Option<f64>,
    /// What turns of the base are measured from.
    pub turn_from: TurnFrom,
    /// Where axes of the base may point.
    pub base_cones: Vec<Cone>,
    /// The largest angular speed of the base \[rad/s\].
    pub base_rate: Option<f64>,
    /// The largest speed of the tool's origin in inertial axes \[m/s\].
    pub tool_speed: Option<f64>,
    /// The largest torque or force of each joint \[N·m or N\].
    pub torque: Option<Vec<f64>>,
    /// How far bodies of the robot are to stay from each other and from all that is kept out of.
    pub clearance: Option<ClearanceLimit>,
    /// What a degree of the largest and of the mean turn on the way adds to the cost.
    pub turn_weights: [f64; 2],
}

/// How far bodies have to stay apart.
#[derive(Debug, Clone)]
pub struct ClearanceLimit {
    /// The least distance \[m\].
    pub least: f64,
    /// That of each pair of bodies: nothing where these can never be twice as far apart nor a quarter of the reach, as links on
    /// either side of a wrist, which then only must not overlap.
    pub least_of_pairs: Vec<f64>,
    /// The bodies, and what they are to be kept out of.
    pub bodies: Arc<Bodies>,
    /// What distances are shares of where they are penalised: how far the arm reaches \[m\].
    pub reach: f64,
    solids: Vec<Solid>,
    /// How far each pair can be apart \[m\].
    farthest: Arc<[f64]>,
}

impl PartialEq for ClearanceLimit {
    /// Bodies are the robot's.
    fn eq(&self, other: &Self) -> bool {
        (self.least, &self.solids) == (other.least, &other.solids)
    }
}

/// The bodies of a robot, with derived shapes where it states none, and of solids.
pub fn bodies_of(robot: &Robot, solids: Vec<Solid>) -> (Bodies, ShapeSource) {
    let (robot, source) = robot.with_shapes();
    let owner = |link: Option<usize>| link.map_or(Owner::Base, Owner::Link);
    let ignored: Vec<_> = robot.ignored_pairs().iter().map(|pair| pair.map(owner)).collect();
    (Bodies::new(&robot, solids, &ignored), source)
}

impl ClearanceLimit {
    /// For a robot and what it is to be kept out of.
    pub fn new(robot: &Robot, solids: Vec<Solid>, least: f64) -> Self {
        let bodies = Arc::new(bodies_of(robot, solids.clone()).0);
        let farthest: Arc<[f64]> = bodies.farthest().into();
        let reach = robot.reach();
        let least_of_pairs = least_of_pairs(&farthest, least, reach);
        Self { least, least_of_pairs, bodies, reach, solids, farthest }
    }

    /// The solids, by name.
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The same with another least distance \[m\].
    #[must_use]
    pub fn with_least(&self, least: f64) -> Self {
        let least_of_pairs = least_of_pairs(&self.farthest, least, self.reach);
        Self { least, least_of_pairs, ..self.clone() }
    }

    /// By how much a pair is nearer than it is to be \[m\], at such a distance.
    pub fn lack(&self, pair: usize, distance: f64) -> f64 {
        self.least_of_pairs[pair] - distance
    }

    fn identity(&self, robot: &Robot) -> Value {
        let (robot, _) = robot.with_shapes();
        let vector = |v: &Vector3<f64>| <[f64; 3]>::from(*v);
        let solid = |solid: &Solid| {
            let shape = match &solid.shape {
                Shape::Capsule { ends, radius } => {
                    json!({ "ends": ends.each_ref().map(vector), "radius": radius })
                }
                Shape::Cuboid { centre, half, rotation } => json!({
                    "centre": vector(centre),
                    "half": vector(half),
                    "rotation": rotation.matrix().transpose().as_slice(),
                }),
            };
            json!({ "shape": shape, "on_base": solid.anchor == Anchor::Base })
        };
        json!({
            "least": self.least,
            "robot": robot.shapes_identity(),
            "solids": self.solids.iter().map(solid).collect::<Vec<_>>(),
        })
    }
}

/// Bodies that can be farther apart than this share of the reach are not near each other by design.
const NEAR: f64 = 0.25;

/// What pairs are to keep that can be so far apart at most, of a robot with this reach \[m\].
fn least_of_pairs(farthest: &[f64], least: f64, reach: f64) -> Vec<f64> {
    let together = f64::min(2.0 * least, NEAR * reach);
    farthest.iter().map(|farthest| if *farthest < together { 0.0 } else { least }).collect()
}

/// The attitude that turns of the base on the way are measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TurnFrom {
    /// That at the start.
    Start,
    /// That of the goal.
    Goal,
    /// Start or goal, whichever is nearer.
    #[default]
    Nearer,
}

/// A cone that an axis of the base has to stay in, or out of.
#[derive(Debug, Clone, PartialEq)]
pub struct Cone {
    /// The base's axis, in base axes.
    pub axis: Unit<Vector3<f64>>,
    /// The cone's axis, in inertial axes.
    pub from: Unit<Vector3<f64>>,
    /// Half the opening angle \[rad\].
    pub angle: f64,
    /// Whether the axis has to stay out of the cone.
    pub outside: bool,
}

impl TurnFrom {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Goal => "goal",
            Self::Nearer => "nearer",
        }
    }
}

impl Cone {
    /// The angle between the two axes \[rad\] at an attitude of the base.
    pub fn angle_at(&self, base: &UnitQuaternion<f64>) -> f64 {
        let pointing = base * self.axis;
        pointing.cross(&self.from).norm().atan2(pointing.dot(&self.from))
    }

    /// By how much the axis is outside of where it may be, as a share of the cone's angle; negative where it may be.
    pub fn excess_at(&self, base: &UnitQuaternion<f64>) -> f64 {
        let off = (self.angle_at(base) - self.angle) / self.angle;
        if self.outside { -off } else { off }
    }
}

impl PathLimits {
    /// Whether nothing is asked for.
    pub fn is_empty(&self) -> bool {
        *self == Self { turn_from: self.turn_from, ..Self::default() }
    }

    /// By how much the base is turned \[rad\] from what turns are measured from.
    pub fn turn_at(&self, task: &Task, base: &UnitQuaternion<f64>) -> f64 {
        let [start, goal] = [&task.start, &task.goal].map(|posture| posture.base.angle_to(base));
        match self.turn_from {
            TurnFrom::Start => start,
            TurnFrom::Goal => goal,
            TurnFrom::Nearer => start.min(goal),
        }
    }

    /// All that a cost follows from, as JSON; nothing where nothing is asked for.
    pub(crate) fn identity(&self, robot: &Robot) -> Option<Value> {
        if self.is_empty() {
            return None;
        }
        let mut all = Map::new();
        let mut tell = |key: &str, value: Option<Value>| {
            value.and_then(|value| all.insert(key.to_owned(), value));
        };
        let turns = self.base_turn.is_some() || self.turn_weights != [0.0; 2];
        tell("base_turn", self.base_turn.map(Value::from));
        tell("turn_from", turns.then(|| self.turn_from.name().into()));
        let cone = |cone: &Cone| {
            let [axis, from] = [cone.axis, cone.from].map(|axis| <[f64; 3]>::from(*axis));
            json!({ "axis": axis, "from": from, "angle": cone.angle, "outside": cone.outside })
        };
        let cones: Vec<Value> = self.base_cones.iter().map(cone).collect();
        tell("base_cones", (!cones.is_empty()).then(|| cones.into()));
        tell("base_rate", self.base_rate.map(Value::from));
        tell("tool_speed", self.tool_speed.map(Value::from));
        tell("torque", self.torque.as_ref().map(|torque| json!(torque)));
        tell("clearance", self.clearance.as_ref().map(|clearance| clearance.identity(robot)));
        let weighed = self.turn_weights != [0.0; 2];
        tell("turn_weights", weighed.then(|| json!(self.turn_weights)));
        Some(all.into())
    }
}

/// A limit that no motion keeps.
#[derive(Debug, Clone, PartialEq)]
pub struct Impossible {
    /// Its key in `[task.limits]`.
    pub key: &'static str,
    /// Why not, in a sentence without a full stop.
    pub reason: String,
}

impl Task {
    /// A limit on the base's turn that every motion from start to goal breaks: on the way the base is somewhere as far from the one as
    /// from the other.
    pub fn impossible_turn(&self) -> Option<Impossible> {
        let limit = self.path.base_turn.filter(|_| self.path.turn_from == TurnFrom::Nearer)?;
        let least = self.start.base.angle_to(&self.goal.base) / 2.0;
        let [told, allowed] = [least, limit].map(f64::to_degrees);
        let reason = format!(
            "on its way from start to goal the base is turned by {told:.3}° or more from either, and `base_turn_deg` allows {allowed:.3}°"
        );
        (least > limit + ROUNDING).then_some(Impossible { key: "base_turn_deg", reason })
    }

    /// The first limit that start or goal break already.
    pub fn impossible(&self) -> Option<Impossible> {
        let ends = [("start", &self.start), ("goal", &self.goal)];
        if let Some(limit) = self.path.base_turn {
            for (name, posture) in ends {
                let turn = self.path.turn_at(self, &posture.base);
                if turn > limit + ROUNDING {
                    let (turn, limit) = (turn.to_degrees(), limit.to_degrees());
                    let reason = format!(
                        "at the {name} the base is turned by {turn:.3}° from the {}, and `base_turn_deg` allows {limit:.3}°",
                        self.path.turn_from.name()
                    );
                    return Some(Impossible { key: "base_turn_deg", reason });
                }
            }
        }
        for cone in &self.path.base_cones {
            for (name, posture) in ends {
                if cone.excess_at(&posture.base) > ROUNDING {
                    let [found, limit] =
                        [cone.angle_at(&posture.base), cone.angle].map(f64::to_degrees);
                    let (side, bound) =
                        if cone.outside { ("less", "least") } else { ("more", "most") };
                    let reason = format!(
                        "at the {name} the axis is {found:.3}° from the cone's, {side} than the {limit:.3}° that it is to be at {bound}"
                    );
                    return Some(Impossible { key: "base_cone", reason });
                }
            }
        }
        if let Some(limit) = &self.path.clearance {
            for (name, posture) in ends {
                let attitude = Quat::from(posture.base);
                let scene = limit.bodies.at(&posture.joints, attitude);
                let lacks = scene.distances().into_iter().enumerate();
                let lacks =
                    lacks.map(|(pair, distance)| (pair, distance, limit.lack(pair, distance)));
                let worst = lacks.max_by(|a, b| a.2.total_cmp(&b.2));
                if let Some((pair, distance, _)) = worst.filter(|(.., lack)| *lack > ROUNDING) {
                    let [one, other] = limit.bodies.names(pair);
                    let place = if distance < 0.0 {
                        format!("overlap by {:.4} m", -distance)
                    } else {
                        format!("are {distance:.4} m apart")
                    };
                    let reason = format!(
                        "at the {name} `{one}` and `{other}` {place}, and `clearance_m` asks for {} m",
                        limit.least
                    );
                    return Some(Impossible { key: "clearance_m", reason });
                }
            }
        }
        None
    }
}
