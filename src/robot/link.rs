//! Links, the joints that carry them, and where they sit.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

use super::shape::Shape;

/// Mass, inertia and shapes of one rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia about the body's own centre of mass \[kg m²\], along the axes of its link.
    pub inertia: Matrix3<f64>,
    /// Solids that hold it between them; none where nothing is known of its looks.
    pub shapes: Vec<Shape>,
}

impl Body {
    /// A body of which mass \[kg\] and inertia \[kg m²\] alone are known.
    pub fn new(mass: f64, inertia: Matrix3<f64>) -> Self {
        Self { mass, inertia, shapes: Vec::new() }
    }

    /// A body without mass, for links that only carry others.
    pub fn massless() -> Self {
        Self::new(0.0, Matrix3::zeros())
    }

    /// Whether one principal moment exceeds the sum of the others, by more than rounding.
    pub(super) fn breaks_triangle_inequality(&self) -> bool {
        let moments = self.inertia.symmetric_eigenvalues();
        2.0 * moments.max() > moments.sum() * (1.0 + 1e-9)
    }

    /// Whether all numbers are finite, neither the mass nor a length of a shape is negative, and the inertia is symmetric
    /// without a negative moment, to rounding: some files have 1e-35 for nothing.
    pub(super) fn is_sound(&self) -> bool {
        let Self { mass, inertia, shapes } = self;
        if !shapes.iter().all(Shape::is_sound) {
            return false;
        }
        if !(*mass >= 0.0 && mass.is_finite() && inertia.iter().all(|i| i.is_finite())) {
            return false;
        }
        let least = -1e-9 * inertia.norm() - 1e-15;
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
    /// The link's name, by which files call it; that of its joint where nothing else is given.
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

/// What positions of a joint are: angles or distances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Angles, in rad; files and tables have degrees.
    Revolute,
    /// Distances, in m.
    Prismatic,
}

impl JointKind {
    /// A position, or one of its derivatives, in the units of files and tables: degrees or metres.
    pub fn to_file_units(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_degrees(),
            Self::Prismatic => value,
        }
    }

    /// From the units of files and tables: degrees or metres.
    pub fn from_file_units(self, value: f64) -> f64 {
        match self {
            Self::Revolute => value.to_radians(),
            Self::Prismatic => value,
        }
    }

    /// The unit of files and tables in letters: `deg` or `m`.
    pub fn file_unit(self) -> &'static str {
        match self {
            Self::Revolute => "deg",
            Self::Prismatic => "m",
        }
    }

    /// The unit of positions in memory and in exports: `rad` or `m`.
    pub fn si_unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad",
            Self::Prismatic => "m",
        }
    }

    /// A position in the units of files and tables, with its unit and without the rounding of its way through radians.
    pub(crate) fn told(self, position: f64) -> String {
        let rounded = (position * 1e9).round() / 1e9;
        match self {
            Self::Revolute => format!("{rounded}°"),
            Self::Prismatic => format!("{rounded} m"),
        }
    }

    /// The symbol of the unit of files and tables: `°` or `m`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Revolute => "°",
            Self::Prismatic => "m",
        }
    }
}

impl Joint {
    /// What its positions are, unless it is fixed.
    pub fn kind(&self) -> Option<JointKind> {
        match self {
            Self::Revolute(_) => Some(JointKind::Revolute),
            Self::Prismatic(_) => Some(JointKind::Prismatic),
            Self::Fixed => None,
        }
    }

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
    /// The joint's name, for tables, charts and exports.
    pub name: String,
    /// Direction in the joint's frame, which is also that in the link's frame.
    pub direction: Unit<Vector3<f64>>,
    /// Smallest and largest position \[rad or m\] (eq. 29).
    pub range: [f64; 2],
    /// Largest rate \[rad/s or m/s\], where the robot's maker states one.
    pub rate: Option<f64>,
    /// Largest torque or force \[N·m or N\], where the robot's maker states one.
    pub effort: Option<f64>,
}

impl Axis {
    /// A joint of which neither the largest rate nor the largest effort is known.
    pub fn new(name: String, direction: Unit<Vector3<f64>>, range: [f64; 2]) -> Self {
        Self { name, direction, range, rate: None, effort: None }
    }

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

    /// The placement, in this one's frame of reference, of what is placed so in this frame.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let rotation = self.rotation();
        Self::new(self.translation + rotation * next.translation, rotation * next.rotation())
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
