//! What links look like in URDF: `<collision>` elements.

use nalgebra::Vector3;
use roxmltree::Attribute;

use super::links::placement;
use super::shape_table::{Cuboid, Cylinder, Rod, ShapeTable, Sphere};
use super::xml::{Element, Reader, is_of};
use crate::input::{InputError, Positive};

/// How near two lengths are that are the same but for rounding \[m\].
const ROUNDING: f64 = 1e-6;

impl Reader<'_> {
    /// The shapes of a link, and how many meshes it has beside them.
    pub(super) fn shapes(&self, link: Element<'_>) -> Result<(Vec<ShapeTable>, usize), InputError> {
        let (mut shapes, mut meshes) = (Vec::new(), 0);
        for collision in link.children().filter(|child| is_named(*child, "collision", link)) {
            let Some(geometry) = self.child(collision, "geometry")? else { continue };
            for solid in geometry.children().filter(|child| is_of(*child, geometry)) {
                if solid.tag_name().name() == "mesh" {
                    meshes += 1;
                }
                shapes.extend(self.shape(solid, self.origin(collision)?)?);
            }
        }
        Ok((with_capsules(shapes), meshes))
    }

    /// A solid; none of one without an extent, or of a kind that is not known.
    fn shape(
        &self,
        solid: Element<'_>,
        (centre, zyx_deg): ([f64; 3], [f64; 3]),
    ) -> Result<Option<ShapeTable>, InputError> {
        let kind = solid.tag_name().name();
        Ok(match kind {
            "box" => {
                let size = self.lengths::<3>(self.text(solid, "size")?)?;
                size.map(|size| ShapeTable::Box(Cuboid { centre, size, zyx_deg }))
            }
            "sphere" => {
                let radius = self.lengths::<1>(self.text(solid, "radius")?)?;
                radius.map(|[radius]| ShapeTable::Sphere(Sphere { centre, radius: radius.0 }))
            }
            "cylinder" | "capsule" => {
                let radius = self.lengths::<1>(self.text(solid, "radius")?)?;
                let length = self.lengths::<1>(self.text(solid, "length")?)?;
                radius.zip(length).map(|([radius], [length])| {
                    let frame = placement(centre, zyx_deg);
                    let half = frame.rotation() * Vector3::new(0.0, 0.0, 0.5 * length.0);
                    let (from, to) = (frame.translation() - half, frame.translation() + half);
                    let rod = Rod { from: from.into(), to: to.into(), radius: radius.0 };
                    if kind == "capsule" {
                        ShapeTable::Capsule(rod)
                    } else {
                        ShapeTable::Cylinder(Cylinder(rod))
                    }
                })
            }
            _ => None,
        })
    }

    /// Lengths \[m\]; none where one is zero, as in files that have a shape of nothing.
    fn lengths<const N: usize>(
        &self,
        attribute: Attribute<'_, '_>,
    ) -> Result<Option<[Positive; N]>, InputError> {
        let lengths = self.numbers::<N>(attribute)?;
        if let Some(length) = lengths.iter().find(|length| **length < 0.0) {
            let name = attribute.name();
            let message = format!("found {length} as `{name}`, expected zero or above");
            return Err(self.error(attribute.range(), message));
        }
        Ok(lengths.iter().all(|length| *length > 0.0).then(|| lengths.map(Positive)))
    }
}

fn is_named(element: Element<'_>, name: &str, parent: Element<'_>) -> bool {
    element.tag_name().name() == name && is_of(element, parent)
}

/// The same where a cylinder with a sphere of its radius at either end, as the format has capsules, is one capsule.
fn with_capsules(mut shapes: Vec<ShapeTable>) -> Vec<ShapeTable> {
    let is_cap = |shape: &ShapeTable, rod: &Rod, end: [f64; 3]| match shape {
        ShapeTable::Sphere(Sphere { centre, radius }) => {
            let apart = Vector3::from(*centre) - Vector3::from(end);
            apart.norm() < ROUNDING && (radius - rod.radius).abs() < ROUNDING
        }
        _ => false,
    };
    let capsules: Vec<(usize, Rod)> = shapes
        .iter()
        .enumerate()
        .filter_map(|(i, shape)| match shape {
            ShapeTable::Cylinder(Cylinder(rod)) => Some((i, rod.clone())),
            _ => None,
        })
        .filter(|(_, rod)| {
            let has_cap = |end| shapes.iter().any(|shape| is_cap(shape, rod, end));
            has_cap(rod.from) && has_cap(rod.to)
        })
        .collect();
    for (i, rod) in &capsules {
        shapes[*i] = ShapeTable::Capsule(rod.clone());
    }
    shapes.retain(|shape| {
        !capsules.iter().any(|(_, rod)| is_cap(shape, rod, rod.from) || is_cap(shape, rod, rod.to))
    });
    shapes
}
