//! What bodies look like to each other: what must not touch.

use std::f64::consts::PI;

use nalgebra::{Rotation3, Vector3};

/// A convex solid that holds a body or a part of it, in the frame of the body's link; of the base in base axes.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// All points within a distance of a segment; a sphere where both its ends are the same.
    Capsule {
        /// The segment's ends \[m\].
        ends: [Vector3<f64>; 2],
        /// The distance \[m\], not negative.
        radius: f64,
    },
    /// A solid box.
    Cuboid {
        /// Its middle \[m\].
        centre: Vector3<f64>,
        /// Half its edges \[m\], not negative.
        half: Vector3<f64>,
        /// Turns the box's axes into those of the frame.
        rotation: Rotation3<f64>,
    },
}

impl Shape {
    /// A sphere of this radius \[m\].
    pub fn sphere(centre: Vector3<f64>, radius: f64) -> Self {
        Self::Capsule { ends: [centre; 2], radius }
    }

    /// What holds a solid cylinder, from the middles of its faces and its radius \[m\]: a capsule with the same ends and radius, or
    /// a box, whichever has the smaller volume.
    pub fn around_cylinder(ends: [Vector3<f64>; 2], radius: f64) -> Self {
        let [from, to] = ends;
        let axis = to - from;
        let length = axis.norm();
        let capsule = PI * radius.powi(2) * (length + 4.0 / 3.0 * radius);
        if capsule <= 4.0 * radius.powi(2) * length {
            return Self::Capsule { ends, radius };
        }
        // Either way along the axis is as good; nearly opposite directions have no rotation between them.
        let upward = if axis.z < 0.0 { -axis } else { axis };
        let rotation = Rotation3::rotation_between(&Vector3::z(), &upward);
        Self::Cuboid {
            centre: 0.5 * (from + to),
            half: Vector3::new(radius, radius, 0.5 * length),
            rotation: rotation.unwrap_or_else(Rotation3::identity),
        }
    }

    /// The same solid in the axes that its frame sits in: with the frame's origin \[m\] and the rotation of its axes.
    #[must_use]
    pub fn moved(&self, origin: &Vector3<f64>, turn: &Rotation3<f64>) -> Self {
        match self {
            Self::Capsule { ends, radius } => {
                Self::Capsule { ends: ends.map(|end| origin + turn * end), radius: *radius }
            }
            Self::Cuboid { centre, half, rotation } => Self::Cuboid {
                centre: origin + turn * centre,
                half: *half,
                rotation: turn * rotation,
            },
        }
    }

    /// Whether all its numbers are finite and no length is negative.
    pub(super) fn is_sound(&self) -> bool {
        let finite = |vector: &Vector3<f64>| vector.iter().all(|entry| entry.is_finite());
        let length = |length: f64| length >= 0.0 && length.is_finite();
        match self {
            Self::Capsule { ends, radius } => ends.iter().all(finite) && length(*radius),
            Self::Cuboid { centre, half, rotation } => {
                finite(centre)
                    && half.iter().all(|edge| length(*edge))
                    && rotation.matrix().iter().all(|entry| entry.is_finite())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box of a cylinder is smaller up to a length of 4.88 radii: `4 L = π (L + 4 r / 3)`.
    #[test]
    fn short_cylinders_are_boxes_and_long_ones_capsules() {
        let along_x = |length| [Vector3::zeros(), Vector3::new(length, 0.0, 0.0)];
        let long = Shape::around_cylinder(along_x(0.49), 0.1);
        assert_eq!(long, Shape::Capsule { ends: along_x(0.49), radius: 0.1 });
        let short = Shape::around_cylinder(along_x(-0.48), 0.1);
        let Shape::Cuboid { centre, half, rotation } = short else { panic!("{short:?}") };
        assert!((centre - Vector3::new(-0.24, 0.0, 0.0)).norm() < 1e-15);
        // Its edges lie along the axes of the frame.
        let edges = (rotation * half).abs();
        assert!((edges - Vector3::new(0.24, 0.1, 0.1)).norm() < 1e-15, "{edges}");
    }
}
