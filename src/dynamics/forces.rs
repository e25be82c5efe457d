//! Newton and Euler's equations along the tree (Featherstone 2008, doi:10.1007/978-1-4899-7560-7, sections 5.3 and 9.3).

use super::{Quantity, State};
use crate::kinematics::LinkPose;
use crate::momentum::{Balance, Momentum, MovedLink, RigidBody, Twist, sweep};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::vec3::Vec3;

/// Velocities, accelerations and torques of one state, in base axes, and the room to work them out.
///
/// Of axes that coincide with the base's at that time and stay where they are, accelerations are the twists'
/// derivatives there. Forces on the bodies are worked out as if the base's were zero; what all of them come to
/// gives the base's, as a momentum gives its twist, and with it what each joint's torque has to be beside.
#[derive(Debug, Clone)]
pub struct Dynamics<T> {
    /// Twist of the base.
    pub base: Twist<T>,
    /// Derivative of that.
    pub base_acceleration: Twist<T>,
    /// Velocity of the tool's origin \[m/s\].
    pub tool_velocity: Vec3<T>,
    /// Torque \[N·m\] or force \[N\] of each joint that moves.
    pub torques: Vec<T>,
    links: Vec<ForcedLink<T>>,
    /// For every joint the momentum of what is outward of it for unit rate.
    momenta: Vec<Momentum<T>>,
}

/// One link; on the way inward it takes in those that it carries.
#[derive(Debug, Clone)]
struct ForcedLink<T> {
    moved: MovedLink<T>,
    /// As if the base's were zero.
    acceleration: Twist<T>,
    /// Linear and angular, about the origin.
    force: Momentum<T>,
}

impl<T: Scalar> Dynamics<T> {
    /// Room for one robot.
    pub fn new(robot: &Robot) -> Self {
        Self {
            base: Twist::zero(),
            base_acceleration: Twist::zero(),
            tool_velocity: Vec3::zero(),
            torques: vec![T::of(0.0); robot.joint_count()],
            links: Vec::with_capacity(robot.links().len()),
            momenta: vec![Momentum::zero(); robot.joint_count()],
        }
    }

    /// Works out all there is, for the robot that the room is for.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions, rates or accelerations than joints that move.
    #[inline(always)]
    pub fn evaluate(&mut self, robot: &Robot, state: State<'_, T>) {
        let balance = self.evaluate_velocities(robot, state);
        self.evaluate_forces(robot, state, &balance);
    }

    /// Works out one quantity, and what of the others that takes.
    ///
    /// # Panics
    ///
    /// As [`evaluate`](Self::evaluate), but that only torques take accelerations; and when there is no such joint.
    #[inline(always)]
    pub fn value(&mut self, robot: &Robot, quantity: Quantity, state: State<'_, T>) -> T {
        let balance = self.evaluate_velocities(robot, state);
        if let Quantity::Torque(_) = quantity {
            self.evaluate_forces(robot, state, &balance);
        }
        self.get(quantity)
    }

    /// A quantity that has been worked out.
    ///
    /// # Panics
    ///
    /// Panics when there is no such joint.
    #[inline(always)]
    pub fn get(&self, quantity: Quantity) -> T {
        let norm = |v: Vec3<T>| v.dot(v).sqrt();
        match quantity {
            Quantity::BaseRate => norm(self.base.angular),
            Quantity::ToolSpeed => norm(self.tool_velocity),
            Quantity::Torque(joint) => self.torques[joint],
        }
    }

    #[inline(always)]
    fn evaluate_velocities(&mut self, robot: &Robot, state: State<'_, T>) -> Balance<T> {
        if robot.is_plain() {
            self.evaluate_velocities_as::<true>(robot, state)
        } else {
            self.evaluate_velocities_as::<false>(robot, state)
        }
    }

