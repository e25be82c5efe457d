//! The base's rate at one time of a path, and how it follows the joints' phases.

use nalgebra::{Matrix3, Matrix3xX, Vector3};

use crate::momentum::RateSlopes;
use crate::robot::Robot;
use crate::trajectory::{AtPhase, Basis, Path};

/// The base's rate at one time of a path, with its derivatives by each joint's phase `s` and by `s'`.
pub(super) struct Node {
    /// `s` and `s'` of each joint.
    pub(super) phases: Vec<[f64; 2]>,
    /// `∂ω/∂s`.
    pub(super) by_phase: Vec<Vector3<f64>>,
    /// `∂ω/∂s'`.
    pub(super) by_phase_rate: Vec<Vector3<f64>>,
    joints: Vec<AtPhase<f64>>,
    angles: Vec<f64>,
    rates: Vec<f64>,
    slopes: RateSlopes<f64>,
}

impl Node {
    pub(super) fn new(robot: &Robot) -> Self {
        let joints = robot.joint_count();
        let (numbers, vectors) = (vec![0.0; joints], vec![Vector3::zeros(); joints]);
        Self {
            phases: vec![[0.0; 2]; joints],
            by_phase: vectors.clone(),
            by_phase_rate: vectors,
            joints: Vec::with_capacity(joints),
            angles: numbers.clone(),
            rates: numbers,
            slopes: RateSlopes::new(robot),
        }
    }

    pub(super) fn evaluate(&mut self, robot: &Robot, path: &Path<'_, f64>, tau: f64) {
        for (phase, joint) in self.phases.iter_mut().zip(path.joints()) {
            *phase = joint.phase(tau);
        }
        self.evaluate_at_phases(robot, path);
    }

    /// The same at phases written before, whether the path meets them or not.
    pub(super) fn evaluate_at_phases(&mut self, robot: &Robot, path: &Path<'_, f64>) {
        self.joints.clear();
        self.joints.extend(path.joints().zip(&self.phases).map(|(joint, s)| joint.at_phase(*s)));
        for (j, at) in self.joints.iter().enumerate() {
            (self.angles[j], self.rates[j]) = (at.angle, at.rate);
        }
        self.slopes.evaluate(robot, &self.angles, &self.rates);
        for (j, at) in self.joints.iter().enumerate() {
            let (by_angle, by_rate) = (self.slopes.by_angle[j], self.slopes.by_rate[j]);
            self.by_phase[j] = by_angle * at.angle_slope + by_rate * at.rate_slope;
            self.by_phase_rate[j] = by_rate * at.angle_slope;
        }
    }

    /// `ω` \[rad\], by normalised time.
    pub(super) fn rate(&self) -> Vector3<f64> {
        self.slopes.angular
    }

    /// Adds `turn · ∂ω/∂c` for every coefficient `c` of the path.
    pub(super) fn add_slopes(
        &self,
        basis: &Basis,
        tau: f64,
        turn: &Matrix3<f64>,
        sum: &mut Matrix3xX<f64>,
    ) {
        for (k, [bump, bump_slope]) in basis.bumps(tau).enumerate() {
            let columns = (k..).step_by(basis.terms());
            for (j, column) in (0..self.joints.len()).zip(columns) {
                let change = self.by_phase[j] * bump + self.by_phase_rate[j] * bump_slope;
                let mut column = sum.column_mut(column);
                column += turn * change;
            }
        }
    }
}
