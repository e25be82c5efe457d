//! Shapes of robots that state none, from masses, inertias and joints.

use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Rotation3, Vector3};

use super::link::Body;
use super::rigid::{Placed, Rigid, merged};
use super::shape::Shape;
use super::tree::Robot;

/// Where the shapes of a robot come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ShapeSource {
    /// From its file, or what a task adds. Bodies of which these say nothing have none.
    Stated,
    /// From masses, inertias and the places of joints, for want of any that are stated.
    Derived,
}

/// How far within a face's edge the mount lies at least, as a share of half the edge.
const MARGIN: f64 = 0.1;

/// The shortest length of a body between its joints, as a share of its radius: joints that are nearer meet in a point.
const SHORTEST: f64 = 0.1;

impl Robot {
    /// Half the edges \[m\] of the solid box of the base's mass whose moments of inertia about the base's axes are the base's,
    /// `e_k² = 6 (I_i + I_j − I_k) / m`, stretched or shrunk until the arm's mount lies on a face of it.
    pub fn base_box(&self) -> [f64; 3] {
        let Body { mass, inertia, .. } = self.base();
        let squared = |k: usize| 6.0 * (inertia.trace() - 2.0 * inertia[(k, k)]) / mass;
        let mean = (6.0 * inertia.trace() / (3.0 * mass)).sqrt();
        // An inertia that no solid body has would give an edge of no length.
        let mut half: [f64; 3] =
            std::array::from_fn(|k| 0.5 * squared(k).max(0.1 * mean * mean).sqrt());
        let mount: [f64; 3] = (*self.mount().translation()).into();
        let ratio = |k: usize| mount[k].abs() / half[k];
        let face = (0..3).fold(2, |face, k| if ratio(k) > ratio(face) { k } else { face });
        for (k, half) in half.iter_mut().enumerate() {
            if k != face {
                *half = half.max(mount[k].abs() / (1.0 - MARGIN));
            } else if mount[k] != 0.0 {
                *half = mount[k].abs();
            }
        }
        half
    }

    /// How many shapes base and links have together.
    pub fn shape_count(&self) -> usize {
        let links = self.links().iter().map(|link| link.body.shapes.len());
        self.base().shapes.len() + links.sum::<usize>()
    }

    /// The robot with its shapes or, where it has none at all, with derived ones: the base's [`base_box`](Self::base_box), and of
    /// every body that a joint moves a capsule from its joint to each joint or tool that it carries, or else to twice its centre of
    /// mass, as thick as the solid cylinder of its mass and least moment of inertia, at most half as thick as long. It ends
    /// where its surface meets the joints. A body whose joints meet in a point has a sphere there; bodies that meet in such a
    /// point are [ignored pairs](Self::ignored_pairs).
    pub fn with_shapes(&self) -> (Self, ShapeSource) {
        if self.shape_count() > 0 {
            return (self.clone(), ShapeSource::Stated);
        }
        let bodies = Moved::all(self);
        let base = Shape::Cuboid {
            centre: Vector3::zeros(),
            half: self.base_box().into(),
            rotation: Rotation3::identity(),
        };
        let mut shapes = vec![Vec::new(); self.links().len()];
        for body in &bodies {
            shapes[body.link] = body.shapes(&bodies);
        }
        (self.reshaped(vec![base], shapes, meeting(&bodies)), ShapeSource::Derived)
    }
}

/// A link that a joint moves, with all that is fixed to it, in the link's frame.
struct Moved {
    link: usize,
    /// Index of the body that its joint is on; `None` for the base.
    parent: Option<usize>,
    /// Of the solid cylinder with its mass and least moment of inertia \[m\]; nothing of a body without mass.
    radius: Option<f64>,
    /// Where the joint is that carries it, in the frame of the body it is on.
    joint: Vector3<f64>,
    /// Where it carries joints, or else the tool, or else twice its centre of mass.
    ends: Vec<Vector3<f64>>,
}

