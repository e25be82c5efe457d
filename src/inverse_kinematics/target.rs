//! Where the tool is to be.

use nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};

/// Where the tool is to be, in base axes.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolTarget {
    /// Where its origin is to be \[m\]; anywhere if nothing is said.
    pub position: Option<Vector3<f64>>,
    /// What positions are measured from.
    pub origin: Origin,
    /// How it is to be turned.
    pub orientation: Orientation,
}

impl ToolTarget {
    /// The same, turned in base axes.
    #[must_use]
    pub fn turned(&self, turn: &UnitQuaternion<f64>) -> Self {
        let orientation = match &self.orientation {
            Orientation::Any => Orientation::Any,
            Orientation::Axis { tool, direction } => {
                Orientation::Axis { tool: *tool, direction: turn * direction }
            }
            Orientation::Full(rotation) => Orientation::Full(turn.to_rotation_matrix() * rotation),
        };
        Self { position: self.position.map(|position| turn * position), orientation, ..*self }
    }
}

/// What the tool's position is measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The base's centre of mass.
    Base,
    /// The system's centre of mass.
    System,
}

/// How the tool is to be turned.
#[derive(Debug, Clone, PartialEq)]
pub enum Orientation {
    /// In any way.
    Any,
    /// So that one of its axes points in a direction.
    Axis {
        /// The axis, in the tool's axes.
        tool: Unit<Vector3<f64>>,
        /// The direction, in base axes.
        direction: Unit<Vector3<f64>>,
    },
    /// As this turns the tool's axes into base axes.
    Full(Rotation3<f64>),
}

/// By how much the tool misses its target.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Miss {
    /// Distance of the origins \[m\].
    pub position: f64,
    /// Angle of the turn, or between the axes, that is left \[rad\].
    pub angle: f64,
}
