//! Rigid transforms with matrices, of which no digit is lost, and bodies that move as one.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::link::{Body, Placement};

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

/// A body in base axes.
pub(super) struct Placed {
    pub(super) mass: f64,
    pub(super) centre: Vector3<f64>,
    /// About the centre of mass.
    pub(super) inertia: Matrix3<f64>,
}

impl Placed {
    pub(super) fn base(body: &Body) -> Self {
        Self { mass: body.mass, centre: Vector3::zeros(), inertia: body.inertia }
    }

    fn weighs_nothing(&self) -> bool {
        self.mass == 0.0 && self.inertia == Matrix3::zeros()
    }
}

/// Bodies that move as one. One alone keeps its digits.
pub(super) fn merged(mut parts: Vec<Placed>) -> Placed {
    parts.retain(|part| !part.weighs_nothing());
    if parts.len() == 1 {
        return parts.remove(0);
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    let moment: Vector3<f64> = parts.iter().map(|part| part.centre * part.mass).sum();
    let centre = if mass > 0.0 { moment / mass } else { Vector3::zeros() };
    let inertia = parts.iter().map(|part| {
        let d = part.centre - centre;
        let point = Matrix3::from_diagonal_element(d.norm_squared()) - d * d.transpose();
        part.inertia + point * part.mass
    });
    Placed { mass, centre, inertia: inertia.sum() }
}
