//! Rigid transforms with matrices, of which no digit is lost.

use nalgebra::{Rotation3, Vector3};

use super::link::Placement;

/// From a frame's coordinates to those of the frame it sits in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rigid {
    /// The frame's origin \[m\].
    pub(crate) translation: Vector3<f64>,
    /// Turns the frame's axes into those it sits in.
    pub(crate) rotation: Rotation3<f64>,
}

impl Rigid {
    pub(crate) fn identity() -> Self {
        Self { translation: Vector3::zeros(), rotation: Rotation3::identity() }
    }

    pub(crate) fn of(placement: &Placement) -> Self {
        Self { translation: *placement.translation(), rotation: placement.rotation() }
    }

    /// The transform from a frame that sits so in this one.
    pub(crate) fn then(&self, next: &Self) -> Self {
        Self {
            translation: self.translation + self.rotation * next.translation,
            rotation: self.rotation * next.rotation,
        }
    }

    pub(crate) fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { translation: rotation * -self.translation, rotation }
    }
}
