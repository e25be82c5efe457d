//! The base's rate at one time of a path a lane, and how it follows the joints' phases.

use crate::lanes::Lanes;
use crate::momentum::RateSlopes;
use crate::robot::Robot;
use crate::trajectory::{AtPhase, Family};
use crate::vec3::Vec3;

/// The base's rate `ω` \[rad\], by normalised time, with its derivatives by each joint's phase `s` and
/// by `s'`.
pub(super) struct Node<T> {
    pub(super) rate: Vec3<T>,
    /// `∂ω/∂s`.
    pub(super) by_phase: Vec<Vec3<T>>,
    /// `∂ω/∂s'`.
    pub(super) by_phase_rate: Vec<Vec3<T>>,
}

/// Room to evaluate nodes in.
pub(super) struct Evaluator<'a, T, F> {
    robot: &'a Robot,
    family: &'a F,
    joints: Vec<AtPhase<T>>,
    angles: Vec<T>,
    rates: Vec<T>,
    slopes: RateSlopes<T>,
}

impl<'a, T: Lanes, F: Family> Evaluator<'a, T, F> {
    #[inline(always)]
    pub(super) fn new(robot: &'a Robot, family: &'a F) -> Self {
        let joints = robot.joint_count();
        let zeros = vec![T::of(0.0); joints];
        Self {
            robot,
            family,
            joints: Vec::with_capacity(joints),
            angles: zeros.clone(),
            rates: zeros,
            slopes: RateSlopes::new(robot),
        }
    }

    /// The phases of all joints, with their derivatives, from a place in a grid on.
    #[inline(always)]
    pub(super) fn phases(
        &self,
        nodes: &F::Nodes,
        place: usize,
        coefficients: &[f64],
    ) -> Vec<[T; 2]> {
        let mut phases = Vec::with_capacity(self.family.joints());
        for joint in 0..self.family.joints() {
            let own = &coefficients[self.family.coefficients_of(joint)];
            phases.push(self.family.phase(nodes, place, joint, own));
        }
        phases
    }

    /// The node where joints have these phases, whether a path meets them or not.
    #[inline(always)]
    pub(super) fn evaluate(&mut self, phases: &[[T; 2]]) -> Node<T> {
        self.joints.clear();
        for (joint, &phase) in phases.iter().enumerate() {
            let at = self.family.at_phase(joint, phase);
            (self.angles[joint], self.rates[joint]) = (at.angle, at.rate);
            self.joints.push(at);
        }
        self.slopes.evaluate(self.robot, &self.angles, &self.rates);
        let mut node = Node {
            rate: self.slopes.angular,
            by_phase: Vec::with_capacity(phases.len()),
            by_phase_rate: Vec::with_capacity(phases.len()),
        };
        for (joint, at) in self.joints.iter().enumerate() {
            let (by_angle, by_rate) = (self.slopes.by_position[joint], self.slopes.by_rate[joint]);
            node.by_phase.push(by_angle * at.angle_slope + by_rate * at.rate_slope);
            node.by_phase_rate.push(by_rate * at.angle_slope);
        }
        node
    }
}
