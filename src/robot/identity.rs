//! What tells one robot from another.

use std::collections::BTreeSet;

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::follow::Follow;
use super::link::{Body, Joint};
use super::rigid::{Placed, Rigid, merged};
use super::shape::Shape;
use super::tree::Robot;

impl Robot {
    /// All that a motion of the base follows from, as JSON: the robot as it stands with all joints at zero,
    /// in base axes. The choice of link frames, fixed links apart from what carries them, names and tool
    /// make no difference.
    ///
    /// `base` and each entry of `joints` have a `body` with `mass` \[kg\], `centre_of_mass` \[m\] and
    /// `inertia` about that, `xx, yy, zz, xy, xz, yz` \[kg m²\]. A joint has a `parent`, the index of a
    /// joint before it or `null`, a `type`, an `axis`, a unit vector, a `point` on a revolute joint's axis,
    /// the nearest to the base's centre of mass, a `range` \[rad or m\] and, where it follows another joint, `follows`.
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
        for (joint, follow) in joints.iter_mut().zip(self.follows()) {
            if let Some(Follow { leader, multiplier, offset }) = follow {
                joint["follows"] =
                    json!({ "joint": leader, "multiplier": multiplier, "offset": offset });
            }
        }
        let mut bodies = bodies.into_iter().map(|parts| merged(parts).identity());
        let base = bodies.next();
        for (joint, body) in joints.iter_mut().zip(bodies) {
            joint["body"] = body;
        }
        json!({ "base": { "body": base }, "joints": joints })
    }
}

impl Robot {
    /// All that says which of its bodies touch, beside what `identity` has, as JSON, with all joints at zero and in
    /// base axes: its shapes as they stand, so derived ones only of a robot that [`with_shapes`](Self::with_shapes) gives.
    ///
    /// Each of `shapes` has the `joint` that moves it, an index as in the identity or `null` for the base, and either `ends` and
    /// `radius` of a capsule or `centre`, `half` edges and `rotation`, rows of a matrix, of a box \[m\]. `ignored` has pairs of
    /// indexes of shapes that may touch.
    pub fn shapes_identity(&self) -> Value {
        let mut shapes: Vec<Value> = Vec::new();
        let mut frames: Vec<(Option<usize>, Rigid)> = Vec::new();
        let mut joints = 0..self.joint_count();
        // For every link the indexes of its shapes.
        let mut places = Vec::new();
        let mut add = |body: &Body, joint: Option<usize>, frame: &Rigid| {
            let first = shapes.len();
            let moved = |shape: &Shape| shape.moved(&frame.translation, &frame.rotation);
            shapes.extend(body.shapes.iter().map(|shape| described(&moved(shape), joint)));
            first..shapes.len()
        };
        let base = add(self.base(), None, &Rigid::identity());
        for link in self.links() {
            let inner = link.parent.map_or_else(|| (None, Rigid::identity()), |link| frames[link]);
            let frame = inner.1.then(&Rigid::of(&link.placement));
            let joint = if link.joint.axis().is_some() { joints.next() } else { inner.0 };
            places.push(add(&link.body, joint, &frame));
            frames.push((joint, frame));
        }
        let of = |link: Option<usize>| link.map_or(&base, |link| &places[link]).clone();
        let pairs = self.ignored_pairs().iter().flat_map(|&[first, second]| {
            of(first).flat_map(move |a| of(second).map(move |b| [a.min(b), a.max(b)]))
        });
        let ignored: BTreeSet<[usize; 2]> = pairs.collect();
        json!({ "shapes": shapes, "ignored": ignored })
    }
}

fn described(shape: &Shape, joint: Option<usize>) -> Value {
    match shape {
        Shape::Capsule { ends, radius } => {
            json!({ "joint": joint, "ends": [array(&ends[0]), array(&ends[1])], "radius": radius })
        }
        Shape::Cuboid { centre, half, rotation } => {
            let rows: [[f64; 3]; 3] =
                std::array::from_fn(|i| array(&rotation.matrix().row(i).transpose()));
            json!({ "joint": joint, "centre": array(centre), "half": array(half), "rotation": rows })
        }
    }
}

impl Placed {
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

fn array(vector: &Vector3<f64>) -> [f64; 3] {
    // No negative zero, which JSON would tell from zero.
    vector.map(|component| component + 0.0).into()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Rotation3, Unit};

    use super::*;
    use crate::digest::digest;
    use crate::robot::{Axis, Body, Link, Placement, Tool};

    /// Results are found again by this: a change makes all that is stored orphans.
    #[test]
    fn the_papers_robot_keeps_its_identity() {
        let robot = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
        assert_eq!(digest(&robot.identity().to_string()), "15f6f93f7ae08e76");
    }

    fn tree(turn: Rotation3<f64>) -> Robot {
        let body = |mass| Body::new(mass, Matrix3::from_diagonal_element(mass / 8.0));
        let axis = |x, y, z| {
            let direction = Unit::new_normalize(turn.inverse() * Vector3::new(x, y, z));
            Axis::new(String::new(), direction, [-1.0, 2.0])
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

    /// A quarter turn about z, to which x is y, and a step of 2 m along the base's x; a camera that is fixed to the first link.
    #[test]
    fn shapes_are_told_in_base_axes() {
        let tree = |turn: Rotation3<f64>| {
            let back = turn.inverse();
            let mut links = vec![Vec::new(); 4];
            links[1] = vec![
                Shape::sphere(back * Vector3::x(), 0.5),
                Shape::sphere(Vector3::zeros(), 0.25),
            ];
            links[2] = vec![Shape::Cuboid {
                centre: Vector3::zeros(),
                half: Vector3::new(1.0, 2.0, 3.0),
                rotation: back,
            }];
            let robot = tree(turn).ignoring(vec![[Some(1), None], [Some(1), Some(2)]]).unwrap();
            let base = vec![Shape::sphere(Vector3::zeros(), 0.125)];
            robot.reshaped(base, links, Vec::new())
        };
        let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let turned = tree(Rotation3::from_matrix_unchecked(quarter)).shapes_identity();
        assert_eq!(turned, tree(Rotation3::identity()).shapes_identity());
        let sphere = |joint: Option<u8>, [x, y]: [f64; 2], radius: f64| json!({ "joint": joint, "ends": [[x, y, 0.0], [x, y, 0.0]], "radius": radius });
        let camera = json!({
            "joint": 0,
            "centre": [0.0, 1.0, 0.0],
            "half": [1.0, 2.0, 3.0],
            "rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        });
        let expected = json!({
            "shapes": [
                sphere(None, [0.0, 0.0], 0.125),
                sphere(Some(1), [4.0, 1.0], 0.5),
                sphere(Some(1), [3.0, 1.0], 0.25),
                camera,
            ],
            "ignored": [[0, 1], [0, 2], [1, 3], [2, 3]],
        });
        assert_eq!(turned, expected);
        assert_eq!(
            tree(Rotation3::identity()).identity(),
            super::tests::tree(Rotation3::identity()).identity()
        );
    }

    /// The frames of links turned by quarter turns, which loses no digit here.
    #[test]
    fn frames_are_no_part_of_it() {
        let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let turned = tree(Rotation3::from_matrix_unchecked(quarter)).identity();
        assert_eq!(turned, tree(Rotation3::identity()).identity());
    }
}
