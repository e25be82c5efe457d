//! How the base answers the joints (eqs. 5–7), in base axes.
//!
//! Total linear momentum is zero: inertial axes move with the system's centre of mass. Total angular momentum is zero
//! unless a function takes it.

mod arm;
mod assembly;
mod slopes;

pub use arm::{Arm, ArmLink, JointState};
pub use slopes::RateSlopes;

use std::ops::{AddAssign, Mul, SubAssign};

use nalgebra::Vector6;

use crate::kinematics::{Jacobian, LinkPose, Outward, base_jacobian, manipulator_jacobian};
use crate::robot::{Body, Inherited, Joint, Robot};
use crate::scalar::Scalar;
use crate::vec3::{Sym3, Vec3};

/// Linear and angular velocity of the base, along base axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist<T> {
    /// Velocity of the base's centre of mass \[m/s\].
    pub linear: Vec3<T>,
    /// Angular velocity \[rad/s\].
    pub angular: Vec3<T>,
}

/// The base's twist for joint positions \[rad or m\] and rates \[rad/s or m/s\] with zero total momentum.
///
/// One outward sweep with the base held still gives the arm's momentum and the composite inertia;
/// about the system's centre of mass the angular part then stands alone, a 3×3 solve.
#[inline(always)]
pub fn base_twist<T: Scalar>(robot: &Robot, positions: &[T], rates: &[T]) -> Twist<T> {
    drifting_twist(robot, positions, rates, Vec3::zero())
}

/// The same with a total angular momentum \[N·m·s\] about the system's centre of mass, along base axes.
#[inline(always)]
pub fn drifting_twist<T: Scalar>(
    robot: &Robot,
    positions: &[T],
    rates: &[T],
    angular_momentum: Vec3<T>,
) -> Twist<T> {
    let (balance, momentum) = swept(robot, positions, rates);
    balance.twist(&momentum.less(angular_momentum))
}

/// The base's angular velocity `ω = rate + I⁻¹ h` along base axes for every angular momentum `h` along these
/// axes.
#[derive(Debug, Clone, Copy)]
pub struct BaseResponse<T> {
    /// With zero total momentum \[rad/s\].
    pub rate: Vec3<T>,
    /// Inverse of the whole system's inertia about its centre of mass \[1/(kg·m²)\].
    pub inverse_inertia: Sym3<T>,
}

impl<T: Scalar> BaseResponse<T> {
    /// For joint positions \[rad or m\] and rates \[rad/s or m/s\].
    #[inline(always)]
    pub fn of(robot: &Robot, positions: &[T], rates: &[T]) -> Self {
        let (balance, momentum) = swept(robot, positions, rates);
        Self { rate: balance.angular(&momentum), inverse_inertia: balance.inverse }
    }

    /// `ω` with an angular momentum along base axes.
    #[inline(always)]
    pub fn with(&self, angular_momentum: Vec3<T>) -> Vec3<T> {
        self.rate + self.inverse_inertia * angular_momentum
    }
}

/// Total angular momentum \[N·m·s\], along base axes, of a robot whose joints stand still while its base turns at this
/// rate \[rad/s\].
pub fn locked_momentum(robot: &Robot, positions: &[f64], rate: Vec3<f64>) -> Vec3<f64> {
    let mut system = RigidBody::base(robot);
    for link in Outward::<_>::new(robot, positions) {
        system += RigidBody::link(&link);
    }
    system.about_centre().1 * rate
}

#[inline(always)]
fn swept<T: Scalar>(robot: &Robot, positions: &[T], rates: &[T]) -> (Balance<T>, Momentum<T>) {
    if robot.is_plain() {
        sweep::<T, true>(robot, positions, rates, |_, _| {})
    } else {
        sweep::<T, false>(robot, positions, rates, |_, _| {})
    }
}

/// One link with the base held still.
#[derive(Debug, Clone)]
pub(crate) struct MovedLink<T> {
    /// The twist for unit rate of its joint, zero where that is fixed.
    pub(crate) screw: Twist<T>,
    pub(crate) twist: Twist<T>,
    pub(crate) body: RigidBody<T>,
}

