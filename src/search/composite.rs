//! First and second derivatives, for optimisers that use them.

use nalgebra::{DMatrix, DVector};

use super::failure::Failure;
use super::problem::Problem;
use crate::trajectory::LocalPeak;

/// A cost that is convex in smooth parts: `J(x) = a ‖r(x)‖ + b max_p h_p(x)`.
pub trait Composite: Problem {
    /// Values and first derivatives of all parts that matter near `x`.
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure>;

    /// Second derivative of `ν · r(x) + Σ λ_p h_p(x)`, to a few digits.
    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure>;
}

/// What the parts weigh in a Lagrangian.
#[derive(Debug, Clone)]
pub struct Multipliers {
    /// `ν`, of length `a` at most.
    pub residual: DVector<f64>,
    /// Each `λ_p` that is not zero.
    pub pieces: Vec<(LocalPeak, f64)>,
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

impl Linearisation {
    /// `J`.
    pub fn cost(&self) -> f64 {
        let longest = self.pieces.iter().map(|piece| piece.value).fold(0.0, f64::max);
        self.norm_weight * self.residual.norm() + self.max_weight * longest
    }
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
