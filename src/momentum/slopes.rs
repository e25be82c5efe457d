//! First derivatives of the base's angular velocity, in closed form.

use super::{Link, Momentum, RigidBody, sweep};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::vec3::Vec3;

/// The base's angular velocity with its derivatives by every joint's angle and rate.
///
/// Turning joint `j` moves its screw's outer bodies as one. With `t` the inertial twist of link `j`,
/// `H` and `I` momentum and inertia of all bodies outward of the joint, and `S` its screw, momentum
/// changes by `S ×* H − I (S × t)` while nothing else moves; the base answers as it answers any
/// momentum.
#[derive(Debug, Clone)]
pub struct RateSlopes<T> {
    /// `ω_b` \[rad/s\].
    pub angular: Vec3<T>,
    /// `∂ω_b/∂θ_j` \[1/s\].
    pub by_angle: Vec<Vec3<T>>,
    /// `∂ω_b/∂θ̇_j`: the angular half of `J_bm` (eq. 7).
    pub by_rate: Vec<Vec3<T>>,
    links: Vec<Link<T>>,
}

impl<T: Scalar> RateSlopes<T> {
    /// Room for the derivatives of one robot.
    pub fn new(robot: &Robot) -> Self {
        let zeros = vec![Vec3::zero(); robot.joint_count()];
        Self {
            angular: Vec3::zero(),
            by_angle: zeros.clone(),
            by_rate: zeros,
            links: Vec::with_capacity(robot.joint_count()),
        }
    }

    /// Evaluates at joint angles \[rad\] and rates \[rad/s\] with zero total momentum.
    #[inline(always)]
    pub fn evaluate(&mut self, robot: &Robot, angles: &[T], rates: &[T]) {
        self.links.clear();
        let (balance, momentum) = sweep(robot, angles, rates, |link| self.links.push(link));
        let base = balance.twist(&momentum);
        self.angular = base.angular;

        let mut outer = RigidBody::none();
        let mut momentum = Momentum::zero();
        for (j, Link { screw, twist, body }) in self.links.iter().enumerate().rev() {
            let mut twist = *twist;
            twist += base;
            outer += *body;
            momentum += body.momentum(&twist);
            let mut change = screw.turned_momentum(&momentum);
            change -= outer.momentum(&screw.turned(&twist));
            self.by_angle[j] = balance.angular(&change);
            self.by_rate[j] = balance.angular(&outer.momentum(screw));
        }
    }
}