    /// All twists; and what answers forces as it answers momenta.
    #[inline(always)]
    fn evaluate_velocities_as<const PLAIN: bool>(
        &mut self,
        robot: &Robot,
        State { positions, rates, angular_momentum, .. }: State<'_, T>,
    ) -> Balance<T> {
        assert_eq!(rates.len(), robot.joint_count(), "one rate per joint");
        let tool = robot.tool();
        let mut at = Vec3::of(tool.placement.translation());
        let mut twist = Twist::zero();
        self.links.clear();
        let each = |pose: &LinkPose<'_, T>, moved: MovedLink<T>| {
            if tool.link == Some(self.links.len()) {
                at = pose.frame.position + pose.frame.rotation * at;
                twist = moved.twist;
            }
            let (acceleration, force) = (Twist::zero(), Momentum::zero());
            self.links.push(ForcedLink { moved, acceleration, force });
        };
        let (balance, momentum) = sweep::<T, PLAIN>(robot, positions, rates, each);
        self.base = balance.twist(&momentum.less(angular_momentum));
        twist += self.base;
        self.tool_velocity = twist.linear + twist.angular.cross(at);
        balance
    }

    #[inline(always)]
    fn evaluate_forces(
        &mut self,
        robot: &Robot,
        State { rates, accelerations, .. }: State<'_, T>,
        balance: &Balance<T>,
    ) {
        assert_eq!(accelerations.len(), robot.joint_count(), "one acceleration per joint");
        let mut joint = 0;
        for (i, link) in robot.links().iter().enumerate() {
            let mut acceleration = match link.parent {
                None => Twist::zero(),
                Some(parent) => self.links[parent].acceleration,
            };
            let own = &mut self.links[i];
            let MovedLink { screw, twist, body } = &mut own.moved;
            *twist += self.base;
            if link.joint.axis().is_some() {
                acceleration += *screw * accelerations[joint];
                acceleration += twist.turned(&(*screw * rates[joint]));
                joint += 1;
            }
            own.force = force(body, twist, &acceleration);
            own.acceleration = acceleration;
        }
        let mut total = force(&RigidBody::base(robot), &self.base, &Twist::zero());
        for (i, link) in robot.links().iter().enumerate().rev() {
            let ForcedLink { moved: MovedLink { screw, body, .. }, force, .. } = &self.links[i];
            let (body, force) = (*body, *force);
            if link.joint.axis().is_some() {
                joint -= 1;
                self.torques[joint] = screw.power(&force);
                self.momenta[joint] = body.momentum(screw);
            }
            match link.parent {
                None => total += force,
                Some(parent) => {
                    self.links[parent].force += force;
                    self.links[parent].moved.body += body;
                }
            }
        }
        self.base_acceleration = balance.twist(&total);
        for joint in 0..self.torques.len() {
            self.torques[joint] += self.base_acceleration.power(&self.momenta[joint]);
        }
    }
}

/// What a body's motion takes: the derivative of its momentum.
#[inline(always)]
fn force<T: Scalar>(body: &RigidBody<T>, twist: &Twist<T>, acceleration: &Twist<T>) -> Momentum<T> {
    let mut force = body.momentum(acceleration);
    force += twist.turned_momentum(&body.momentum(twist));
    force
}

impl<T: Scalar> Twist<T> {
    /// The power of a force on what moves so, both about the origin.
    #[inline(always)]
    fn power(&self, force: &Momentum<T>) -> T {
        self.linear.dot(force.linear) + self.angular.dot(force.angular)
    }
}

/// Torque \[N·m\] or force \[N\] of each joint that moves, with zero total momentum and nothing pulling from outside, at
/// positions \[rad or m\] with these derivatives.
///
/// # Panics
///
/// Panics when there are more or fewer positions, rates or accelerations than joints that move.
pub fn joint_torques(
    robot: &Robot,
    positions: &[f64],
    rates: &[f64],
    accelerations: &[f64],
) -> Vec<f64> {
    let mut dynamics = Dynamics::new(robot);
    dynamics
        .evaluate(robot, State { positions, rates, accelerations, angular_momentum: Vec3::zero() });
    dynamics.torques
}
