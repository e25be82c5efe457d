//! A motion as a film: the robot, the goal of its base, the path of its tool, and what it keeps out of.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::motion::Motion;
use super::snapshot::Snapshot;
use crate::clearance::Anchor;
use crate::film::{Camera, Form, Label, Line, Picture, Scene, Size, Solid, View};
use crate::kinematics::Outward;
use crate::posture::{BaseBox, Branches, Posture, Satellite};
use crate::robot::{Link, Robot, Shape};
use crate::task::{ClearanceLimit, Task};

/// Colours of what is drawn; bodies of the arm take turns.
const BODY: [u8; 3] = [216, 210, 196];
const PANEL: [u8; 3] = [70, 104, 168];
const ARM: [[u8; 3]; 2] = [[232, 158, 72], [128, 140, 156]];
const BONE: [u8; 3] = [92, 100, 112];
const KEEP_OUT: [u8; 3] = [204, 121, 167];
const KEEP_OUT_OPACITY: f64 = 0.55;
const GOAL: [u8; 3] = [0, 114, 178];
const PASSED: [u8; 3] = [190, 30, 45];
const AHEAD: [u8; 3] = [224, 196, 198];
const AXES: [(&str, [u8; 3]); 3] = [("x", [181, 71, 8]), ("y", [0, 112, 79]), ("z", [0, 90, 150])];

/// Widths of lines in a picture of 1080 rows \[pixels\], and the goal's dashes.
const PATH_WIDTH: f64 = 4.0;
const GOAL_WIDTH: f64 = 2.4;
const GOAL_DASH: f64 = 10.0;
const AXIS_WIDTH: f64 = 4.5;

/// The length of the base's axes, in half the base's longest edge, and where their letters are.
const AXIS: f64 = 1.7;
const LETTER: f64 = 1.12;

/// The radius of what joins joints, as a share of the robot's size.
const BONE_RADIUS: f64 = 0.008;

/// By how much every other body of the arm is wider than it is: of two with the same round end at a joint one is seen there.
const WIDER: f64 = 1.01;

/// Most pieces of the tool's path.
const PATH_PIECES: usize = 600;

/// Most postures that the view is chosen for.
const FITTED: usize = 120;

/// How pictures of a motion are drawn.
#[derive(Debug)]
pub struct MotionFilm<'a> {
    task: &'a Task,
    /// The robot with shapes, stated or derived.
    robot: Robot,
    motion: &'a Motion,
    branches: Branches,
    /// The base in its axes.
    base: Vec<Solid>,
    /// Half the longest edge of the base's body \[m\].
    base_size: f64,
    /// Whether rods stand for bodies of the arm that have no shapes, and the radius of these \[m\].
    has_bones: bool,
    bone: f64,
    /// Keep-outs, by what they are fixed in.
    keep_outs: Vec<(Anchor, Solid)>,
    /// Edges of the base at its goal.
    goal: Vec<Line>,
    /// Places of the tool, and the sample of each.
    path: Vec<(usize, Vector3<f64>)>,
    camera: Camera,
    size: Size,
}

