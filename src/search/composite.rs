//! First and second derivatives, for optimisers that use them.

use nalgebra::DMatrix;

use super::failure::Failure;
use super::problem::Problem;
use super::terms::{Linearisation, Multipliers};

/// A cost that is a sum of convex functions of smooth pieces, `J(x) = Σ_k w_k φ_k(v_k(x))`.
pub trait Composite: Problem {
    /// Values and first derivatives of all pieces that matter near `x`. Its cost is that of
    /// [`evaluate`](Problem::evaluate), to rounding.
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure>;

    /// Second derivative of `Σ_k Σ_i λ_ki v_ki` at `x`, symmetric, to a few digits; the pieces are ones that
    /// [`linearise`](Self::linearise) named there.
    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure>;
}
