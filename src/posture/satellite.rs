//! What a base looks like, of which the model knows mass, inertia and mount alone.

use serde::Serialize;

use crate::robot::Robot;

/// A box with two panels, for the eye: the motion does not depend on it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Satellite {
    /// Half the box's edges along the base's axes \[m\].
    pub half: [f64; 3],
    /// Where the arm sits, in base axes \[m\].
    pub mount: [f64; 3],
    /// The panels, on either side.
    pub panels: [SolarPanel; 2],
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

/// How far within a face's edge the mount lies at least, as a share of half the edge.
const MARGIN: f64 = 0.1;

impl Satellite {
    /// The solid box of the base's mass whose moments of inertia about the base's axes are the base's,
    /// `e_k² = 6 (I_i + I_j − I_k) / m`, stretched or shrunk until the arm's mount lies on a face of it.
    pub fn of(robot: &Robot) -> Self {
        let (mass, inertia) = (robot.base().mass, robot.base().inertia);
        let squared = |k: usize| 6.0 * (inertia.trace() - 2.0 * inertia[(k, k)]) / mass;
        let mean = (6.0 * inertia.trace() / (3.0 * mass)).sqrt();
        // An inertia that no solid body has would give an edge of no length.
        let mut half: [f64; 3] =
            std::array::from_fn(|k| 0.5 * squared(k).max(0.1 * mean * mean).sqrt());
        let mount: [f64; 3] = (*robot.mount().translation()).into();
        let ratio = |k: usize| mount[k].abs() / half[k];
        let face = (0..3).fold(2, |face, k| if ratio(k) > ratio(face) { k } else { face });
        for (k, half) in half.iter_mut().enumerate() {
            if k != face {
                *half = half.max(mount[k].abs() / (1.0 - MARGIN));
            } else if mount[k] != 0.0 {
                *half = mount[k].abs();
            }
        }
        let axis = if face == 1 { 2 } else { 1 };
        Self { half, mount, panels: [1.0, -1.0].map(|side| SolarPanel::of(half, axis, side)) }
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

    #[test]
    fn the_mount_lies_on_a_face() {
        let robot = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
        let Satellite { half, mount, panels } = Satellite::of(&robot);
        assert_eq!(half[2], mount[2]);
        assert_eq!(panels[1].corners()[2][1], -half[1] * (1.5 + 3.4));
        assert!(half[0] > mount[0].abs() && half[1] > mount[1].abs());
    }
}
