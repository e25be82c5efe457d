//! Where the links are and how the tool moves (eqs. 1–4), in base axes with the base held still.

use nalgebra::{Dyn, Matrix3, Matrix6, OMatrix, U6, Vector3};

use crate::robot::{Joint, Robot};
use crate::scalar::Scalar;

/// Six rows, linear above angular; one column a joint.
pub type Jacobian<T> = OMatrix<T, U6, Dyn>;

/// Place and orientation of a frame in base axes.
#[derive(Debug, Clone, Copy)]
pub struct Pose<T> {
    /// Origin \[m\].
    pub position: Vector3<T>,
    /// Turns the frame's axes into base axes.
    pub rotation: Matrix3<T>,
}

/// One link as the outward sweep meets it, in base axes.
#[derive(Debug, Clone, Copy)]
pub struct LinkPose<'a, T> {
    /// The joint that moves the link.
    pub joint: &'a Joint,
    /// The joint's axis `n_i`, a unit vector.
    pub axis: Vector3<T>,
    /// The link's proximal frame: origin on the joint, turned by `θ` but not by the DH offset.
    pub proximal: Pose<T>,
    /// The link's centre of mass `r_i` \[m\].
    pub centre_of_mass: Vector3<T>,
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
    pub fn new(robot: &'a Robot, angles: &'a [T]) -> Self {
        assert_eq!(angles.len(), robot.joint_count(), "one angle a joint");
        let frame = Pose {
            position: robot.mount.map(T::of),
            rotation: robot.mount_rotation.matrix().map(T::of),
        };
        Self { joints: robot.joints.iter().zip(angles), frame }
    }
}

impl<'a, T: Scalar> Iterator for Outward<'a, T> {
    type Item = LinkPose<'a, T>;

    fn next(&mut self) -> Option<Self::Item> {
        let (joint, angle) = self.joints.next()?;
        let Pose { position, rotation } = self.frame;
        let proximal = turn_about_z(&rotation, angle.simd_sin_cos());
        let (sin, cos) = joint.dh.offset;
        let turned = turn_about_z(&proximal, (T::of(sin), T::of(cos)));
        let (sin, cos) = joint.dh.twist;
        self.frame = Pose {
            position: position + proximal * joint.dh.step.map(T::of),
            rotation: turn_about_x(&turned, (T::of(sin), T::of(cos))),
        };
        Some(LinkPose {
            joint,
            axis: rotation.column(2).into(),
            proximal: Pose { position, rotation: proximal },
            centre_of_mass: position + proximal * joint.centre_of_mass.map(T::of),
        })
    }
}

/// `m · Rz`, given sine and cosine.
fn turn_about_z<T: Scalar>(m: &Matrix3<T>, (sin, cos): (T, T)) -> Matrix3<T> {
    let (x, y) = (m.column(0), m.column(1));
    Matrix3::from_columns(&[x * cos + y * sin, y * cos - x * sin, m.column(2).into()])
}

/// `m · Rx`, given sine and cosine.
fn turn_about_x<T: Scalar>(m: &Matrix3<T>, (sin, cos): (T, T)) -> Matrix3<T> {
    let (y, z) = (m.column(1), m.column(2));
    Matrix3::from_columns(&[m.column(0).into(), y * cos + z * sin, z * cos - y * sin])
}

/// Pose of the tool, the frame after the last DH row (eq. 1).
pub fn tool<T: Scalar>(robot: &Robot, angles: &[T]) -> Pose<T> {
    let mut sweep = Outward::new(robot, angles);
    sweep.by_ref().for_each(drop);
    sweep.frame
}

/// `J_b` of eq. 4: the tool's twist for the base's, both along base axes.
pub fn base_jacobian<T: Scalar>(robot: &Robot, angles: &[T]) -> Matrix6<T> {
    let arm = tool(robot, angles).position;
    let mut jacobian = Matrix6::identity();
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    jacobian
}

/// `J_m` of eq. 4: the tool's twist for the joint rates, the base held still.
pub fn manipulator_jacobian<T: Scalar>(robot: &Robot, angles: &[T]) -> Jacobian<T> {
    let tip = tool(robot, angles).position;
    let mut jacobian = Jacobian::zeros(robot.joint_count());
    for (mut column, link) in jacobian.column_iter_mut().zip(Outward::new(robot, angles)) {
        let lever = tip - link.proximal.position;
        column.fixed_rows_mut::<3>(0).copy_from(&link.axis.cross(&lever));
        column.fixed_rows_mut::<3>(3).copy_from(&link.axis);
    }
    jacobian
}
