//! How the base answers the joints when total momentum is zero (eqs. 5–7), in base axes.

use nalgebra::{Matrix3, Vector3, Vector6};

use crate::kinematics::{Jacobian, Outward, base_jacobian, manipulator_jacobian};
use crate::robot::Robot;
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
    let arm = Sums::of(robot, angles, rates);
    let mass = T::of(robot.total_mass());
    let centre = arm.first_moment / mass;
    let inertia = arm.inertia - point_inertia(mass, &centre);
    let angular = -solve(&inertia, &(arm.angular - centre.cross(&arm.linear)));
    Twist { linear: centre.cross(&angular) - arm.linear / mass, angular }
}

/// What the sweep adds up; moments are about the base's centre of mass.
struct Sums<T> {
    first_moment: Vector3<T>,
    inertia: Matrix3<T>,
    linear: Vector3<T>,
    angular: Vector3<T>,
}

impl<T: Scalar> Sums<T> {
    fn of(robot: &Robot, angles: &[T], rates: &[T]) -> Self {
        let mut sums = Self {
            first_moment: Vector3::zeros(),
            inertia: robot.base.inertia.map(T::of),
            linear: Vector3::zeros(),
            angular: Vector3::zeros(),
        };
        // ω of the link, and the velocity of its material point that now stands at the origin.
        let mut omega = Vector3::zeros();
        let mut velocity = Vector3::zeros();
        for (link, &rate) in Outward::new(robot, angles).zip(rates) {
            let turn = link.axis * rate;
            omega += turn;
            velocity += link.proximal.position.cross(&turn);

            let mass = T::of(link.joint.link.mass);
            let r = link.centre_of_mass;
            let linear = (velocity + omega.cross(&r)) * mass;
            let rotation = link.proximal.rotation;
            let inertia = rotation * link.joint.link.inertia.map(T::of) * rotation.transpose();
            sums.first_moment += r * mass;
            sums.inertia += inertia + point_inertia(mass, &r);
            sums.linear += linear;
            sums.angular += inertia * omega + r.cross(&linear);
        }
        sums
    }
}

/// Inertia of a point mass about the origin, `m (r·r E − r rᵀ)`.
fn point_inertia<T: Scalar>(mass: T, r: &Vector3<T>) -> Matrix3<T> {
    (Matrix3::from_diagonal_element(r.dot(r)) - r * r.transpose()) * mass
}

/// Cramer's rule; a composite inertia is far from singular.
fn solve<T: Scalar>(m: &Matrix3<T>, b: &Vector3<T>) -> Vector3<T> {
    let [x, y, z] = [0, 1, 2].map(|i| m.column(i).into_owned());
    let yz = y.cross(&z);
    Vector3::new(b.dot(&yz), b.dot(&z.cross(&x)), b.dot(&x.cross(&y))) / x.dot(&yz)
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
