//! What an optimiser sees: a box and a cost, with derivatives where the problem has them.

use nalgebra::DMatrix;

use super::evaluation::Evaluation;
use super::failure::Failure;
use super::points::{Bounds, Points};
use super::rng::Rng;
use super::subgradient::Subgradient;
use super::terms::{Linearisation, Multipliers, PieceId};
use super::timed::{Bend, Bent, ErrorSlopes, Fold, LinearLimits, TimedParts, TimedWeights};
use super::watch::Watch;

/// A box-bounded minimisation problem.
pub trait Problem: Send + Sync {
    /// The box; its length is the problem's dimension.
    fn bounds(&self) -> &Bounds;

    /// The cost of one point of the box, which has as many components as the box has variables. A failure
    /// ends the run; what it found before is kept.
    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure>;

    /// The cost of many points: `each` is told every one as soon as it is known, in their order, and as
    /// many as there are points.
    fn evaluate_batch(
        &self,
        points: &Points,
        each: &mut dyn FnMut(Evaluation),
    ) -> Result<(), Failure> {
        for x in points {
            each(self.evaluate(x)?);
        }
        Ok(())
    }

    /// Makes what all evaluations share, so that it is no part of the time of the first. An evaluation that takes long may look
    /// whether `watch` is interrupted, and fail then.
    fn prepare(&self, watch: &Watch) {
        let _ = watch;
    }

    /// The least cost in the box, where it is known.
    fn least_cost(&self) -> Option<f64> {
        None
    }

    /// The same problem with derivatives, where it has them; always or never.
    fn composite(&self) -> Option<&dyn Composite> {
        None
    }

    /// The same problem with its time and linear limits, where it has them; always or never.
    fn timed(&self) -> Option<&dyn Timed> {
        None
    }

    /// The same problem in fewer variables, where there is one to search first; always or never.
    fn coarser(&self) -> Option<&dyn Coarse> {
        None
    }

    /// The same problem in the same variables without some of its limits, where minima are sooner found there and are good
    /// starts; always or never.
    fn relaxed(&self) -> Option<&dyn Problem> {
        None
    }

    /// Where subgradients of the cost come from, where the problem has them; always or never. Those of a composite or a
    /// timed cost follow from its parts.
    fn slopes(&self) -> Option<Slopes<'_>> {
        let timed = || self.timed().map(Slopes::Timed);
        self.composite().map(Slopes::Composite).or_else(timed)
    }
}

/// A problem over some points of a finer one, in fewer variables and at the same cost, up to how finely each evaluates it.
///
/// It has derivatives where the finer one has, and the same terms and weights.
pub trait Coarse: Problem {
    /// The point of the finer problem, within its box, that a point is: affine in it.
    fn prolong(&self, x: &[f64]) -> Vec<f64>;
}

/// Where subgradients come from.
#[derive(Clone, Copy)]
#[expect(missing_debug_implementations, reason = "a problem need not be printable")]
pub enum Slopes<'a> {
    /// The terms of the cost.
    Composite(&'a dyn Composite),
    /// The parts of a timed cost.
    Timed(&'a dyn Timed),
    /// The problem itself.
    Own(&'a dyn Differentiable),
}

impl Slopes<'_> {
    /// The cost at a point of the box, with a subgradient.
    pub fn at(self, x: &[f64]) -> Result<Subgradient, Failure> {
        match self {
            Self::Composite(problem) => Ok(problem.linearise(x)?.subgradient(x.len())),
            Self::Timed(problem) => Ok(problem.weights().subgradient(&problem.parts(x)?)),
            Self::Own(problem) => problem.subgradient(x),
        }
    }
}

/// A cost whose subgradients a problem works out itself, because it has no terms to tell of.
pub trait Differentiable: Problem {
    /// The cost at a point of the box, with a subgradient. The cost is that of [`evaluate`](Problem::evaluate), to
    /// rounding.
    fn subgradient(&self, x: &[f64]) -> Result<Subgradient, Failure>;
}

/// A cost that is a sum of convex functions of smooth pieces, `J(x) = Σ_k w_k φ_k(v_k(x))`.
pub trait Composite: Problem {
    /// Values and first derivatives of all pieces that matter near `x`. Its cost is that of
    /// [`evaluate`](Problem::evaluate), to rounding.
    fn linearise(&self, x: &[f64]) -> Result<Linearisation, Failure>;

    /// Second derivative of `Σ_k Σ_i λ_ki v_ki` at `x`, `n × n` for `n` variables and symmetric, to a few digits;
    /// the pieces are ones that [`linearise`](Self::linearise) named there.
    fn curvature(&self, x: &[f64], multipliers: &Multipliers) -> Result<DMatrix<f64>, Failure>;
}

/// A cost `w_T T(x) + w_r ‖r(x)‖ + w_s s(x)` of a smooth error `r`, the least time `T ≥ 0` and the least excess
/// `s ≥ 0` that functions linear in `x`, each of few variables, leave:
///
/// ```text
/// |ℓ_i(x)| ≤ T^p_i    p_i = 1, 2 or 3
/// |ℓ_i(x)| ≤ 1 + s    p_i = 0
/// ```
///
/// There may be infinitely many `ℓ_i`, such as the values of a polynomial at all places of an interval. Time and excess
/// are those of all of them. Smooth functions of any variables may bound the time, too, and maxima of such functions may be added
/// to the cost.
pub trait Timed: Problem {
    /// Time and excess of a point, and the `ℓ_i` that they may follow from there.
    fn limits(&self, x: &[f64]) -> Result<LinearLimits, Failure>;

    /// The error at a point. With [`limits`](Self::limits) and [`bent`](Self::bent) its cost is that of
    /// [`evaluate`](Problem::evaluate), to rounding.
    fn error(&self, x: &[f64]) -> Result<ErrorSlopes, Failure>;

    /// All else that the cost follows from; nothing by default.
    fn bent(&self, x: &[f64]) -> Result<Bent, Failure> {
        let _ = x;
        Ok(Bent::default())
    }

    /// All parts of the cost.
    fn parts(&self, x: &[f64]) -> Result<TimedParts, Failure> {
        Ok(TimedParts { limits: self.limits(x)?, error: self.error(x)?, bent: self.bent(x)? })
    }

    /// How the error's slopes change along a few directions, those in which steps go far; elsewhere
    /// the search takes the error for linear.
    /// The directions are orthonormal.
    fn bends(&self, x: &[f64]) -> Result<Vec<Bend>, Failure>;

    /// Positive parts of the second derivative of the sum of some pieces of [`bent`](Self::bent), each times its multiplier;
    /// none by default.
    fn folds(&self, x: &[f64], multipliers: &[(PieceId, f64)]) -> Result<Vec<Fold>, Failure> {
        let _ = (x, multipliers);
        Ok(Vec::new())
    }

    /// The same at every point.
    fn weights(&self) -> TimedWeights;

    /// A random point to search from, a simple one for a spread of zero, one from all over the box for a spread of one.
    /// Points drawn variable by variable may all be poor, where neighbours belong together.
    fn start(&self, rng: &mut Rng, spread: f64) -> Vec<f64>;
}
