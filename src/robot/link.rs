//! Links, the joints that carry them, and where they sit.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// Mass and inertia of one rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia about the body's own centre of mass \[kg m²\], along the axes of its link.
    pub inertia: Matrix3<f64>,
}

impl Body {
    /// A body without mass, for links that only carry others.
    pub fn massless() -> Self {
        Self { mass: 0.0, inertia: Matrix3::zeros() }
    }

    /// Whether one principal moment exceeds the sum of the others, by more than rounding.
    pub(super) fn breaks_triangle_inequality(&self) -> bool {
        let moments = self.inertia.symmetric_eigenvalues();
        2.0 * moments.max() > moments.sum() * (1.0 + 1e-9)
    }

    /// Whether mass and inertia are finite, the mass is not negative, and the inertia is symmetric without a
    /// negative moment, to rounding.
    pub(super) fn is_sound(&self) -> bool {
        let Self { mass, inertia } = self;
        if !(*mass >= 0.0 && mass.is_finite() && inertia.iter().all(|i| i.is_finite())) {
            return false;
        }
        let least = -1e-9 * inertia.norm();
        (inertia - inertia.transpose()).norm() <= -least
            && inertia.symmetric_eigenvalues().min() >= least
    }
}

/// A rigid link and the joint that carries it.
///
/// The link's frame is the joint's frame, turned about or shifted along the joint's axis by the joint's
/// position.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// The joint's name, for tables, charts and exports.
    pub name: String,
    /// Index of the link that the joint sits on; `None` for the base.
    pub parent: Option<usize>,
    /// The joint's frame in the parent's.
    pub placement: Placement,
    /// How the link moves.
    pub joint: Joint,
    /// Mass and inertia.
    pub body: Body,
    /// Centre of mass in the link's frame \[m\].
    pub centre_of_mass: Vector3<f64>,
}

/// How a link moves against its parent.
#[derive(Debug, Clone, PartialEq)]
pub enum Joint {
    /// It turns; position and range in rad.
    Revolute(Axis),
    /// It slides; position and range in m.
    Prismatic(Axis),
    /// It does not move.
    Fixed,
}

impl Joint {
    /// The axis, unless the joint is fixed.
    pub fn axis(&self) -> Option<&Axis> {
        match self {
            Self::Revolute(axis) | Self::Prismatic(axis) => Some(axis),
            Self::Fixed => None,
        }
    }
}

/// The axis of a joint that moves, and how far it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Direction in the joint's frame, which is also that in the link's frame.
    pub direction: Unit<Vector3<f64>>,
    /// Smallest and largest position \[rad or m\] (eq. 29).
    pub range: [f64; 2],
}

impl Axis {
    /// Whether it is the frame's `z`.
    pub(crate) fn is_z(&self) -> bool {
        *self.direction == Vector3::new(0.0, 0.0, 1.0)
    }
}

/// A constant rigid transform: where a frame sits in another one.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    translation: Vector3<f64>,
    rotation: Turns,
}

/// A rotation as it was given. The two turns of a Denavit–Hartenberg row take fewer products than a
/// matrix.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Turns {
    /// `Rz(offset) · Rx(twist)`, sine and cosine of each.
    Dh {
        offset: (f64, f64),
        twist: (f64, f64),
    },
    Matrix(Rotation3<f64>),
}

impl Placement {
    /// The frame's origin \[m\] and the rotation of its axes.
    pub fn new(translation: Vector3<f64>, rotation: Rotation3<f64>) -> Self {
        Self { translation, rotation: Turns::Matrix(rotation) }
    }

    /// The frame itself.
    pub fn identity() -> Self {
        Self::new(Vector3::zeros(), Rotation3::identity())
    }

    /// The constant part of a standard Denavit–Hartenberg row, `Rz(offset) · Tz(d) · Tx(a) · Rx(twist)`:
    /// from the link that the row's joint carries to the next joint. Angles in rad, lengths in m.
    pub fn dh(offset: f64, d: f64, a: f64, twist: f64) -> Self {
        let (sin, cos) = offset.sin_cos();
        Self {
            translation: Vector3::new(a * cos, a * sin, d),
            rotation: Turns::Dh { offset: (sin, cos), twist: twist.sin_cos() },
        }
    }

    /// The frame's origin \[m\].
    pub fn translation(&self) -> &Vector3<f64> {
        &self.translation
    }

    pub(crate) fn turns(&self) -> &Turns {
        &self.rotation
    }

    /// Turns the frame's axes into those it sits in.
    pub fn rotation(&self) -> Rotation3<f64> {
        match self.rotation {
            Turns::Matrix(rotation) => rotation,
            Turns::Dh { offset: (so, co), twist: (st, ct) } => {
                let turn = Matrix3::new(co, -so, 0.0, so, co, 0.0, 0.0, 0.0, 1.0);
                let twist = Matrix3::new(1.0, 0.0, 0.0, 0.0, ct, -st, 0.0, st, ct);
                Rotation3::from_matrix_unchecked(turn * twist)
            }
        }
    }

    /// As a rigid transform, from the frame's coordinates to those it sits in.
    pub fn isometry(&self) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_rotation_matrix(&self.rotation());
        Isometry3::from_parts(Translation3::from(self.translation), rotation)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.rotation().matrix().iter().chain(&self.translation).all(|entry| entry.is_finite())
    }
}
