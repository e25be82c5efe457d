//! Solids as triangles and edges.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;

/// Sides of a round body, and rings of each of its caps.
const SIDES: usize = 32;
const RINGS: usize = 8;

/// A convex solid to draw.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Its form.
    pub form: Form,
    /// Red, green and blue.
    pub colour: [u8; 3],
    /// One where nothing is seen through it.
    pub opacity: f64,
}

/// The form of a solid \[m\].
#[derive(Debug, Clone)]
pub enum Form {
    /// All within a distance of a segment.
    Capsule {
        /// The segment's ends.
        ends: [Vector3<f64>; 2],
        /// The distance.
        radius: f64,
    },
    /// A box.
    Cuboid {
        /// Its middle.
        centre: Vector3<f64>,
        /// Half its edges; one of them may be nothing.
        edges: [Vector3<f64>; 3],
    },
}

/// A flat or bent face that looks outward.
pub(super) struct Face {
    pub(super) corners: [Vector3<f64>; 3],
    /// The surface's normals there, of length one.
    pub(super) normals: [Vector3<f64>; 3],
}

/// An edge, and the outward normals of the two faces that meet there.
pub(super) struct Edge {
    pub(super) ends: [Vector3<f64>; 2],
    pub(super) normals: [Vector3<f64>; 2],
}

impl Form {
    pub(super) fn faces(&self) -> Vec<Face> {
        match self {
            Self::Capsule { ends, radius } => capsule(*ends, *radius),
            Self::Cuboid { centre, edges } => cuboid(centre, edges),
        }
    }

    /// Sharp edges.
    pub(super) fn edges(&self) -> Vec<Edge> {
        let Self::Cuboid { centre, edges } = self else { return Vec::new() };
        let normals = normals(edges);
        let along = |k: usize| {
            let [i, j] = [(k + 1) % 3, (k + 2) % 3];
            SIGNS.map(|[a, b]| {
                let middle = centre + edges[i] * a + edges[j] * b;
                let ends = [middle - edges[k], middle + edges[k]];
                Edge { ends, normals: [normals[i] * a, normals[j] * b] }
            })
        };
        let all = (0..3).filter(|k| edges[*k].norm() > 0.0).flat_map(along);
        all.collect()
    }

    /// Points that it lies between.
    pub fn corners(&self) -> Vec<Vector3<f64>> {
        match self {
            Self::Capsule { ends, radius } => {
                let sides = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| axis * *radius);
                ends.iter()
                    .flat_map(|end| sides.iter().flat_map(move |side| [end - side, end + side]))
                    .collect()
            }
            Self::Cuboid { centre, edges: [a, b, c] } => SIGNS
                .iter()
                .flat_map(|[u, v]| [-1.0, 1.0].map(|w| centre + a * *u + b * *v + c * w))
                .collect(),
        }
    }
}

/// The corners of a square, in turn.
const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Unit normals of a box's faces at the ends of its edges; nothing where a face has no area.
fn normals(edges: &[Vector3<f64>; 3]) -> [Vector3<f64>; 3] {
    let normal = |k: usize| {
        let product = edges[(k + 1) % 3].cross(&edges[(k + 2) % 3]);
        let outward = if product.dot(&edges[k]) < 0.0 { -product } else { product };
        outward.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    };
    [normal(0), normal(1), normal(2)]
}

fn cuboid(centre: &Vector3<f64>, edges: &[Vector3<f64>; 3]) -> Vec<Face> {
    let normals = normals(edges);
    let face = |(k, side): (usize, f64)| {
        let middle = centre + edges[k] * side;
        let [a, b] = [edges[(k + 1) % 3], edges[(k + 2) % 3]];
        let corners = SIGNS.map(|[u, v]| middle + a * u + b * v);
        let normals = [normals[k] * side; 3];
        [[0, 1, 2], [0, 2, 3]].map(|at| Face { corners: at.map(|i| corners[i]), normals })
    };
    let all = (0..3).flat_map(|k| [-1.0, 1.0].map(|side| (k, side)));
    all.filter(|(k, _)| normals[*k] != Vector3::zeros()).flat_map(face).collect()
}