/// The outward sweep with the base held still: the whole system and the links' momentum; `each` is told
/// every link.
#[inline(always)]
pub(crate) fn sweep<T: Scalar, const PLAIN: bool>(
    robot: &Robot,
    positions: &[T],
    rates: &[T],
    mut each: impl FnMut(&LinkPose<'_, T>, MovedLink<T>),
) -> (Balance<T>, Momentum<T>) {
    let mut system = RigidBody::base(robot);
    let mut momentum = Momentum::zero();
    let mut twists = Inherited::new(robot, Twist::zero());
    let mut outward = Outward::<T, PLAIN>::new(robot, positions);
    let mut joint = 0;
    for i in 0..robot.links().len() {
        // Not by `for link in outward`, which would not be inlined.
        let Some(link) = outward.next() else { break };
        let screw = link.screw::<PLAIN>();
        if PLAIN {
            twists.current += screw * rates[i];
        } else {
            twists.enter(robot, i);
            if link.link.joint.axis().is_some() {
                twists.current += screw * rates[joint];
                joint += 1;
            }
            twists.leave(robot, i);
        }
        let twist = twists.current;
        let body = RigidBody::link(&link);
        momentum += body.momentum(&twist);
        system += body;
        each(&link, MovedLink { screw, twist, body });
    }
    (system.balance(), momentum)
}

impl<T: Scalar> LinkPose<'_, T> {
    /// The twist for unit rate of the link's joint, zero where that is fixed.
    #[inline(always)]
    fn screw<const PLAIN: bool>(&self) -> Twist<T> {
        let turn = Twist { linear: self.frame.position.cross(self.axis), angular: self.axis };
        match self.link.joint {
            _ if PLAIN => turn,
            Joint::Revolute(_) => turn,
            Joint::Prismatic(_) => Twist { linear: self.axis, angular: Vec3::zero() },
            Joint::Fixed => Twist::zero(),
        }
    }
}

impl<T: Scalar> Twist<T> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self { linear: Vec3::zero(), angular: Vec3::zero() }
    }

    /// `S × t`: how a twist changes that turns with the screw `S`.
    #[inline(always)]
    pub(crate) fn turned(&self, twist: &Self) -> Self {
        let Self { linear, angular } = self;
        Self {
            linear: angular.cross(twist.linear) + linear.cross(twist.angular),
            angular: angular.cross(twist.angular),
        }
    }

    /// `S ×* H`: how a momentum changes that turns with the screw `S`.
    #[inline(always)]
    pub(crate) fn turned_momentum(&self, momentum: &Momentum<T>) -> Momentum<T> {
        let Self { linear, angular } = self;
        Momentum {
            linear: angular.cross(momentum.linear),
            angular: angular.cross(momentum.angular) + linear.cross(momentum.linear),
        }
    }
}

impl<T: Scalar> Mul<T> for Twist<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }
}

impl<T: Scalar> AddAssign for Twist<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

/// Linear and angular momentum about the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Momentum<T> {
    pub(crate) linear: Vec3<T>,
    pub(crate) angular: Vec3<T>,
}

impl<T: Scalar> Momentum<T> {
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self { linear: Vec3::zero(), angular: Vec3::zero() }
    }

    /// What is left once the system has an angular momentum, and no linear one.
    #[inline(always)]
    pub(crate) fn less(self, angular: Vec3<T>) -> Self {
        Self { angular: self.angular - angular, ..self }
    }
}

impl<T: Scalar> AddAssign for Momentum<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.linear += other.linear;
        self.angular += other.angular;
    }
}

impl<T: Scalar> SubAssign for Momentum<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.linear -= other.linear;
        self.angular -= other.angular;
    }
}

/// Mass, first moment and inertia, about the origin, of one body or of some that move as one. No
/// configuration changes a mass: it is the same in every lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidBody<T> {
    mass: f64,
    first_moment: Vec3<T>,
    inertia: Sym3<T>,
}

impl<T: Scalar> RigidBody<T> {
    #[inline(always)]
    fn none() -> Self {
        Self { mass: 0.0, first_moment: Vec3::zero(), inertia: Sym3::zero() }
    }

    #[inline(always)]
    pub(crate) fn base(robot: &Robot) -> Self {
        let Body { mass, inertia, .. } = robot.base();
        Self { mass: *mass, first_moment: Vec3::zero(), inertia: Sym3::of(inertia) }
    }

    #[inline(always)]
    fn link(link: &LinkPose<'_, T>) -> Self {
        let &Body { mass, ref inertia, .. } = &link.link.body;
        let first_moment = link.centre_of_mass.times(mass);
        let mut body =
            Self { mass, first_moment, inertia: link.frame.rotation.congruent(Sym3::of(inertia)) };
        body.inertia += Sym3::point(link.centre_of_mass, first_moment);
        body
    }

