//! What a base looks like: the shapes that the robot's file states, or else a box with two panels.

use nalgebra::Vector3;
use serde::Serialize;

use crate::robot::{Robot, Shape};

/// A base, for the eye. Box and panels are made up, and drawn where no shapes are stated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Satellite {
    /// Half the box's edges along the base's axes \[m\].
    pub half: [f64; 3],
    /// Where the arm sits, in base axes \[m\].
    pub mount: [f64; 3],
    /// The panels, on either side.
    pub panels: [SolarPanel; 2],
    /// Shapes that the robot's file states of the base.
    #[serde(skip)]
    pub stated: Vec<Shape>,
}

/// A box in base axes, which may be flat.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseBox {
    /// Its middle \[m\].
    pub centre: Vector3<f64>,
    /// Half its edges \[m\].
    pub edges: [Vector3<f64>; 3],
}

/// The thinnest edge of a flat block, as a share of the middle one.
const FLAT: f64 = 0.05;

impl BaseBox {
    /// Along the base's axes.
    fn upright(half: [f64; 3]) -> Self {
        let [x, y, z] = half;
        let edges = Vector3::new(x, y, z);
        let edge = |k: usize| {
            let mut edge = Vector3::zeros();
            edge[k] = edges[k];
            edge
        };
        Self { centre: Vector3::zeros(), edges: [edge(0), edge(1), edge(2)] }
    }

    /// That holds a shape.
    pub fn around(shape: &Shape) -> Self {
        match shape {
            Shape::Cuboid { centre, half, rotation } => {
                let Self { edges, .. } = Self::upright((*half).into());
                Self { centre: *centre, edges: edges.map(|edge| rotation * edge) }
            }
            Shape::Capsule { ends: [from, to], radius } => {
                let axis = (to - from).try_normalize(0.0).unwrap_or_else(Vector3::z);
                // The base's axis that is most across it.
                let across = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
                let length = 0.5 * (to - from).norm() + radius;
                let edges = [axis * length, across * *radius, axis.cross(&across) * *radius];
                Self { centre: 0.5 * (from + to), edges }
            }
        }
    }

    /// Whether it is a sheet.
    pub fn is_flat(&self) -> bool {
        let mut lengths = self.edges.map(|edge| edge.norm());
        lengths.sort_by(f64::total_cmp);
        lengths[0] < FLAT * lengths[1]
    }

    /// The corners, in turn \[m\], of the face at the end of an edge, on side ±1.
    pub fn face(&self, edge: usize, side: f64) -> [Vector3<f64>; 4] {
        let [a, b] = [1, 2].map(|k| self.edges[(edge + k) % 3]);
        let middle = self.centre + self.edges[edge] * side;
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[u, v]| middle + a * u + b * v)
    }

    /// Its edges, each from one of its ends to the other \[m\].
    pub fn outline(&self) -> Vec<[Vector3<f64>; 2]> {
        let faces = [-1.0, 1.0].map(|side| self.face(2, side));
        let around = faces.iter().flat_map(|face| (0..4).map(|k| [face[k], face[(k + 1) % 4]]));
        let [low, high] = faces;
        around.chain(low.into_iter().zip(high).map(|(low, high)| [low, high])).collect()
    }

    /// The outward normal of the same face, not normalised.
    pub fn normal(&self, edge: usize, side: f64) -> Vector3<f64> {
        let [a, b] = [1, 2].map(|k| self.edges[(edge + k) % 3]);
        a.cross(&b) * side
    }
}

/// A flat rectangle beside the box, base axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolarPanel {
    /// Where the boom that holds it leaves the box and where it meets the panel \[m\].
    pub boom: [[f64; 3]; 2],
    /// One of the corners \[m\].
    pub corner: [f64; 3],
    /// From that corner outward and across, the panel's edges \[m\].
    pub edges: [[f64; 3]; 2],
}

/// A panel's length, width and distance, in half edges of the box.
const LENGTH: f64 = 3.4;
const WIDTH: f64 = 1.5;
const GAP: f64 = 0.5;

impl SolarPanel {
    /// Along an axis of the box, on one side, ±1.
    fn of(half: [f64; 3], axis: usize, side: f64) -> Self {
        let across = usize::from(axis != 1);
        let along = |places: &[(usize, f64)]| {
            let mut place = [0.0; 3];
            for &(k, length) in places {
                place[k] = length;
            }
            place
        };
        let root = side * (1.0 + GAP) * half[axis];
        Self {
            boom: [along(&[(axis, side * half[axis])]), along(&[(axis, root)])],
            corner: along(&[(axis, root), (across, -0.5 * WIDTH * half[across])]),
            edges: [
                along(&[(axis, side * LENGTH * half[axis])]),
                along(&[(across, WIDTH * half[across])]),
            ],
        }
    }

