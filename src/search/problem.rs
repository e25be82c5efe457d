//! What an optimiser sees: a box and a cost.

use super::composite::Composite;
use super::failure::Failure;
use super::points::{Bounds, Points};

/// A box-bounded minimisation problem.
pub trait Problem: Send + Sync {
    /// The box; its length is the problem's dimension.
    fn bounds(&self) -> &Bounds;

    /// The cost of one point of the box. A failure ends the run; what it found before is kept.
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

    /// The least cost in the box, where it is known.
    fn least_cost(&self) -> Option<f64> {
        None
    }

    /// The same problem with derivatives, where it has them.
    fn composite(&self) -> Option<&dyn Composite> {
        None
    }
}

/// What one evaluation says.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evaluation {
    /// The cost to be made small. One that is infinite or NaN is never best.
    pub cost: f64,
    /// How far outside its limits the point is, zero when inside.
    pub violation: f64,
}

impl Evaluation {
    /// A cost, and by how much limits are violated.
    pub fn new(cost: f64, violation: f64) -> Self {
        Self { cost, violation }
    }
}

/// A cost within all limits.
impl From<f64> for Evaluation {
    fn from(cost: f64) -> Self {
        Self::new(cost, 0.0)
    }
}