    #[inline(always)]
    pub(crate) fn momentum(&self, twist: &Twist<T>) -> Momentum<T> {
        Momentum {
            linear: twist.linear.times(self.mass) + twist.angular.cross(self.first_moment),
            angular: self.inertia * twist.angular + self.first_moment.cross(twist.linear),
        }
    }

    /// Ready to answer what twist of the whole balances a momentum.
    #[inline(always)]
    fn balance(&self) -> Balance<T> {
        let (centre, inertia) = self.about_centre();
        let (adjugate, determinant) = inertia.adjugate();
        let inverse = adjugate * (T::of(1.0) / determinant);
        Balance { per_mass: 1.0 / self.mass, centre, inverse }
    }

    /// The centre of mass, and the inertia about it.
    #[inline(always)]
    fn about_centre(&self) -> (Vec3<T>, Sym3<T>) {
        let centre = self.first_moment.times(1.0 / self.mass);
        let mut inertia = self.inertia;
        inertia -= Sym3::point(centre, self.first_moment);
        (centre, inertia)
    }
}

impl<T: Scalar> AddAssign for RigidBody<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.mass += other.mass;
        self.first_moment += other.first_moment;
        self.inertia += other.inertia;
    }
}

/// A rigid system that answers a momentum with the twist that takes it away.
pub(crate) struct Balance<T> {
    /// Inverse of the mass.
    per_mass: f64,
    /// Centre of mass.
    centre: Vec3<T>,
    /// Inverse of the inertia about it.
    inverse: Sym3<T>,
}

impl<T: Scalar> Balance<T> {
    #[inline(always)]
    fn angular(&self, momentum: &Momentum<T>) -> Vec3<T> {
        self.inverse * (self.centre.cross(momentum.linear) - momentum.angular)
    }

    #[inline(always)]
    pub(crate) fn twist(&self, momentum: &Momentum<T>) -> Twist<T> {
        let angular = self.angular(momentum);
        let linear = self.centre.cross(angular) - momentum.linear.times(self.per_mass);
        Twist { linear, angular }
    }
}

/// `J_bm` of eq. 7 (with the sign the paper drops): the base's twist for unit rate of each joint.
pub fn base_map(robot: &Robot, positions: &[f64]) -> Jacobian {
    let n = robot.joint_count();
    let mut rates = vec![0.0; n];
    let mut map = Jacobian::zeros(n);
    for (i, mut column) in map.column_iter_mut().enumerate() {
        rates[i] = 1.0;
        let Twist { linear: v, angular: w } = base_twist(robot, positions, &rates);
        rates[i] = 0.0;
        column.copy_from(&Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z));
    }
    map
}

/// `J_g = J_m + J_b J_bm`: the tool's twist for the joint rates while the base floats.
pub fn generalised_jacobian(robot: &Robot, positions: &[f64]) -> Jacobian {
    manipulator_jacobian(robot, positions)
        + base_jacobian(robot, positions) * base_map(robot, positions)
}

/// Total linear \[N·s\] and angular momentum about the base's centre of mass \[N·m·s\], term by term
/// as in eq. 5; zero for the twist that [`base_twist`] gives.
pub fn total_momentum(
    robot: &Robot,
    positions: &[f64],
    rates: &[f64],
    base: &Twist<f64>,
) -> (Vec3<f64>, Vec3<f64>) {
    let mut linear = base.linear * robot.base().mass;
    let mut angular = Sym3::of(&robot.base().inertia) * base.angular;
    let links: Vec<_> = Outward::<_>::new(robot, positions).collect();
    let mut own_rates = vec![0.0; links.len()];
    for (joint, rate) in robot.joints().zip(rates) {
        own_rates[joint.link] = *rate;
    }
    for (i, link) in links.iter().enumerate() {
        let r = link.centre_of_mass;
        let (mut v, mut w) = (base.linear + base.angular.cross(r), base.angular);
        for inner in robot.chain_to(i) {
            let (joint, rate) = (&links[inner], own_rates[inner]);
            match joint.link.joint {
                Joint::Revolute(_) => {
                    v += (joint.axis * rate).cross(r - joint.frame.position);
                    w += joint.axis * rate;
                }
                Joint::Prismatic(_) => v += joint.axis * rate,
                Joint::Fixed => {}
            }
        }
        let rotation = link.frame.rotation;
        let momentum = v * link.link.body.mass;
        let spin = rotation.tr_mul(w);
        linear += momentum;
        angular += rotation * (Sym3::of(&link.link.body.inertia) * spin) + r.cross(momentum);
    }
    (linear, angular)
}
