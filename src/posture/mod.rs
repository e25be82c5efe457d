//! Where a floating robot is, link by link.

mod satellite;

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

pub use satellite::{BaseBox, Satellite, SolarPanel};

use crate::kinematics::{Outward, tool};
use crate::robot::Robot;
use crate::vec3::Vec3;

/// Where everything is at one time. Inertial axes have their origin at the system's centre of mass, which
/// nothing moves as long as no force acts from outside.
#[derive(Debug, Clone, Serialize)]
pub struct Posture {
    /// The base's centre of mass, inertial axes \[m\].
    pub position: [f64; 3],
    /// Turns base axes into inertial axes: scalar, then vector.
    pub attitude: [f64; 4],
    /// The joints that move and, last, the tool, base axes \[m\].
    pub origins: Vec<[f64; 3]>,
    /// Where branches end that do not hold the tool, base axes \[m\].
    pub tips: Vec<[f64; 3]>,
    /// The joints' axes and, last, the tool's third, base axes.
    pub axes: Vec<[f64; 3]>,
    /// The tool's first axis, base axes.
    pub jaw: [f64; 3],
}

impl Posture {
    /// For joint positions \[rad or m\] and the base's attitude, base axes into inertial axes.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    pub fn of(robot: &Robot, positions: &[f64], attitude: UnitQuaternion<f64>) -> Self {
        Self::with(&Branches::of(robot), robot, positions, attitude)
    }

    /// The same where the robot's branches are known.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    pub fn with(
        branches: &Branches,
        robot: &Robot,
        positions: &[f64],
        attitude: UnitQuaternion<f64>,
    ) -> Self {
        let (mut origins, mut axes) = (Vec::new(), Vec::new());
        let mut moment = Vector3::zeros();
        let mut frames = Vec::with_capacity(robot.links().len());
        for link in Outward::<_>::new(robot, positions) {
            frames.push(link.frame);
            moment += Vector3::from(link.centre_of_mass) * link.link.body.mass;
            if link.link.joint.axis().is_some() {
                origins.push(Vector3::from(link.frame.position).into());
                axes.push(Vector3::from(link.axis).into());
            }
        }
        let tip = |End { link, place }: &End| {
            let frame = &frames[*link];
            Vector3::from(frame.position + frame.rotation * Vec3::of(place)).into()
        };
        let tips = branches.ends.iter().map(tip).collect();
        let tool = tool(robot, positions);
        let [jaw, _, approach] = tool.rotation.0.map(|axis| Vector3::from(axis).into());
        origins.push(Vector3::from(tool.position).into());
        axes.push(approach);
        let [x, y, z, w] = attitude.coords.into();
        let position = attitude * -moment / robot.total_mass();
        Self { position: position.into(), attitude: [w, x, y, z], origins, tips, axes, jaw }
    }
}

/// What carries what, for drawing a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Branches {
    /// For each of the joints that move and, last, the tool the joint that carries it; `None` for the base.
    pub carriers: Vec<Option<usize>>,
    /// For each tip the joint that carries it.
    pub tip_carriers: Vec<usize>,
    ends: Vec<End>,
}

/// Where a branch ends.
#[derive(Debug, Clone, PartialEq)]
struct End {
    link: usize,
    /// In the link's frame \[m\].
    place: Vector3<f64>,
}

impl Branches {
    /// Those of a robot.
    pub fn of(robot: &Robot) -> Self {
        // For every link, the last joint that moves between the base and it, that joint's own link included.
        let mut last: Vec<Option<usize>> = Vec::new();
        let mut carriers = Vec::new();
        for link in robot.links() {
            let carrier = link.parent.and_then(|parent| last[parent]);
            last.push(if link.joint.axis().is_some() {
                carriers.push(carrier);
                Some(carriers.len() - 1)
            } else {
                carrier
            });
        }
        carriers.push(robot.tool().link.and_then(|link| last[link]));
        let mut carries = vec![false; robot.joint_count()];
        carriers.iter().flatten().for_each(|joint| carries[*joint] = true);
        let outermost: Vec<usize> = (0..carries.len()).filter(|joint| !carries[*joint]).collect();
        let ends = outermost.iter().map(|joint| end(robot, *joint, &last)).collect();
        Self { carriers, tip_carriers: outermost, ends }
    }
}

/// Where what a joint moves ends: at the last link that is fixed to its own, or else as far beyond its centre of mass as that is from
/// the joint.
fn end(robot: &Robot, joint: usize, last: &[Option<usize>]) -> End {
    let links = robot.links();
    let last = (0..links.len()).rfind(|&i| last[i] == Some(joint)).unwrap_or_default();
    let place = match links[last].joint.axis() {
        Some(_) => 2.0 * links[last].centre_of_mass,
        None => Vector3::zeros(),
    };
    End { link: last, place }
}
