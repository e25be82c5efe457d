//! What tells one robot from another.

use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};

use super::link::{Body, Joint};
use super::rigid::Rigid;
use super::tree::Robot;

impl Robot {
    /// All that a motion of the base follows from, as JSON: the robot as it stands with all joints at zero,
    /// in base axes. The choice of link frames, fixed links apart from what carries them, names and tool
    /// make no difference.
    ///
    /// `base` and each entry of `joints` have a `body` with `mass` \[kg\], `centre_of_mass` \[m\] and
    /// `inertia` about that, `xx, yy, zz, xy, xz, yz` \[kg m²\]. A joint has a `parent`, the index of a
    /// joint before it or `null`, a `type`, an `axis`, a unit vector, a `point` on a revolute joint's axis,
    /// the nearest to the base's centre of mass, and a `range` \[rad or m\].
    pub(crate) fn identity(&self) -> Value {
        let mut frames: Vec<Rigid> = Vec::new();
        let mut movers: Vec<Option<usize>> = Vec::new();
        let mut joints = Vec::new();
        let mut bodies = vec![vec![Placed::base(self.base())]];
        for link in self.links() {
            let inner = link.parent.map_or_else(Rigid::identity, |parent| frames[parent]);
            let parent = link.parent.and_then(|parent| movers[parent]);
            let frame = inner.then(&Rigid::of(&link.placement));
            let mover = match &link.joint {
                Joint::Fixed => parent,
                Joint::Revolute(axis) => {
                    let direction = frame.rotation * *axis.direction;
                    let origin = frame.translation;
                    let point = origin - direction * direction.dot(&origin);
                    joints.push(json!({
                        "parent": parent,
                        "type": "revolute",
                        "axis": array(&direction),
                        "point": array(&point),
                        "range": axis.range,
                    }));
                    Some(joints.len() - 1)
                }
                Joint::Prismatic(axis) => {
                    joints.push(json!({
                        "parent": parent,
                        "type": "prismatic",
                        "axis": array(&(frame.rotation * *axis.direction)),
                        "range": axis.range,
                    }));
                    Some(joints.len() - 1)
                }
            };
            bodies.resize_with(joints.len() + 1, Vec::new);
            let turn = frame.rotation.matrix();
            bodies[mover.map_or(0, |mover| mover + 1)].push(Placed {
                mass: link.body.mass,
                centre: frame.translation + frame.rotation * link.centre_of_mass,
                inertia: turn * link.body.inertia * turn.transpose(),
            });
            frames.push(frame);
            movers.push(mover);
        }
        let mut bodies = bodies.into_iter().map(|parts| merged(parts).identity());
        let base = bodies.next();
        for (joint, body) in joints.iter_mut().zip(bodies) {
            joint["body"] = body;
        }
        json!({ "base": { "body": base }, "joints": joints })
    }
}

/// A body in base axes.
struct Placed {
    mass: f64,
    centre: Vector3<f64>,
    /// About the centre of mass.
    inertia: Matrix3<f64>,
}

impl Placed {
    fn base(body: &Body) -> Self {
        Self { mass: body.mass, centre: Vector3::zeros(), inertia: body.inertia }
    }

    fn weighs_nothing(&self) -> bool {
        self.mass == 0.0 && self.inertia == Matrix3::zeros()
    }

    fn identity(&self) -> Value {
        let entry = |i, j| self.inertia[(i, j)] + 0.0;
        json!({
            "mass": self.mass,
            "centre_of_mass": array(&self.centre),
            "inertia": [
                entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2),
            ],
        })
    }
}

/// Bodies that move as one. One alone keeps its digits.
fn merged(mut parts: Vec<Placed>) -> Placed {
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

fn array(vector: &Vector3<f64>) -> [f64; 3] {
    // No negative zero, which JSON would tell from zero.
    vector.map(|component| component + 0.0).into()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Unit};

    use super::*;
    use crate::digest::digest;
    use crate::robot::{Axis, Link, Placement, Tool};

    /// Results are found again by this: a change makes all that is stored orphans.
    #[test]
    fn the_papers_robot_keeps_its_identity() {
        let robot = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
        assert_eq!(digest(&robot.identity().to_string()), "15f6f93f7ae08e76");
    }

    fn tree(turn: Rotation3<f64>) -> Robot {
        let body = |mass| Body { mass, inertia: Matrix3::from_diagonal_element(mass / 8.0) };
        let axis = |x, y, z| Axis {
            direction: Unit::new_normalize(turn.inverse() * Vector3::new(x, y, z)),
            range: [-1.0, 2.0],
        };
        let link = |name: &str, parent, x: f64, joint, mass| Link {
            name: name.to_owned(),
            parent,
            placement: match parent {
                None => Placement::new(Vector3::new(x, 0.5, 0.0), turn),
                Some(_) => Placement::new(
                    turn.inverse() * Vector3::new(x, 0.5, 0.0),
                    Rotation3::identity(),
                ),
            },
            joint,
            body: body(mass),
            centre_of_mass: turn.inverse() * Vector3::new(0.0, 0.25, 0.0),
        };
        let links = vec![
            link("shoulder", None, 1.0, Joint::Revolute(axis(0.0, 0.0, 1.0)), 4.0),
            link("slide", Some(0), 2.0, Joint::Prismatic(axis(1.0, 0.0, 0.0)), 2.0),
            link("camera", Some(0), -1.0, Joint::Fixed, 1.0),
            link("other", None, -1.0, Joint::Revolute(axis(0.0, 1.0, 0.0)), 4.0),
        ];
        let tool = Tool { link: Some(1), placement: Placement::identity() };
        Robot::new("tree".to_owned(), body(64.0), links, tool).unwrap()
    }

    #[test]
    fn a_small_tree_keeps_its_identity() {
        let tree = tree(Rotation3::identity());
        assert_eq!(digest(&tree.identity().to_string()), "0f8e6948e65ed05a");
    }

    /// The frames of links turned by quarter turns, which loses no digit here.
    #[test]
    fn frames_are_no_part_of_it() {
        let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let turned = tree(Rotation3::from_matrix_unchecked(quarter)).identity();
        assert_eq!(turned, tree(Rotation3::identity()).identity());
    }
}
