//! Why a problem could not be evaluated.

use super::points::BoundsError;

/// A problem's reason for not evaluating a point, such as a simulator that died.
///
/// It ends the run. A point that is merely bad has an infinite or NaN cost instead: the run goes on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Failure {
    reason: String,
}

impl Failure {
    /// With the reason, as a user should read it.
    pub fn new(reason: impl Into<String>) -> Self {
        Self { reason: reason.into() }
    }

    /// The reason.
    pub fn reason(&self) -> &str {
        &self.reason
    }
}

impl From<String> for Failure {
    fn from(reason: String) -> Self {
        Self::new(reason)
    }
}

impl From<BoundsError> for Failure {
    fn from(error: BoundsError) -> Self {
        Self::new(error.to_string())
    }
}

impl From<&str> for Failure {
    fn from(reason: &str) -> Self {
        Self::new(reason)
    }
}
