//! How finely motions are evaluated.

use serde::Serialize;

use super::measure::Tables;
use crate::trajectory::Family;

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

    /// Twice the intervals, and twice the steps that tables made with this accuracy have.
    pub(super) fn twice<F: Family>(self, tables: &Tables<F>) -> Self {
        Self { attitude_steps: 2 * tables.rollout.steps(), peak_intervals: 2 * self.peak_intervals }
    }
}