impl Moved {
    /// All of a robot, in the order of their joints.
    fn all(robot: &Robot) -> Vec<Self> {
        let mut bodies: Vec<Self> = Vec::new();
        let mut parts: Vec<Vec<Placed>> = Vec::new();
        // For every link the body that it is part of, and its frame there.
        let mut places: Vec<(Option<usize>, Rigid)> = Vec::new();
        let place = |places: &[(Option<usize>, Rigid)], link: Option<usize>| {
            link.map_or_else(|| (None, Rigid::identity()), |link| places[link])
        };
        for (i, link) in robot.links().iter().enumerate() {
            let (body, inner) = place(&places, link.parent);
            let mut frame = inner.then(&Rigid::of(&link.placement));
            let mut own = body;
            if link.joint.axis().is_some() {
                let joint = frame.translation;
                if let Some(body) = body {
                    bodies[body].ends.push(joint);
                }
                own = Some(bodies.len());
                bodies.push(Self { link: i, parent: body, radius: None, joint, ends: Vec::new() });
                parts.push(Vec::new());
                frame = Rigid::identity();
            }
            if let Some(own) = own {
                let turn = frame.rotation.matrix();
                parts[own].push(Placed {
                    mass: link.body.mass,
                    centre: frame.translation + frame.rotation * link.centre_of_mass,
                    inertia: turn * link.body.inertia * turn.transpose(),
                });
            }
            places.push((own, frame));
        }
        let (holder, inner) = place(&places, robot.tool().link);
        let tool = inner.then(&Rigid::of(&robot.tool().placement)).translation;
        for (i, (body, parts)) in bodies.iter_mut().zip(parts).enumerate() {
            let whole = merged(parts);
            let least = whole.inertia.symmetric_eigenvalues().min().max(0.0);
            body.radius = (whole.mass > 0.0).then(|| (2.0 * least / whole.mass).sqrt());
            if holder == Some(i) && body.has_length(&tool) {
                body.ends.push(tool);
            }
            if body.ends.is_empty() {
                body.ends.push(2.0 * whole.centre);
            }
        }
        bodies
    }

    /// Whether a place is away from the joint.
    fn has_length(&self, end: &Vector3<f64>) -> bool {
        end.norm() > SHORTEST * self.radius.unwrap_or(0.0)
    }

    /// The shortest of its lengths, where it has any \[m\].
    fn shortest(&self) -> Option<f64> {
        let lengths = self.ends.iter().filter(|end| self.has_length(end)).map(Vector3::norm);
        lengths.min_by(f64::total_cmp)
    }

    fn shapes(&self, bodies: &[Self]) -> Vec<Shape> {
        let Some(radius) = self.radius else { return Vec::new() };
        if let Some(shortest) = self.shortest() {
            let radius = radius.min(0.25 * shortest);
            let long = self.ends.iter().filter(|end| self.has_length(end));
            return long
                .map(|end| {
                    let cap = end.normalize() * radius;
                    Shape::Capsule { ends: [cap, end - cap], radius }
                })
                .collect();
        }
        let is_own =
            |body: &Self| body.parent.is_some_and(|parent| bodies[parent].link == self.link);
        let carried = bodies.iter().filter(|body| is_own(body)).filter_map(Self::shortest);
        let carrier = self.parent.map(|parent| &bodies[parent]);
        let carrier =
            carrier.filter(|body| body.has_length(&self.joint)).map(|_| self.joint.norm());
        let room = carried.chain(carrier).min_by(f64::total_cmp);
        let radius = room.map_or(radius, |room| radius.min(0.25 * room));
        let middle = self.ends.iter().sum::<Vector3<f64>>() / (2.0 * self.ends.len() as f64);
        vec![Shape::sphere(middle, radius)]
    }
}