impl<'a> MotionFilm<'a> {
    /// A motion of the task's robot, seen from a direction, in pictures of that size.
    pub fn new(task: &'a Task, motion: &'a Motion, view: View, size: Size) -> Self {
        let branches = Branches::of(&task.robot);
        let satellite = Satellite::of(&task.robot);
        let blocks = satellite.blocks();
        let last = motion.time.len().saturating_sub(1);
        let snapshot = |i: usize| Snapshot::of(task, &branches, motion, i);
        let pieces = PATH_PIECES.min(last).max(1);
        let path = (0..=pieces).map(|k| k * last / pieces).map(|i| (i, snapshot(i).tool));
        let keep_outs = task.path.clearance.iter().flat_map(ClearanceLimit::solids);
        let keep_outs = keep_outs.map(|solid| {
            let form = form(&solid.shape, &Vector3::zeros(), &Rotation3::identity());
            (solid.anchor, Solid { form, colour: KEEP_OUT, opacity: KEEP_OUT_OPACITY })
        });
        let size_of = |block: &BaseBox| block.edges.iter().map(Vector3::norm).fold(0.0, f64::max);
        let robot = task.robot.with_shapes().0;
        let is_bare = |link: &Link| link.joint.axis().is_some() && link.body.shapes.is_empty();
        let mut film = Self {
            task,
            has_bones: robot.links().iter().any(is_bare),
            robot,
            motion,
            base: base(&satellite, &blocks),
            base_size: blocks.first().map_or(0.0, size_of),
            bone: 0.0,
            keep_outs: keep_outs.collect(),
            goal: goal(task, &blocks),
            path: path.collect(),
            camera: Camera::around(&[], view, size),
            size,
            branches,
        };
        let length = |[from, to]: &[Vector3<f64>; 2]| (to - from).norm();
        let reach: f64 = film.snapshot(0).links.iter().map(length).sum();
        film.bone = BONE_RADIUS * reach;
        let step = (last / FITTED).max(1);
        let mut places = Vec::new();
        for sample in (0..=last).step_by(step).chain([last]) {
            let now = film.snapshot(sample);
            let solids = film.solids(&now, sample);
            places.extend(solids.iter().flat_map(|solid| solid.form.corners()));
            places.extend((0..3).map(|axis| film.axis_end(&now, axis, LETTER)));
        }
        places.extend(film.goal.iter().flat_map(|line| &line.places));
        places.extend(film.path.iter().map(|(_, place)| place));
        film.camera = Camera::around(&places, view, size);
        film
    }

    /// The picture of a sample of the motion.
    pub fn picture(&self, sample: usize) -> Picture {
        self.scene(sample).picture(&self.camera, self.size)
    }

    /// Where one of the base's axes ends, or so many times as far from the base.
    fn axis_end(&self, now: &Snapshot, axis: usize, times: f64) -> Vector3<f64> {
        now.base + now.attitude * Vector3::ith(axis, times * AXIS * self.base_size)
    }

    fn snapshot(&self, sample: usize) -> Snapshot {
        Snapshot::of(self.task, &self.branches, self.motion, sample)
    }

    fn scene(&self, sample: usize) -> Scene {
        let now = self.snapshot(sample);
        let mut scene = Scene { solids: self.solids(&now, sample), ..Scene::default() };
        scene.lines.extend(self.goal.iter().cloned());
        let (passed, ahead): (Vec<_>, Vec<_>) = self.path.iter().partition(|(i, _)| *i <= sample);
        let passed = passed.into_iter().map(|(_, place)| place).chain([now.tool]);
        let ahead = std::iter::once(now.tool).chain(ahead.into_iter().map(|(_, place)| place));
        let path = |places: Vec<Vector3<f64>>, colour| Line {
            places,
            colour,
            width: PATH_WIDTH,
            dashes: None,
        };
        scene.lines.extend([path(ahead.collect(), AHEAD), path(passed.collect(), PASSED)]);
        for (k, (text, colour)) in AXES.into_iter().enumerate() {
            let places = vec![now.base, self.axis_end(&now, k, 1.0)];
            scene.lines.push(Line { places, colour, width: AXIS_WIDTH, dashes: None });
            scene.labels.push(Label { text, place: self.axis_end(&now, k, LETTER), colour });
        }
        let left = now.attitude.angle_to(&self.task.goal.base).to_degrees();
        scene.caption.push(format!("t = {:.2} s", now.time));
        scene.caption.push(format!("base {left:.1}° from its goal"));
        scene
    }

