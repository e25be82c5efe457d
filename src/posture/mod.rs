//! Where a floating robot is, link by link.

mod satellite;

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

pub use satellite::{Satellite, SolarPanel};

use crate::kinematics::{Outward, tool};
use crate::robot::Robot;

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
    /// For each origin the one that carries it; `None` for the base.
    #[serde(skip)]
    pub carriers: Vec<Option<usize>>,
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
        let (mut origins, mut axes) = (Vec::new(), Vec::new());
        let mut moment = Vector3::zeros();
        for link in Outward::<_>::new(robot, positions) {
            moment += Vector3::from(link.centre_of_mass) * link.link.body.mass;
            if link.link.joint.axis().is_some() {
                origins.push(Vector3::from(link.frame.position).into());
                axes.push(Vector3::from(link.axis).into());
            }
        }
        let tool = tool(robot, positions);
        let [jaw, _, approach] = tool.rotation.0.map(|axis| Vector3::from(axis).into());
        origins.push(Vector3::from(tool.position).into());
        axes.push(approach);
        let [x, y, z, w] = attitude.coords.into();
        let position = attitude * -moment / robot.total_mass();
        Self {
            position: position.into(),
            attitude: [w, x, y, z],
            origins,
            carriers: carriers(robot),
            axes,
            jaw,
        }
    }
}

fn carriers(robot: &Robot) -> Vec<Option<usize>> {
    // For every link, the last joint that moves between the base and it.
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
    carriers
}