/// The links of all pairs of bodies, the base among them, that meet in a joint and are not the two that it joins.
fn meeting(bodies: &[Moved]) -> Vec<[Option<usize>; 2]> {
    // For every joint the first of those at the same place.
    let mut places: Vec<usize> = Vec::with_capacity(bodies.len());
    for (i, body) in bodies.iter().enumerate() {
        let parent = body.parent.filter(|parent| !bodies[*parent].has_length(&body.joint));
        places.push(parent.map_or(i, |parent| places[parent]));
    }
    let mut meetings: BTreeMap<usize, BTreeSet<Option<usize>>> = BTreeMap::new();
    for (i, place) in places.into_iter().enumerate() {
        meetings.entry(place).or_default().extend([bodies[i].parent, Some(i)]);
    }
    let link = |body: Option<usize>| body.map(|body| bodies[body].link);
    let mut pairs = BTreeSet::new();
    for meeting in meetings.values() {
        for second in meeting.iter().flatten() {
            let others = meeting.range(..Some(*second)).filter(|o| **o != bodies[*second].parent);
            pairs.extend(others.map(|first| [link(*first), link(Some(*second))]));
        }
    }
    pairs.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Document;

    fn robot(text: &str) -> Robot {
        Robot::from_document(&Document::embedded("robot.toml", text)).unwrap()
    }

    fn capsule(shapes: &[Shape]) -> ([Vector3<f64>; 2], f64) {
        match shapes {
            [Shape::Capsule { ends, radius }] => (*ends, *radius),
            other => panic!("{other:?}"),
        }
    }

    /// Table 2 of the paper: joint 3 has 8.9 kg, and the least principal moment of 0.46, 0.47, 0.01 with `yz = −0.03` is
    /// `0.24 − √(0.23² + 0.03²) = 0.0080517`, so the radius is `√(2 · 0.0080517 / 8.9) = 0.042537`. Joint 4 is 0.775 m on.
    #[test]
    fn the_papers_links_are_capsules_between_joints() {
        let document = Robot::embedded("xiao2023").unwrap();
        let text = document.text();
        let own = robot(text).reshaped(Vec::new(), vec![Vec::new(); 6], Vec::new());
        let (robot, source) = own.with_shapes();
        assert_eq!(source, ShapeSource::Derived);
        assert_eq!(robot.shape_count(), 7);
        let (ends, radius) = capsule(&robot.links()[2].body.shapes);
        assert!((radius - 0.042_537).abs() < 1e-6, "{radius}");
        assert!((ends[0] - Vector3::new(0.0, 0.0, radius)).norm() < 1e-12);
        assert!((ends[1] - Vector3::new(0.0, 0.0, 0.775 - radius)).norm() < 1e-12);
        // The base's face is where the arm stands.
        let [Shape::Cuboid { half, .. }] = robot.base().shapes[..] else { panic!() };
        assert_eq!(half.z, 0.4);
        assert!(robot.ignored_pairs().is_empty());
    }

    /// A wrist whose three joints meet in a point, 0.5 m from the elbow and 0.2 m from the tool. All bodies are of 2 kg and have a
    /// least moment of 0.01 kg m², so cylinders of 0.1 m.
    const WRIST: &str = "name = 'wrist'
        base = { mass = 100, inertia = { xx = 10, yy = 10, zz = 10 } }
        tool = { link = 'hand', position = [0, 0, 0.2] }
        link = [
            { name = 'arm', position = [0, 0, 0.4], mass = 2, inertia = { xx = 0.05, yy = 0.05, zz = 0.01 }, joint = { type = 'continuous' } },
            { name = 'roll', parent = 'arm', position = [0, 0, 0.5], mass = 2, inertia = { xx = 0.05, yy = 0.05, zz = 0.01 }, joint = { type = 'continuous' } },
            { name = 'pitch', parent = 'roll', mass = 2, inertia = { xx = 0.05, yy = 0.05, zz = 0.01 }, joint = { type = 'continuous', axis = [0, 1, 0] } },
            { name = 'hand', parent = 'pitch', mass = 2, inertia = { xx = 0.05, yy = 0.05, zz = 0.01 }, joint = { type = 'continuous' } },
        ]";

    #[test]
    fn bodies_of_a_spherical_wrist_are_spheres_that_may_touch_what_meets_there() {
        let (robot, _) = robot(WRIST).with_shapes();
        let found: Vec<_> = robot.links().iter().map(|link| capsule(&link.body.shapes)).collect();
        let along = |z: f64| Vector3::new(0.0, 0.0, z);
        assert_eq!(found[0], ([along(0.1), along(0.4)], 0.1));
        // A quarter of the 0.5 m from the elbow, and of the 0.2 m to the tool, beyond which neighbours are.
        assert_eq!(found[1], ([Vector3::zeros(); 2], 0.1));
        assert_eq!(found[2], ([Vector3::zeros(); 2], 0.05));
        assert_eq!(found[3], ([along(0.05), along(0.2 - 0.05)], 0.05));
        let pairs = [[0, 2], [0, 3], [1, 3]].map(|pair| pair.map(Some));
        assert_eq!(robot.ignored_pairs(), pairs);
    }

    /// What a robot states counts alone, and the tool's load is part of what carries it.
    #[test]
    fn stated_shapes_stay_alone() {
        let text = WRIST.replace(
            "{ name = 'hand',",
            "{ name = 'hand', shapes = [{ sphere = { radius = 0.3 } }],",
        );
        let stated = robot(&text);
        let (same, source) = stated.with_shapes();
        assert_eq!((same, source), (stated, ShapeSource::Stated));
    }
}
