//! How the base answers the joints when total momentum is zero (eqs. 5–7), in base axes.

mod slopes;

pub use slopes::RateSlopes;

use std::ops::{AddAssign, Mul, SubAssign};

use nalgebra::{Matrix3, Vector3, Vector6};

use crate::kinematics::{Jacobian, LinkPose, Outward, base_jacobian, manipulator_jacobian};
use crate::robot::{Body, Robot};
use crate::scalar::Scalar;

/// Linear and angular velocity of the base, along base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<T> {
    /// Velocity of the base's centre of mass \[m/s\].
    pub linear: Vector3<T>,
    /// Angular velocity \[rad/s\].
    pub angular: Vector3<T>,
}

/// The base's twist for joint angles \[rad\] and rates \[rad/s\] with zero total momentum.
///
/// One outward sweep with the base held still gives the arm's momentum and the composite inertia;
/// about the system's centre of mass the angular part then stands alone, a 3×3 solve.
pub fn base_twist<T: Scalar>(robot: &Robot, angles: &[T], rates: &[T]) -> Twist<T> {
    let (balance, momentum) = sweep(robot, angles, rates, |_| {});
    balance.twist(&momentum)
}

/// One link with the base held still.
#[derive(Debug, Clone)]
struct Link<T> {
    /// The twist for unit rate of its joint.
    screw: Twist<T>,
    twist: Twist<T>,
    body: RigidBody<T>,
}

/// The outward sweep with the base held still: the whole system and the arm's momentum; `each` is told
/// every link.
fn sweep<T: Scalar>(
    robot: &Robot,
    angles: &[T],
    rates: &[T],
    mut each: impl FnMut(Link<T>),
) -> (Balance<T>, Momentum<T>) {
    let mut system = RigidBody::base(robot);
    let mut momentum = Momentum::zero();
    let mut twist = Twist::zero();
    for (link, &rate) in Outward::new(robot, angles).zip(rates) {
        let screw = Twist { linear: link.proximal.position.cross(&link.axis), angular: link.axis };
        twist += screw * rate;
        let body = RigidBody::link(&link);
        momentum += body.momentum(&twist);
        system += body;
        each(Link { screw, twist, body });
    }
    (system.balance(), momentum)
}

impl<T: Scalar> Twist<T> {
    fn zero() -> Self {
        Self { linear: Vector3::zeros(), angular: Vector3::zeros() }
    }

    /// `S × t`: how a twist changes that turns with the screw `S`.
    fn turned(&self, twist: &Self) -> Self {
        let Self { linear, angular } = self;
        Self {
            linear: angular.cross(&twist.linear) + linear.cross(&twist.angular),
            angular: angular.cross(&twist.angular),
        }
    }

    /// `S ×* H`: how a momentum changes that turns with the screw `S`.
    fn turned_momentum(&self, momentum: &Momentum<T>) -> Momentum<T> {
        let Self { linear, angular } = self;
        Momentum {
            linear: angular.cross(&momentum.linear),
            angular: angular.cross(&momentum.angular) + linear.cross(&momentum.linear),
        }
    }
}

impl<T: Scalar> Mul<T> for Twist<T> {
    type Output = Self;

    fn mul(self, factor: T) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }
}