    /// The four corners, in turn \[m\].
    pub fn corners(&self) -> [[f64; 3]; 4] {
        let [out, across] = self.edges;
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(a, b)| std::array::from_fn(|k| self.corner[k] + a * out[k] + b * across[k]))
    }
}

impl Satellite {
    /// All that it is made of; the body, which is nearest to the base's centre of mass, comes first.
    pub fn blocks(&self) -> Vec<BaseBox> {
        if self.stated.is_empty() {
            let body = BaseBox::upright(self.half);
            let panels = self.panels.iter().map(|panel| {
                let [out, across] = panel.edges.map(|edge| Vector3::from(edge) / 2.0);
                let centre = Vector3::from(panel.corner) + out + across;
                BaseBox { centre, edges: [out, across, Vector3::zeros()] }
            });
            return std::iter::once(body).chain(panels).collect();
        }
        let mut blocks: Vec<BaseBox> = self.stated.iter().map(BaseBox::around).collect();
        blocks.sort_by(|a, b| a.centre.norm().total_cmp(&b.centre.norm()));
        blocks
    }

    /// The base's stated shapes, and the robot's [`base_box`](Robot::base_box) with panels on two sides of it.
    pub fn of(robot: &Robot) -> Self {
        let (half, mount) = (robot.base_box(), *robot.mount().translation());
        let ratio = |k: usize| mount[k].abs() / half[k];
        let face = (0..3).fold(2, |face, k| if ratio(k) > ratio(face) { k } else { face });
        let axis = if face == 1 { 2 } else { 1 };
        let panels = [1.0, -1.0].map(|side| SolarPanel::of(half, axis, side));
        Self { half, mount: mount.into(), panels, stated: robot.base().shapes.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Document;

    /// A solid box of 2 × 3 × 4 m and 120 kg has `I = 10 (9 + 16, 4 + 16, 4 + 9)` (any textbook).
    #[test]
    fn a_solid_box_is_found_again() {
        let text = "name = 'box'\n[base]\nmass = 120\nmount = [0.2, -1.5, 0]\n\
             inertia = { xx = 250, yy = 200, zz = 130 }\n\
             [[joint]]\ndh = { a = 0, d = 1, alpha_deg = 0 }\nrange_deg = [-90, 90]\nmass = 1\n\
             centre_of_mass = [0, 0, 0]\ninertia = { xx = 1, yy = 1, zz = 1 }\n";
        let robot = Robot::from_document(&Document::embedded("box.toml", text)).unwrap();
        let satellite = Satellite::of(&robot);
        for (found, expected) in satellite.half.iter().zip([1.0, 1.5, 2.0]) {
            assert!((found - expected).abs() < 1e-12, "{:?}", satellite.half);
        }
        assert_eq!(satellite.panels[0].boom, [[0.0, 0.0, 2.0], [0.0, 0.0, 3.0]]);
    }

    /// ETS-VII states a body and two panels.
    #[test]
    fn stated_shapes_are_the_base() {
        let robot = Robot::from_document(&Robot::embedded("ets_vii").unwrap()).unwrap();
        let blocks = Satellite::of(&robot).blocks();
        assert_eq!(blocks.iter().map(BaseBox::is_flat).collect::<Vec<_>>(), [false, true, true]);
        assert_eq!(blocks[0].edges[0], Vector3::new(1.3, 0.0, 0.0));
        assert_eq!(blocks[1].centre, Vector3::new(0.0, 3.9, 0.0));
        let body = &blocks[0];
        assert_eq!(body.face(1, -1.0).map(|corner| corner.y), [-1.15; 4]);
        assert!(body.normal(1, -1.0).y < 0.0);
    }

    #[test]
    fn the_mount_lies_on_a_face() {
        let robot = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
        let Satellite { half, mount, panels, .. } = Satellite::of(&robot);
        assert_eq!(half[2], mount[2]);
        assert_eq!(panels[1].corners()[2][1], -half[1] * (1.5 + 3.4));
        assert!(half[0] > mount[0].abs() && half[1] > mount[1].abs());
    }
}
