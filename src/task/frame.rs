//! The axes that places are stated in, and how they are turned.

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};

use crate::input::Finite;

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

/// The attitude that yaw, pitch and roll \[°\] lead to.
pub(super) fn attitude(zyx_deg: [Finite; 3]) -> UnitQuaternion<f64> {
    let [yaw, pitch, roll] = zyx_deg.map(|angle| angle.0.to_radians());
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}
