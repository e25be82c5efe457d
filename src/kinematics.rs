//! Where the links are and how the tool moves (eqs. 1–4), in base axes with the base held still.

use nalgebra::{Matrix6, Matrix6xX, Vector3};

use crate::robot::{Axis, Inherited, Joint, Link, Placement, Robot, Turns};
use crate::scalar::Scalar;
use crate::vec3::{Mat3, Vec3};

/// Six rows, linear above angular; one column per joint that moves.
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
    /// The link.
    pub link: &'a Link,
    /// The axis `n_i` of its joint, a unit vector; zero where the joint is fixed.
    pub axis: Vec3<T>,
    /// The link's frame, as its joint has moved it. A revolute joint leaves the origin in place.
    pub frame: Pose<T>,
    /// The link's centre of mass `r_i` \[m\].
    pub centre_of_mass: Vec3<T>,
}

/// The outward sweep: an iterator over the links, in the robot's order.
///
/// `PLAIN` leaves out what robots do not need that are chains of revolute joints.
#[derive(Debug)]
pub struct Outward<'a, T, const PLAIN: bool = false> {
    robot: &'a Robot,
    positions: &'a [T],
    next: usize,
    frames: Inherited<Pose<T>>,
}

impl<'a, T: Scalar, const PLAIN: bool> Outward<'a, T, PLAIN> {
    /// Starts at the base; `positions` \[rad or m\], one per joint that moves.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    #[inline(always)]
    pub fn new(robot: &'a Robot, positions: &'a [T]) -> Self {
        assert_eq!(positions.len(), robot.joint_count(), "one position per joint");
        let base = Pose { position: Vec3::zero(), rotation: Mat3::diagonal(T::of(1.0)) };
        Self { robot, positions, next: 0, frames: Inherited::new(robot, base) }
    }
}

impl<'a, T: Scalar, const PLAIN: bool> Iterator for Outward<'a, T, PLAIN> {
    type Item = LinkPose<'a, T>;

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Item> {
        let link = self.robot.links().get(self.next)?;
        if !PLAIN {
            self.frames.enter(self.robot, self.next);
        }
        let joint = match link.parent {
            None => Pose::of(&link.placement),
            Some(_) => self.frames.current.then::<PLAIN>(&link.placement),
        };
        let (frame, axis) = match &link.joint {
            _ if PLAIN => joint.turned_about_z(self.position()?),
            Joint::Fixed => (joint, Vec3::zero()),
            Joint::Revolute(axis) => joint.turned(axis, self.position()?),
            Joint::Prismatic(axis) => joint.shifted(axis, self.position()?),
        };
        self.frames.current = frame;
        if !PLAIN {
            self.frames.leave(self.robot, self.next);
        }
        self.next += 1;
        let centre_of_mass = frame.position + frame.rotation * Vec3::of(&link.centre_of_mass);
        Some(LinkPose { link, axis, frame, centre_of_mass })
    }
}

impl<T: Scalar, const PLAIN: bool> Outward<'_, T, PLAIN> {
    /// The position of the next joint that moves.
    #[inline(always)]
    fn position(&mut self) -> Option<T> {
        let (&position, rest) = self.positions.split_first()?;
        self.positions = rest;
        Some(position)
    }
}

impl<T: Scalar> Pose<T> {
    #[inline(always)]
    fn of(placement: &Placement) -> Self {
        Self {
            position: Vec3::of(placement.translation()),
            rotation: Mat3::of(placement.rotation().matrix()),
        }
    }

    /// The pose of a frame that sits so in this one.
    #[inline(always)]
    fn then<const PLAIN: bool>(self, placement: &Placement) -> Self {
        let Self { position, rotation } = self;
        let constant = |(sin, cos)| (T::of(sin), T::of(cos));
        Self {
            position: position + rotation * Vec3::of(placement.translation()),
            rotation: match placement.turns() {
                Turns::Dh { offset, twist } => {
                    turn_about_x(turn_about_z(rotation, constant(*offset)), constant(*twist))
                }
                Turns::Matrix(_) if PLAIN => rotation,
                Turns::Matrix(turn) => rotation * Mat3::of(turn.matrix()),
            },
        }
    }

    /// Turned about its own `z`; and that axis.
    #[inline(always)]
    fn turned_about_z(self, angle: T) -> (Self, Vec3<T>) {
        let rotation = turn_about_z(self.rotation, angle.sin_cos());
        (Self { rotation, ..self }, self.rotation.0[2])
    }

    /// Turned about an axis of its own; and the axis.
    #[inline(always)]
    fn turned(self, axis: &Axis, angle: T) -> (Self, Vec3<T>) {
        if axis.is_z() {
            return self.turned_about_z(angle);
        }
        let (sin, cos) = angle.sin_cos();
        // Rodrigues: cos E + sin n× + (1 − cos) n nᵀ.
        let n = Vec3::of(&axis.direction);
        let along = n * (T::of(1.0) - cos);
        let turn = Mat3::diagonal(cos)
            + Mat3::cross(n * sin)
            + Mat3([along * n.x, along * n.y, along * n.z]);
        (Self { rotation: self.rotation * turn, ..self }, self.rotation * n)
    }

    /// Shifted along an axis of its own; and the axis.
    #[inline(always)]
    fn shifted(self, axis: &Axis, distance: T) -> (Self, Vec3<T>) {
        let axis = self.rotation * Vec3::of(&axis.direction);
        (Self { position: self.position + axis * distance, ..self }, axis)
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

/// Pose of the tool (eq. 1).
///
/// # Panics
///
/// Panics when there are more or fewer positions than joints that move.
pub fn tool(robot: &Robot, positions: &[f64]) -> Pose<f64> {
    let tool = robot.tool();
    let held = tool.link.and_then(|link| Outward::<_>::new(robot, positions).nth(link));
    held.map_or_else(|| Pose::of(&tool.placement), |link| link.frame.then::<false>(&tool.placement))
}

/// `J_b` of eq. 4: the tool's twist for the base's, both along base axes.
pub fn base_jacobian(robot: &Robot, positions: &[f64]) -> Matrix6<f64> {
    let arm = Vector3::from(tool(robot, positions).position);
    let mut jacobian = Matrix6::identity();
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-arm.cross_matrix());
    jacobian
}

/// `J_m` of eq. 4: the tool's twist for the joint rates, the base held still. A joint that does not lie
/// between base and tool has a column of zeros.
pub fn manipulator_jacobian(robot: &Robot, positions: &[f64]) -> Jacobian {
    let tip = tool(robot, positions).position;
    let chain = robot.tool().link.map(|link| robot.chain_to(link)).unwrap_or_default();
    let mut jacobian = Jacobian::zeros(robot.joint_count());
    let links: Vec<_> = Outward::<_>::new(robot, positions).collect();
    for (mut column, joint) in jacobian.column_iter_mut().zip(robot.joints()) {
        if !chain.contains(&joint.link) {
            continue;
        }
        let link = &links[joint.link];
        if matches!(link.link.joint, Joint::Prismatic(_)) {
            column.fixed_rows_mut::<3>(0).copy_from(&link.axis.into());
            continue;
        }
        let lever = tip - link.frame.position;
        column.fixed_rows_mut::<3>(0).copy_from(&link.axis.cross(lever).into());
        column.fixed_rows_mut::<3>(3).copy_from(&link.axis.into());
    }
    jacobian
}