fn capsule([from, to]: [Vector3<f64>; 2], radius: f64) -> Vec<Face> {
    let axis = (to - from).try_normalize(0.0).unwrap_or_else(Vector3::z);
    let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let beside = axis.cross(&across);
    // From pole to pole: the middle of each ring, and the latitude of its normals.
    let latitude = |ring: usize| FRAC_PI_2 * ring as f64 / RINGS as f64;
    let lower = (0..=RINGS).map(|ring| (from, latitude(ring) - FRAC_PI_2));
    let upper = (0..=RINGS).map(|ring| (to, latitude(ring)));
    let rings: Vec<(Vector3<f64>, f64)> = lower.chain(upper).collect();
    let normal = |(ring, side): (usize, usize)| {
        let (sin, cos) = rings[ring].1.sin_cos();
        let (v, u) = (TAU * side as f64 / SIDES as f64).sin_cos();
        axis * sin + (across * u + beside * v) * cos
    };
    let mut faces = Vec::with_capacity(2 * SIDES * rings.len());
    for ring in 0..rings.len() - 1 {
        for side in 0..SIDES {
            let square = [(ring, side), (ring, side + 1), (ring + 1, side + 1), (ring + 1, side)];
            for at in [[0, 1, 2], [0, 2, 3]] {
                let normals = at.map(|i| normal(square[i]));
                let corners = [0, 1, 2].map(|i| rings[square[at[i]].0].0 + normals[i] * radius);
                faces.push(Face { corners, normals });
            }
        }
    }
    faces
}

impl Face {
    /// Whether it is seen from a place.
    pub(super) fn is_seen_from(&self, eye: &Vector3<f64>) -> bool {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(&(c - a));
        let is_outward = normal.dot(&self.normals.iter().sum::<Vector3<f64>>()) >= 0.0;
        (normal.dot(&(eye - a)) > 0.0) == is_outward
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of a sphere: `4 π r²`; of a box of 2 × 4 × 6: 88. A capsule adds `2 π r L`.
    #[test]
    fn faces_have_the_area_of_the_solid() {
        let area = |form: &Form| -> f64 {
            let faces = form.faces();
            let own = |face: &Face| {
                let [a, b, c] = face.corners;
                0.5 * (b - a).cross(&(c - a)).norm()
            };
            faces.iter().map(own).sum()
        };
        let edges = [Vector3::x(), Vector3::y() * 2.0, Vector3::z() * 3.0];
        let cuboid = Form::Cuboid { centre: Vector3::new(1.0, 2.0, 3.0), edges };
        assert!((area(&cuboid) - 88.0).abs() < 1e-12);
        let ends = [Vector3::zeros(), Vector3::new(0.0, 3.0, 4.0)];
        let expected = TAU * 2.0 * 0.5 * 0.5 + TAU * 0.5 * 5.0;
        let found = area(&Form::Capsule { ends, radius: 0.5 });
        assert!(found < expected && found > 0.98 * expected, "{found} {expected}");
    }

    /// From far along an axis one face of a box is seen; a sheet without thickness from either side.
    #[test]
    fn faces_look_outward() {
        let seen = |edges, eye: Vector3<f64>| {
            let form = Form::Cuboid { centre: Vector3::zeros(), edges };
            form.faces().iter().filter(|face| face.is_seen_from(&eye)).count()
        };
        let edges = [Vector3::x(), Vector3::y(), Vector3::z()];
        assert_eq!(seen(edges, Vector3::new(9.0, 0.0, 0.0)), 2);
        assert_eq!(seen(edges, Vector3::new(9.0, 9.0, -9.0)), 6);
        let sheet = [Vector3::x(), Vector3::y(), Vector3::zeros()];
        assert_eq!([-9.0, 9.0].map(|z| seen(sheet, Vector3::new(0.0, 0.0, z))), [2, 2]);
    }
}
