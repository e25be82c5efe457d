//! Where the links are and how the tool moves (eqs. 1–4), in base axes with the base held still.

use nalgebra::{Matrix6, Matrix6xX, Vector3};

use crate::robot::{Joint, Robot};
use crate::scalar::Scalar;
use crate::vec3::{Mat3, Vec3};

/// Six rows, linear above angular; one column a joint.
pub type Jacobian = Matrix6xX<f64>;

/// Place and orientation of a frame in base axes.
#[derive(Debug, Clone, Copy)]
pub struct Pose<T> {
    /// Origin \[m\].
    pub position: Vec3<T>,
    /// Turns the frame's axes into base axes.
    pub rotation: Mat3<T>,
}

/// One link as the outward sweep meets it, in base axes.
#[derive(Debug, Clone, Copy)]
pub struct LinkPose<'a, T> {
    /// The joint that moves the link.
    pub joint: &'a Joint,
    /// The joint's axis `n_i`, a unit vector.
    pub axis: Vec3<T>,
    /// The link's proximal frame: origin on the joint, turned by `θ` but not by the DH offset.
    pub proximal: Pose<T>,
    /// The link's centre of mass `r_i` \[m\].
    pub centre_of_mass: Vec3<T>,
}

/// The outward sweep: an iterator over the links, from the base to the tool.
#[derive(Debug)]
pub struct Outward<'a, T> {
    joints: std::iter::Zip<std::slice::Iter<'a, Joint>, std::slice::Iter<'a, T>>,
    frame: Pose<T>,
}

impl<'a, T: Scalar> Outward<'a, T> {
    /// Starts at the arm's mount; `angles` \[rad\], one a joint.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer angles than joints.
    #[inline(always)]
    pub fn new(robot: &'a Robot, angles: &'a [T]) -> Self {
        assert_eq!(angles.len(), robot.joint_count(), "one angle a joint");
        let frame = Pose {
            position: Vec3::of(&robot.mount),
            rotation: Mat3::of(robot.mount_rotation.matrix()),
        };
        Self { joints: robot.joints.iter().zip(angles), frame }
    }
}

impl<'a, T: Scalar> Iterator for Outward<'a, T> {
    type Item = LinkPose<'a, T>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        let (joint, angle) = self.joints.next()?;
        let Pose { position, rotation } = self.frame;
        let proximal = turn_about_z(rotation, angle.sin_cos());
        let constant = |(sin, cos)| (T::of(sin), T::of(cos));
        let turned = turn_about_z(proximal, constant(joint.dh.offset));
        self.frame = Pose {
            position: position + proximal * Vec3::of(&joint.dh.step),
            rotation: turn_about_x(turned, constant(joint.dh.twist)),
        };
        Some(LinkPose {
            joint,
            axis: rotation.0[2],
            proximal: Pose { position, rotation: proximal },
            centre_of_mass: position + proximal * Vec3::of(&joint.centre_of_mass),
        })
    }
}

/// `m · Rz`, given sine and cosine.
#[inline(always)]
fn turn_about_z<T: Scalar>(Mat3([x, y, z]): Mat3<T>, (sin, cos): (T, T)) -> Mat3<T> {
    Mat3([x * cos + y * sin, y * cos - x * sin, z])
}

/// `m · Rx`, given sine and cosine.
#[inline(always)]
fn turn_about_x<T: Scalar>(Mat3([x, y, z]): Mat3<T>, (sin, cos): (T, T)) -> Mat3<T> {
    Mat3([x, y * cos + z * sin, z * cos - y * sin])
}

/// Pose of the tool, the frame after the last DH row (eq. 1).
pub fn tool(robot: &Robot, angles: &[f64]) -> Pose<f64> {
    let mut sweep = Outward::new(robot, angles);
    sweep.by_ref().for_each(drop);
    sweep.frame
}

/// `J_b` of eq. 4: the tool's twist for the base's, both along base axes.
pub fn base_jacobian(robot: &Robot, angles: &[f64]) -> Matrix6<f64> {
    let arm = Vector3::from(tool(robot, angles).position);
    let mut jacobian = Matrix6::identity();
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    jacobian
}

/// `J_m` of eq. 4: the tool's twist for the joint rates, the base held still.
pub fn manipulator_jacobian(robot: &Robot, angles: &[f64]) -> Jacobian {
    let tip = tool(robot, angles).position;
    let mut jacobian = Jacobian::zeros(robot.joint_count());
    for (mut column, link) in jacobian.column_iter_mut().zip(Outward::new(robot, angles)) {
        let lever = tip - link.proximal.position;
        column.fixed_rows_mut::<3>(0).copy_from(&link.axis.cross(lever).into());
        column.fixed_rows_mut::<3>(3).copy_from(&link.axis.into());
    }
    jacobian
}
