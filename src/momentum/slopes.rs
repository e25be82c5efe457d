//! First derivatives of the base's angular velocity, in closed form.

use super::{Momentum, MovedLink, RigidBody, sweep};
use crate::kinematics::LinkPose;
use crate::robot::{Gathered, Robot};
use crate::scalar::Scalar;
use crate::vec3::Vec3;

/// The base's angular velocity with its derivatives by every joint's position and rate.
///
/// Moving joint `j` moves all bodies outward of it as one. With `t` the inertial twist of link `j`,
/// `H` and `I` momentum and inertia of all bodies outward of the joint, and `S` its screw, momentum
/// changes by `S ×* H − I (S × t)` while nothing else moves; the base answers as it answers any
/// momentum.
#[derive(Debug, Clone)]
pub struct RateSlopes<T> {
    /// `ω_b` \[rad/s\].
    pub angular: Vec3<T>,
    /// `∂ω_b/∂θ_j` \[1/s\].
    pub by_position: Vec<Vec3<T>>,
    /// `∂ω_b/∂θ̇_j`: the angular half of `J_bm` (eq. 7).
    pub by_rate: Vec<Vec3<T>>,
    links: Vec<MovedLink<T>>,
}

impl<T: Scalar> RateSlopes<T> {
    /// Room for the derivatives of one robot.
    pub fn new(robot: &Robot) -> Self {
        let zeros = vec![Vec3::zero(); robot.joint_count()];
        Self {
            angular: Vec3::zero(),
            by_position: zeros.clone(),
            by_rate: zeros,
            links: Vec::with_capacity(robot.links().len()),
        }
    }

    /// Evaluates at joint positions \[rad or m\] and rates \[rad/s or m/s\] with zero total momentum.
    #[inline(always)]
    pub fn evaluate(&mut self, robot: &Robot, positions: &[T], rates: &[T]) {
        self.evaluate_drifting(robot, positions, rates, Vec3::zero());
    }

    /// The same with a total angular momentum \[N·m·s\] about the system's centre of mass, along base axes, that derivatives
    /// leave as it is.
    #[inline(always)]
    pub fn evaluate_drifting(
        &mut self,
        robot: &Robot,
        positions: &[T],
        rates: &[T],
        angular_momentum: Vec3<T>,
    ) {
        if robot.is_plain() {
            self.evaluate_as::<true>(robot, positions, rates, angular_momentum);
        } else {
            self.evaluate_as::<false>(robot, positions, rates, angular_momentum);
        }
    }

    #[inline(always)]
    fn evaluate_as<const PLAIN: bool>(
        &mut self,
        robot: &Robot,
        positions: &[T],
        rates: &[T],
        angular_momentum: Vec3<T>,
    ) {
        self.links.clear();
        let each = |_: &LinkPose<'_, T>, link| self.links.push(link);
        let (balance, momentum) = sweep::<T, PLAIN>(robot, positions, rates, each);
        let base = balance.twist(&momentum.less(angular_momentum));
        self.angular = base.angular;

        let mut bodies = Gathered::new(robot, RigidBody::none());
        let mut momenta = Gathered::new(robot, Momentum::zero());
        let mut joint = self.by_position.len();
        for (i, MovedLink { screw, twist, body }) in self.links.iter().enumerate().rev() {
            let mut twist = *twist;
            twist += base;
            if !PLAIN {
                bodies.enter(robot, i);
                momenta.enter(robot, i);
            }
            bodies.current += *body;
            momenta.current += body.momentum(&twist);
            if PLAIN || robot.links()[i].joint.axis().is_some() {
                joint -= 1;
                let mut change = screw.turned_momentum(&momenta.current);
                change -= bodies.current.momentum(&screw.turned(&twist));
                self.by_position[joint] = balance.angular(&change);
                self.by_rate[joint] = balance.angular(&bodies.current.momentum(screw));
            }
            if !PLAIN {
                bodies.leave(robot, i);
                momenta.leave(robot, i);
            }
        }
    }
}