impl<T: Scalar> AddAssign for Twist<T> {
    fn add_assign(&mut self, other: Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

/// Linear and angular momentum about the base's centre of mass.
#[derive(Debug, Clone, Copy)]
struct Momentum<T> {
    linear: Vector3<T>,
    angular: Vector3<T>,
}

impl<T: Scalar> Momentum<T> {
    fn zero() -> Self {
        Self { linear: Vector3::zeros(), angular: Vector3::zeros() }
    }
}

impl<T: Scalar> AddAssign for Momentum<T> {
    fn add_assign(&mut self, other: Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

impl<T: Scalar> SubAssign for Momentum<T> {
    fn sub_assign(&mut self, other: Self) {
        self.linear -= other.linear;
        self.angular -= other.angular;
    }
}

/// Mass, first moment and inertia, about the base's centre of mass, of one body or of some that move
/// as one.
#[derive(Debug, Clone, Copy)]
struct RigidBody<T> {
    mass: T,
    first_moment: Vector3<T>,
    inertia: Matrix3<T>,
}

impl<T: Scalar> RigidBody<T> {
    fn none() -> Self {
        Self { mass: T::zero(), first_moment: Vector3::zeros(), inertia: Matrix3::zeros() }
    }

    fn base(robot: &Robot) -> Self {
        let Body { mass, inertia } = &robot.base;
        Self { mass: T::of(*mass), first_moment: Vector3::zeros(), inertia: inertia.map(T::of) }
    }

    fn link(link: &LinkPose<'_, T>) -> Self {
        let mass = T::of(link.joint.link.mass);
        let rotation = link.proximal.rotation;
        let inertia = rotation * link.joint.link.inertia.map(T::of) * rotation.transpose();
        let r = link.centre_of_mass;
        Self { mass, first_moment: r * mass, inertia: inertia + point_inertia(mass, &r) }
    }

    fn momentum(&self, twist: &Twist<T>) -> Momentum<T> {
        Momentum {
            linear: twist.linear * self.mass + twist.angular.cross(&self.first_moment),
            angular: self.inertia * twist.angular + self.first_moment.cross(&twist.linear),
        }
    }

    /// Ready to answer what twist of the whole balances a momentum.
    fn balance(&self) -> Balance<T> {
        let centre = self.first_moment / self.mass;
        let inertia = self.inertia - point_inertia(self.mass, &centre);
        Balance { mass: self.mass, centre, inverse: inverse(&inertia) }
    }
}

impl<T: Scalar> AddAssign for RigidBody<T> {
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        self.first_moment += other.first_moment;
        self.inertia += other.inertia;
    }
}

/// A rigid system that answers a momentum with the twist that takes it away.
struct Balance<T> {
    mass: T,
    /// Centre of mass.
    centre: Vector3<T>,
    /// Inverse of the inertia about it.
    inverse: Matrix3<T>,
}

impl<T: Scalar> Balance<T> {
    fn angular(&self, momentum: &Momentum<T>) -> Vector3<T> {
        self.inverse * (self.centre.cross(&momentum.linear) - momentum.angular)
    }

    fn twist(&self, momentum: &Momentum<T>) -> Twist<T> {
        let angular = self.angular(momentum);
        Twist { linear: self.centre.cross(&angular) - momentum.linear / self.mass, angular }
    }
}

/// Inertia of a point mass about the origin, `m (r·r E − r rᵀ)`.
fn point_inertia<T: Scalar>(mass: T, r: &Vector3<T>) -> Matrix3<T> {
    (Matrix3::from_diagonal_element(r.dot(r)) - r * r.transpose()) * mass
}

/// By cofactors; a composite inertia is symmetric and far from singular.
fn inverse<T: Scalar>(m: &Matrix3<T>) -> Matrix3<T> {
    let [x, y, z] = [0, 1, 2].map(|i| m.column(i).into_owned());
    let yz = y.cross(&z);
    Matrix3::from_columns(&[yz, z.cross(&x), x.cross(&y)]) / x.dot(&yz)
}

/// `J_bm` of eq. 7 (with the sign the paper drops): the base's twist for unit rate of each joint.
pub fn base_map<T: Scalar>(robot: &Robot, angles: &[T]) -> Jacobian<T> {
    let n = robot.joint_count();
    let mut rates = vec![T::zero(); n];
    let mut map = Jacobian::zeros(n);
    for (i, mut column) in map.column_iter_mut().enumerate() {
        rates[i] = T::one();
        let Twist { linear, angular } = base_twist(robot, angles, &rates);
        rates[i] = T::zero();
        let [vx, vy, vz] = linear.into();
        let [wx, wy, wz] = angular.into();
        column.copy_from(&Vector6::new(vx, vy, vz, wx, wy, wz));
    }
    map
}

/// `J_g = J_m + J_b J_bm`: the tool's twist for the joint rates while the base floats.
pub fn generalised_jacobian<T: Scalar>(robot: &Robot, angles: &[T]) -> Jacobian<T> {
    manipulator_jacobian(robot, angles) + base_jacobian(robot, angles) * base_map(robot, angles)
}

/// Total linear \[N·s\] and angular momentum about the base's centre of mass \[N·m·s\], term by term
/// as in eq. 5; zero for the twist that [`base_twist`] gives.
pub fn total_momentum<T: Scalar>(
    robot: &Robot,
    angles: &[T],
    rates: &[T],
    base: &Twist<T>,
) -> (Vector3<T>, Vector3<T>) {
    let velocity = |r: &Vector3<T>| base.linear + base.angular.cross(r);
    let mut linear = velocity(&Vector3::zeros()) * T::of(robot.base.mass);
    let mut angular = robot.base.inertia.map(T::of) * base.angular;
    let links: Vec<_> = Outward::new(robot, angles).collect();
    for (i, link) in links.iter().enumerate() {
        let r = link.centre_of_mass;
        let (mut v, mut w) = (velocity(&r), base.angular);
        for (inner, &rate) in links[..=i].iter().zip(rates) {
            v += (inner.axis * rate).cross(&(r - inner.proximal.position));
            w += inner.axis * rate;
        }
        let rotation = link.proximal.rotation;
        let momentum = v * T::of(link.joint.link.mass);
        let spin = rotation.transpose() * w;
        linear += momentum;
        angular += rotation * (link.joint.link.inertia.map(T::of) * spin) + r.cross(&momentum);
    }
    (linear, angular)
}