    /// The robot, and what it keeps out of.
    fn solids(&self, now: &Snapshot, sample: usize) -> Vec<Solid> {
        let turn = now.attitude.to_rotation_matrix();
        let mut solids: Vec<Solid> =
            self.base.iter().map(|solid| moved(solid, &now.base, &turn)).collect();
        let bone = |ends: &[Vector3<f64>; 2]| Solid {
            form: Form::Capsule { ends: *ends, radius: self.bone },
            colour: BONE,
            opacity: 1.0,
        };
        if self.has_bones {
            solids.extend(now.links.iter().map(bone));
        }
        let positions: Vec<f64> =
            self.motion.joints.iter().map(|joint| joint.derivatives[sample][0]).collect();
        // For every link, how many joints that move are between the base and it, its own included.
        let mut depths: Vec<usize> = Vec::new();
        for own in Outward::<f64>::new(&self.robot, &positions) {
            let carrier = own.link.parent.map_or(0, |parent| depths[parent]);
            let depth = carrier + usize::from(own.link.joint.axis().is_some());
            depths.push(depth);
            let place = Vector3::from(own.frame.position);
            let rotation = Matrix3::from_columns(&own.frame.rotation.0.map(Vector3::from));
            let origin = now.base + now.attitude * place;
            let axes = turn * Rotation3::from_matrix_unchecked(rotation);
            let wider = if depth % 2 == 1 { WIDER } else { 1.0 };
            solids.extend(own.link.body.shapes.iter().map(|shape| Solid {
                form: match form(shape, &origin, &axes) {
                    Form::Capsule { ends, radius } => {
                        Form::Capsule { ends, radius: wider * radius }
                    }
                    cuboid @ Form::Cuboid { .. } => cuboid,
                },
                colour: if depth == 0 { BODY } else { ARM[(depth - 1) % ARM.len()] },
                opacity: 1.0,
            }));
        }
        solids.extend(self.keep_outs.iter().map(|(anchor, solid)| match anchor {
            Anchor::Base => moved(solid, &now.base, &turn),
            Anchor::Inertial => solid.clone(),
        }));
        solids
    }
}

/// A shape of a frame that sits so.
fn form(shape: &Shape, origin: &Vector3<f64>, turn: &Rotation3<f64>) -> Form {
    match shape.moved(origin, turn) {
        Shape::Capsule { ends, radius } => Form::Capsule { ends, radius },
        Shape::Cuboid { centre, half, rotation } => {
            let edge = |k: usize| rotation * Vector3::ith(k, half[k]);
            Form::Cuboid { centre, edges: [edge(0), edge(1), edge(2)] }
        }
    }
}

/// A solid of base axes in inertial axes.
fn moved(solid: &Solid, origin: &Vector3<f64>, turn: &Rotation3<f64>) -> Solid {
    let place = |place: &Vector3<f64>| origin + turn * place;
    let form = match &solid.form {
        Form::Capsule { ends, radius } => {
            Form::Capsule { ends: [place(&ends[0]), place(&ends[1])], radius: *radius }
        }
        Form::Cuboid { centre, edges } => {
            Form::Cuboid { centre: place(centre), edges: edges.map(|edge| turn * edge) }
        }
    };
    Solid { form, ..*solid }
}

/// The base in its axes: its stated shapes, or else a box with two panels.
fn base(satellite: &Satellite, blocks: &[BaseBox]) -> Vec<Solid> {
    let solid = |form, colour| Solid { form, colour, opacity: 1.0 };
    let colour = |block: &BaseBox| if block.is_flat() { PANEL } else { BODY };
    if !satellite.stated.is_empty() {
        let (origin, turn) = (Vector3::zeros(), Rotation3::identity());
        let own =
            |shape: &Shape| solid(form(shape, &origin, &turn), colour(&BaseBox::around(shape)));
        return satellite.stated.iter().map(own).collect();
    }
    let block = |block: &BaseBox| {
        let BaseBox { centre, edges } = block;
        solid(Form::Cuboid { centre: *centre, edges: *edges }, colour(block))
    };
    let radius = 0.06 * satellite.half[0];
    let booms = satellite
        .panels
        .iter()
        .map(|panel| solid(Form::Capsule { ends: panel.boom.map(Vector3::from), radius }, BONE));
    blocks.iter().map(block).chain(booms).collect()
}

/// The edges of the base at its goal.
fn goal(task: &Task, blocks: &[BaseBox]) -> Vec<Line> {
    let attitude: UnitQuaternion<f64> = task.goal.base;
    let posture = Posture::of(&task.robot, &task.goal.joints, attitude);
    let place = |place: Vector3<f64>| Vector3::from(posture.position) + attitude * place;
    let edges = blocks.iter().flat_map(BaseBox::outline);
    let line = |ends: [Vector3<f64>; 2]| Line {
        places: ends.map(place).to_vec(),
        colour: GOAL,
        width: GOAL_WIDTH,
        dashes: Some(GOAL_DASH),
    };
    edges.map(line).collect()
}
