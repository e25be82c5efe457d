//! First derivatives of the time-free cost, for optimisers that use them.

use nalgebra::{DMatrix, DVector, Matrix3};

use super::{Formulated, Problem, Reorientation};
use crate::attitude::net_rotation_slopes;
use crate::task::Task;
use crate::trajectory::{LocalPeak, Path, Peaks, duration_asked};

/// A cost that is convex in smooth parts: `J(x) = a ‖r(x)‖ + b max_p h_p(x)`.
pub trait Composite: Problem {
    /// Values and first derivatives of all parts that matter near `x`.
    fn linearise(&self, x: &[f64]) -> Linearisation;
}

/// Values and first derivatives at a point.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// `a`.
    pub norm_weight: f64,
    /// `r`.
    pub residual: DVector<f64>,
    /// One row a component of `r`, one column a variable.
    pub residual_jacobian: DMatrix<f64>,
    /// `b`.
    pub max_weight: f64,
    /// The `h_p` that are largest or not far from it.
    pub pieces: Vec<Piece>,
}

/// One `h_p`.
#[derive(Debug, Clone)]
pub struct Piece {
    /// What tells it from the others, the same at points that are near.
    pub place: LocalPeak,
    /// Value.
    pub value: f64,
    /// Derivative by each variable.
    pub gradient: DVector<f64>,
}

/// How far below the largest, as a share of it, a part may lie to be linearised too.
const NEAR: f64 = 0.75;

impl Reorientation {
    /// The time-free cost's parts: the vector part of the base's error, and the duration that each
    /// local peak of rate, acceleration and jerk asks for.
    pub(super) fn linearise(&self, coefficients: &[f64]) -> Linearisation {
        let path = self.family().path(coefficients);
        let (residual, residual_jacobian) = self.base_error_slopes(&path);
        let limits = &self.task().limits;
        let places = Peaks::local(&path, self.accuracy().peak_intervals, limits, NEAR);
        let pieces = places.into_iter().map(|place| self.piece(&path, place));
        let (norm_weight, max_weight) = self.weights();
        Linearisation {
            norm_weight,
            residual,
            residual_jacobian,
            max_weight,
            pieces: pieces.collect(),
        }
    }

    /// The base's error and its derivatives.
    fn base_error_slopes(&self, path: &Path<'_, f64>) -> (DVector<f64>, DMatrix<f64>) {
        let Task { robot, start, goal, .. } = &**self.task();
        let net = net_rotation_slopes(robot, path, self.accuracy().attitude_steps);
        let error = goal.base.inverse() * start.base * net.rotation;
        let residual = error.imag();
        // q ⊗ (0, ½ e) has the vector part ½ (q_w e + q_v × e).
        let by_turn = (Matrix3::from_diagonal_element(error.w) + residual.cross_matrix()) / 2.0;
        let jacobian = by_turn * net.by_coefficient;
        let jacobian = DMatrix::from_column_slice(3, jacobian.ncols(), jacobian.as_slice());
        (DVector::from_column_slice(residual.as_slice()), jacobian)
    }

    /// The duration that one limit asks for at one place of the path, and its derivatives.
    fn piece(&self, path: &Path<'_, f64>, place: LocalPeak) -> Piece {
        let LocalPeak { joint: index, order, tau } = place;
        let joint = path.joint(index);
        let limit = self.task().limits.0[index][order - 1];
        let derivative = joint.derivatives(tau)[order];
        let value = duration_asked(derivative.abs() / limit, order);
        let by_derivative = value / (order as f64 * derivative);
        let terms = path.basis().terms();
        let mut gradient = DVector::zeros(self.family().dimension());
        for (k, slope) in joint.coefficient_slopes(order, tau).enumerate() {
            gradient[index * terms + k] = by_derivative * slope;
        }
        Piece { place, value, gradient }
    }
}

impl Composite for Formulated {
    fn linearise(&self, x: &[f64]) -> Linearisation {
        self.task().linearise(x)
    }
}
