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
    /// The joints and, last, the tool, base axes \[m\].
    pub origins: Vec<[f64; 3]>,
    /// The joints' axes and, last, the tool's third, base axes.
    pub axes: Vec<[f64; 3]>,
    /// The tool's first axis, base axes.
    pub jaw: [f64; 3],
}

impl Posture {
    /// For joint angles \[rad\] and the base's attitude, base axes into inertial axes.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer angles than joints.
    pub fn of(robot: &Robot, angles: &[f64], attitude: UnitQuaternion<f64>) -> Self {
        let (mut origins, mut axes) = (Vec::new(), Vec::new());
        let mut moment = Vector3::zeros();
        for link in Outward::new(robot, angles) {
            origins.push(Vector3::from(link.proximal.position).into());
            axes.push(Vector3::from(link.axis).into());
            moment += Vector3::from(link.centre_of_mass) * link.joint.link.mass;
        }
        let tool = tool(robot, angles);
        let [jaw, _, approach] = tool.rotation.0.map(|axis| Vector3::from(axis).into());
        origins.push(Vector3::from(tool.position).into());
        axes.push(approach);
        let [x, y, z, w] = attitude.coords.into();
        let position = attitude * -moment / robot.total_mass();
        Self { position: position.into(), attitude: [w, x, y, z], origins, axes, jaw }
    }
}
