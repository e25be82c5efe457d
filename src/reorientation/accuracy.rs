//! How finely motions are evaluated.

use serde::Serialize;

/// How finely a motion is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Accuracy {
    /// Magnus steps along the path, rounded up to threes; each costs two evaluations of the base's rate.
    pub attitude_steps: usize,
    /// Intervals in which peaks of rate, acceleration and jerk are bracketed.
    pub peak_intervals: usize,
}

impl Accuracy {
    /// What the evaluation of motions that are recorded and shown [begins with](super::Reorientation::certify): of most, exact
    /// to rounding.
    pub const FINE: Self = Self { attitude_steps: 402, peak_intervals: 1024 };
}
