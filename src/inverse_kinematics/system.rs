//! The tool's error, and how it changes with the joints.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::target::{Orientation, Origin, ToolTarget};
use crate::kinematics::{Outward, manipulator_jacobian, tool};
use crate::robot::{Joint, Robot};

/// Where tool and centre of mass are, in base axes \[m\].
pub(super) struct Place {
    position: Vector3<f64>,
    rotation: Rotation3<f64>,
    centre_of_mass: Vector3<f64>,
}

/// What the tool is off by.
pub(super) struct Off {
    /// From where it is to be to where it is, base axes \[m\].
    pub(super) position: Vector3<f64>,
    /// A vector whose gradient by the joints is that of half its square: the turn left, or the difference of two directions.
    turn: Vector3<f64>,
    /// The angle left \[rad\].
    pub(super) angle: f64,
}

impl Place {
    pub(super) fn of(robot: &Robot, positions: &[f64]) -> Self {
        let tool = tool(robot, positions);
        let columns = tool.rotation.0.map(Vector3::from);
        let moment = Outward::<_>::new(robot, positions)
            .map(|link| Vector3::from(link.centre_of_mass) * link.link.body.mass)
            .sum::<Vector3<f64>>();
        Self {
            position: tool.position.into(),
            rotation: Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns)),
            centre_of_mass: moment / robot.total_mass(),
        }
    }

    pub(super) fn error(&self, target: &ToolTarget) -> Off {
        let origin = match target.origin {
            Origin::Base => Vector3::zeros(),
            Origin::System => self.centre_of_mass,
        };
        let wanted = target.position;
        let position = wanted.map_or_else(Vector3::zeros, |wanted| self.position - origin - wanted);
        let (turn, angle) = match &target.orientation {
            Orientation::Any => (Vector3::zeros(), 0.0),
            Orientation::Axis { tool, direction } => {
                let axis = self.rotation * **tool;
                let angle = axis.cross(direction).norm().atan2(axis.dot(direction));
                (axis - **direction, angle)
            }
            Orientation::Full(wanted) => {
                let turn = self.rotation * wanted.inverse();
                let turn = UnitQuaternion::from_rotation_matrix(&turn).scaled_axis();
                (turn, turn.norm())
            }
        };
        Off { position, turn, angle }
    }
}

/// The error, lengths as shares of `reach` \[m\], and its derivative by the joints, one column each.
pub(super) fn linearised(
    robot: &Robot,
    target: &ToolTarget,
    positions: &[f64],
    reach: f64,
) -> (DVector<f64>, DMatrix<f64>) {
    let place = Place::of(robot, positions);
    let off = place.error(target);
    let tool = manipulator_jacobian(robot, positions);
    let mut jacobian = DMatrix::zeros(6, robot.joint_count());
    if target.position.is_some() {
        jacobian.rows_mut(0, 3).copy_from(&tool.fixed_rows::<3>(0));
        if target.origin == Origin::System {
            let mut rows = jacobian.rows_mut(0, 3);
            rows -= centre_of_mass_jacobian(robot, positions);
        }
        jacobian.rows_mut(0, 3).unscale_mut(reach);
    }
    match &target.orientation {
        Orientation::Any => {}
        Orientation::Axis { tool: axis, .. } => {
            let cross = (place.rotation * **axis).cross_matrix();
            jacobian.rows_mut(3, 3).copy_from(&(-cross * tool.fixed_rows::<3>(3)));
        }
        Orientation::Full(_) => jacobian.rows_mut(3, 3).copy_from(&tool.fixed_rows::<3>(3)),
    }
    let mut error = DVector::zeros(6);
    error.rows_mut(0, 3).copy_from(&(off.position / reach));
    error.rows_mut(3, 3).copy_from(&off.turn);
    (error, jacobian)
}

/// How the system's centre of mass moves in base axes for unit rate of each joint \[m/rad or 1\].
fn centre_of_mass_jacobian(robot: &Robot, positions: &[f64]) -> DMatrix<f64> {
    let links: Vec<_> = Outward::<_>::new(robot, positions).collect();
    // Mass and first moment of each link and of all that it carries.
    let mut carried: Vec<(f64, Vector3<f64>)> = links
        .iter()
        .map(|link| {
            let mass = link.link.body.mass;
            (mass, Vector3::from(link.centre_of_mass) * mass)
        })
        .collect();
    for i in (0..links.len()).rev() {
        let (mass, moment) = carried[i];
        if let Some(parent) = links[i].link.parent {
            carried[parent].0 += mass;
            carried[parent].1 += moment;
        }
    }
    let total = robot.total_mass();
    let mut jacobian = DMatrix::zeros(3, robot.joint_count());
    for (mut column, joint) in jacobian.column_iter_mut().zip(robot.joints()) {
        let link = &links[joint.link];
        let (mass, moment) = carried[joint.link];
        let axis = Vector3::from(link.axis);
        let moved = match link.link.joint {
            Joint::Prismatic(_) => axis * mass,
            _ => axis.cross(&(moment - Vector3::from(link.frame.position) * mass)),
        };
        column.copy_from(&(moved / total));
    }
    jacobian
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the error, on a robot of every kind.
    #[test]
    fn derivatives_are_those_of_differences() {
        for name in Robot::embedded_names() {
            let robot = Robot::from_document(&Robot::embedded(name).unwrap()).unwrap();
            let reach = robot.reach();
            let positions = robot.random_configurations().nth(7).unwrap();
            let place = Place::of(&robot, &robot.random_configurations().nth(9).unwrap());
            let turned = place.rotation * Vector3::x_axis();
            let orientations = [
                Orientation::Any,
                Orientation::Axis { tool: Vector3::y_axis(), direction: turned },
                // Where nothing is left to turn, the error is that of a small turn.
                Orientation::Full(Place::of(&robot, &positions).rotation),
            ];
            for (orientation, origin) in
                orientations.into_iter().zip([Origin::System, Origin::Base, Origin::System])
            {
                let position = Some(place.position);
                let target = ToolTarget { position, origin, orientation };
                let (_, jacobian) = linearised(&robot, &target, &positions, reach);
                for joint in 0..positions.len() {
                    let at = |step: f64| {
                        let mut positions = positions.clone();
                        positions[joint] += step;
                        linearised(&robot, &target, &positions, reach).0
                    };
                    let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
                    let miss = (difference - jacobian.column(joint)).norm();
                    assert!(miss < 1e-8, "{name}, joint {joint}: {miss:e}");
                }
            }
        }
    }
}
