//! A free base and a serial arm of revolute joints.

mod file;

pub use file::RobotFile;

use nalgebra::{Matrix3, Rotation3, Vector3};
use serde::Serialize;

/// A rigid base that floats freely and the serial arm mounted on it.
///
/// Base axes have their origin at the base's centre of mass.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Robot {
    /// The name given in its file.
    pub name: String,
    /// The base.
    pub base: Body,
    /// Where the first joint sits, in base axes \[m\].
    pub mount: Vector3<f64>,
    /// The arm's zeroth DH frame in base axes.
    pub mount_rotation: Rotation3<f64>,
    /// The joints from the base outward, each with the link it moves.
    pub joints: Vec<Joint>,
}

/// Mass and inertia of one rigid body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Body {
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia about the body's own centre of mass \[kg m²\].
    pub inertia: Matrix3<f64>,
}

/// A revolute joint and the link it moves.
///
/// Standard Denavit–Hartenberg with offset: the step to the next joint is
/// `Rz(θ + offset) · Tz(d) · Tx(a) · Rx(alpha)`, and the joint turns about the `z` before it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Joint {
    /// A name for tables, charts and exports.
    pub name: String,
    /// The DH row.
    pub dh: DhRow,
    /// Smallest and largest angle \[rad\] (eq. 29).
    pub range: [f64; 2],
    /// The link's mass and inertia, in the *proximal* frame: turned by `θ`, not by the offset.
    pub link: Body,
    /// The link's centre of mass in the proximal frame, from the joint \[m\].
    pub centre_of_mass: Vector3<f64>,
}

/// One row of a Denavit–Hartenberg table, kept as what a sweep needs of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DhRow {
    /// The step from this joint to the next, in the proximal frame \[m\]: Table 2's `a_i + b_i`.
    pub step: Vector3<f64>,
    /// Sine and cosine of the offset `φ`, added to the joint angle.
    pub offset: (f64, f64),
    /// Sine and cosine of the twist `α` from this axis to the next.
    pub twist: (f64, f64),
}

impl DhRow {
    /// From the offset `φ` \[rad\], the steps `d` along the axis and `a` along the turned `x` \[m\]
    /// and the twist `α` \[rad\].
    pub fn new(offset: f64, d: f64, a: f64, twist: f64) -> Self {
        let (sin, cos) = offset.sin_cos();
        let step = Vector3::new(a * cos, a * sin, d);
        Self { step, offset: (sin, cos), twist: twist.sin_cos() }
    }
}

impl Robot {
    /// The arm's number of joints.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// The mass of base and arm together \[kg\].
    pub fn total_mass(&self) -> f64 {
        self.base.mass + self.joints.iter().map(|j| j.link.mass).sum::<f64>()
    }

    /// What is unphysical about the data but can be computed with: inertias no solid body has.
    pub fn warning(&self) -> Option<String> {
        let links = self.joints.iter().map(|j| (format!("the link of {}", j.name), &j.link));
        let impossible: Vec<String> = std::iter::once(("the base".to_owned(), &self.base))
            .chain(links)
            .filter(|(_, body)| body.breaks_triangle_inequality())
            .map(|(name, _)| name)
            .collect();
        (!impossible.is_empty()).then(|| {
            format!(
                "robot `{}`: the inertia of {} breaks the triangle inequality, so no solid body \
                 has it; used as given",
                self.name,
                impossible.join(" and of ")
            )
        })
    }
}

impl Body {
    /// Whether one principal moment exceeds the sum of the others, by more than rounding.
    fn breaks_triangle_inequality(&self) -> bool {
        let moments = self.inertia.symmetric_eigenvalues();
        2.0 * moments.max() > moments.sum() * (1.0 + 1e-9)
    }
}
