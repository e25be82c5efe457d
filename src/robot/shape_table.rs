//! Shapes in files.

use nalgebra::{Rotation3, Vector3};
use serde::{Deserialize, Serialize};

use super::shape::Shape;
use crate::input::{Positive, finite_array, positive};

/// A shape as a file has it; its key says of what kind it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", try_from = "Written")]
pub(crate) enum ShapeTable {
    Sphere(Sphere),
    Capsule(Rod),
    /// It is taken for a capsule or a box that holds it.
    Cylinder(Cylinder),
    Box(Cuboid),
}

/// Lengths in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(crate) struct Sphere {
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) centre: [f64; 3],
    #[serde(deserialize_with = "positive")]
    pub(super) radius: f64,
}

/// What is round about a segment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(crate) struct Rod {
    #[serde(deserialize_with = "finite_array")]
    pub(super) from: [f64; 3],
    #[serde(deserialize_with = "finite_array")]
    pub(super) to: [f64; 3],
    #[serde(deserialize_with = "positive")]
    pub(super) radius: f64,
}

/// A rod that has a length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Rod")]
pub(crate) struct Cylinder(pub(super) Rod);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(crate) struct Cuboid {
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) centre: [f64; 3],
    /// Its edges.
    pub(super) size: [Positive; 3],
    /// Yaw, pitch and roll of its axes \[°\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) zyx_deg: [f64; 3],
}

/// An entry of `shapes` with whatever kinds it names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct Written {
    sphere: Option<Sphere>,
    capsule: Option<Rod>,
    cylinder: Option<Cylinder>,
    r#box: Option<Cuboid>,
}

fn is_zero(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}

impl TryFrom<Rod> for Cylinder {
    type Error = &'static str;

    fn try_from(rod: Rod) -> Result<Self, Self::Error> {
        if rod.from == rod.to { Err("the cylinder has no length") } else { Ok(Self(rod)) }
    }
}

impl TryFrom<Written> for ShapeTable {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, Self::Error> {
        let Written { sphere, capsule, cylinder, r#box } = written;
        let mut given = [
            ("sphere", sphere.map(Self::Sphere)),
            ("capsule", capsule.map(Self::Capsule)),
            ("cylinder", cylinder.map(Self::Cylinder)),
            ("box", r#box.map(Self::Box)),
        ]
        .into_iter()
        .filter_map(|(kind, shape)| Some((kind, shape?)));
        match (given.next(), given.next()) {
            (Some((_, shape)), None) => Ok(shape),
            (Some((first, _)), Some((second, _))) => {
                Err(format!("found both `{first}` and `{second}`, expected one of them"))
            }
            (None, _) => Err("missing field `sphere`, `capsule`, `cylinder` or `box`".to_owned()),
        }
    }
}

impl ShapeTable {
    fn shape(&self) -> Shape {
        let ends = |rod: &Rod| [rod.from, rod.to].map(Vector3::from);
        match self {
            Self::Sphere(Sphere { centre, radius }) => Shape::sphere((*centre).into(), *radius),
            Self::Capsule(rod) => Shape::Capsule { ends: ends(rod), radius: rod.radius },
            Self::Cylinder(Cylinder(rod)) => Shape::around_cylinder(ends(rod), rod.radius),
            Self::Box(Cuboid { centre, size, zyx_deg }) => {
                let [yaw, pitch, roll] = zyx_deg.map(f64::to_radians);
                Shape::Cuboid {
                    centre: (*centre).into(),
                    half: size.map(|edge| 0.5 * edge.0).into(),
                    rotation: Rotation3::from_euler_angles(roll, pitch, yaw),
                }
            }
        }
    }
}

/// What tables describe.
pub(crate) fn shapes(tables: &[ShapeTable]) -> Vec<Shape> {
    tables.iter().map(ShapeTable::shape).collect()
}
