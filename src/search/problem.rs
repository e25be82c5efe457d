//! What an optimiser sees: a box and a cost.

use super::composite::Composite;
use super::points::{Bounds, Points};

/// A box-bounded minimisation problem.
pub trait Problem: Send + Sync {
    /// The box; its length is the problem's dimension.
    fn bounds(&self) -> &Bounds;

    /// The cost of one point of the box.
    fn evaluate(&self, x: &[f64]) -> Evaluation;

    /// The cost of many points: `each` is told every one as soon as it is known, in their order.
    fn evaluate_batch(&self, points: &Points, each: &mut dyn FnMut(Evaluation)) {
        for x in points {
            each(self.evaluate(x));
        }
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
    /// The cost to be made small.
    pub cost: f64,
    /// How far outside its limits the point is, zero when inside.
    pub violation: f64,
}
