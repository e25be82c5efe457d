//! The axes that places are stated in.

use serde::{Deserialize, Serialize};

/// Axes whose origin is the base's centre of mass, that of the inertial ones where it is at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Frame {
    /// Inertial axes.
    #[default]
    Inertial,
    /// Base axes.
    Base,
}
