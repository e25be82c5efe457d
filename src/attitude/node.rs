//! The base's rate at one time of a path per lane, and how it follows the joints' phases.

use crate::lanes::Lanes;
use crate::momentum::{BaseResponse, RateSlopes};
use crate::robot::Robot;
use crate::trajectory::{AtPhase, Family};
use crate::vec3::Vec3;

/// The base's rate `ω` \[rad\], by normalised time, with its derivatives.
pub(super) struct Node<T> {
    pub(super) rate: Vec3<T>,
    /// One per joint.
    pub(super) joints: Vec<PhaseSlopes<T>>,
}

/// Derivatives of the base's rate by one joint's phase `s`.
#[derive(Clone, Copy)]
pub(super) struct PhaseSlopes<T> {
    /// `∂ω/∂s`.
    pub(super) by_phase: Vec3<T>,
    /// `∂ω/∂s'`.
    pub(super) by_phase_rate: Vec3<T>,
}

impl<T: Lanes> Node<T> {
    /// Room for one.
    #[inline(always)]
    pub(super) fn new(joints: usize) -> Self {
        let slopes = PhaseSlopes { by_phase: Vec3::zero(), by_phase_rate: Vec3::zero() };
        Self { rate: Vec3::zero(), joints: vec![slopes; joints] }
    }
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
        phases: &mut Vec<[T; 2]>,
    ) {
        phases.clear();
        for joint in 0..self.family.joints() {
            let own = &coefficients[self.family.coefficients_of(joint)];
            phases.push(self.family.phase(nodes, place, joint, own));
        }
    }

    /// The node where joints have these phases, whether a path meets them or not.
    #[inline(always)]
    pub(super) fn evaluate(&mut self, phases: &[[T; 2]], node: &mut Node<T>) {
        self.evaluate_drifting(phases, Vec3::zero(), node);
    }

    /// The same with a scaled momentum along base axes, whatever turns these.
    #[inline(always)]
    pub(super) fn evaluate_drifting(
        &mut self,
        phases: &[[T; 2]],
        scaled_momentum: Vec3<T>,
        node: &mut Node<T>,
    ) {
        self.move_to(phases);
        self.slopes.evaluate_drifting(self.robot, &self.angles, &self.rates, scaled_momentum);
        node.rate = self.slopes.angular;
        for (joint, at) in self.joints.iter().enumerate() {
            let (by_angle, by_rate) = (self.slopes.by_position[joint], self.slopes.by_rate[joint]);
            node.joints[joint] = PhaseSlopes {
                by_phase: by_angle * at.angle_slope + by_rate * at.rate_slope,
                by_phase_rate: by_rate * at.angle_slope,
            };
        }
    }

    /// How the base responds to any angular momentum where joints have these phases.
    #[inline(always)]
    pub(super) fn response(&mut self, phases: &[[T; 2]]) -> BaseResponse<T> {
        self.move_to(phases);
        BaseResponse::of(self.robot, &self.angles, &self.rates)
    }

    #[inline(always)]
    fn move_to(&mut self, phases: &[[T; 2]]) {
        self.joints.clear();
        for (joint, &phase) in phases.iter().enumerate() {
            let at = self.family.at_phase(joint, phase);
            (self.angles[joint], self.rates[joint]) = (at.angle, at.rate);
            self.joints.push(at);
        }
    }
}
