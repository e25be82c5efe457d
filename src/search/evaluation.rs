//! What comes of evaluating a point.

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
