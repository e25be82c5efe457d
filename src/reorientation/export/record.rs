//! All that exports say of a motion.

use crate::dynamics::{Dynamics, State};
use crate::posture::{Branches, Posture};
use crate::reorientation::motion::{self, JointMotion, Motion};
use crate::robot::{JointKind, Robot};
use crate::vec3::Vec3;

/// A sampled motion of a robot, and what follows from it: torques, and where the base is.
#[derive(Debug, Clone)]
pub struct Record<'a> {
    pub(super) robot: &'a Robot,
    /// Whether its masses stay the same on the way.
    pub(super) is_one_robot: bool,
    /// Time since the start \[s\].
    pub(in crate::reorientation) time: Vec<f64>,
    pub(in crate::reorientation) joints: Vec<JointRecord>,
    /// Numbers of the base, one for each of [`BASE`], at each time.
    pub(super) base: Vec<[f64; BASE.len()]>,
}

/// One joint over time.
#[derive(Debug, Clone)]
pub(in crate::reorientation) struct JointRecord {
    pub(in crate::reorientation) motion: JointMotion,
    /// \[N·m\], or \[N\] where it slides.
    pub(super) torque: Vec<f64>,
}

/// What is told of the base, with units: its attitude as the quaternion that turns base axes into inertial axes, and as ZYX
/// Euler angles; its centre of mass in inertial axes, with the origin where that is at the start; its angular velocity in base
/// axes.
pub(super) const BASE: [(&str, &str); 13] = [
    ("base_w", ""),
    ("base_x", ""),
    ("base_y", ""),
    ("base_z", ""),
    ("base_yaw", "rad"),
    ("base_pitch", "rad"),
    ("base_roll", "rad"),
    ("base_position_x", "m"),
    ("base_position_y", "m"),
    ("base_position_z", "m"),
    ("base_rate_x", "rad/s"),
    ("base_rate_y", "rad/s"),
    ("base_rate_z", "rad/s"),
];

/// What is told of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Rate,
    Acceleration,
    Jerk,
    /// Of joints that slide a force.
    Torque,
}

impl Quantity {
    pub(super) const ALL: [Self; 5] =
        [Self::Position, Self::Rate, Self::Acceleration, Self::Jerk, Self::Torque];

    /// Its name in tables.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Rate => "rate",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Torque => "torque",
        }
    }

    /// Its unit.
    pub(super) fn unit(self, kind: JointKind) -> &'static str {
        let [turning, sliding] = match self {
            Self::Position => ["rad", "m"],
            Self::Rate => ["rad/s", "m/s"],
            Self::Acceleration => ["rad/s^2", "m/s^2"],
            Self::Jerk => ["rad/s^3", "m/s^3"],
            Self::Torque => ["N m", "N"],
        };
        match kind {
            JointKind::Revolute => turning,
            JointKind::Prismatic => sliding,
        }
    }
}

impl<'a> Record<'a> {
    /// That of a motion of all joints of a robot.
    pub fn new(robot: &'a Robot, motion: Motion) -> Self {
        let joint = |joint: &JointMotion| JointRecord {
            motion: JointMotion {
                name: joint.name.clone(),
                kind: joint.kind,
                derivatives: Vec::new(),
            },
            torque: Vec::new(),
        };
        let joints = motion.joints.iter().map(joint).collect();
        let mut record =
            Self { robot, is_one_robot: true, time: Vec::new(), joints, base: Vec::new() };
        record.go_on(robot, motion);
        record
    }

    /// Goes on with another motion, which starts where and when this one ends, of the same joints; masses may be others.
    pub fn go_on(&mut self, robot: &Robot, motion: Motion) {
        self.is_one_robot &= robot == self.robot;
        let end = self.time.last().copied().unwrap_or_default();
        // The first sample is there already.
        let there = usize::from(!self.time.is_empty());
        let [mut zyx, origin] = match self.base.last() {
            Some([_, _, _, _, yaw, pitch, roll, x, y, z, ..]) => {
                [[*yaw, *pitch, *roll], [*x, *y, *z]]
            }
            None => [motion.base.first().map_or([0.0; 3], motion::zyx), [0.0; 3]],
        };
        let branches = Branches::of(robot);
        let mut dynamics = Dynamics::new(robot);
        let mut start = None;
        for (i, attitude) in motion.base.iter().enumerate() {
            let [positions, rates, accelerations] = [0, 1, 2].map(|order| -> Vec<f64> {
                motion.joints.iter().map(|joint| joint.derivatives[i][order]).collect()
            });
            let (positions, rates, accelerations) = (&*positions, &*rates, &*accelerations);
            let angular_momentum = Vec3::of(&(attitude.inverse() * motion.angular_momentum));
            let state = State { positions, rates, accelerations, angular_momentum };
            dynamics.evaluate(robot, state);
            let place = Posture::with(&branches, robot, positions, *attitude).position;
            let from = *start.get_or_insert(place);
            if i < there {
                continue;
            }
            for (joint, torque) in self.joints.iter_mut().zip(&dynamics.torques) {
                joint.torque.push(*torque);
            }
            zyx = motion::zyx_near(attitude, zyx);
            let [x, y, z, w] = attitude.coords.into();
            let [yaw, pitch, roll] = zyx;
            let [px, py, pz] = std::array::from_fn(|k| origin[k] + place[k] - from[k]);
            let Vec3 { x: rx, y: ry, z: rz } = dynamics.base.angular;
            self.base.push([w, x, y, z, yaw, pitch, roll, px, py, pz, rx, ry, rz]);
        }
        self.time.extend(motion.time.iter().skip(there).map(|time| end + time));
        for (joint, own) in self.joints.iter_mut().zip(motion.joints) {
            joint.motion.derivatives.extend(own.derivatives.into_iter().skip(there));
        }
    }

    /// The times \[s\].
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// How many joints it has.
    pub fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Of all joints at each time the positions \[rad or m\], then in the same order the rates, accelerations, jerks and torques
    /// \[N·m or N\].
    pub fn by_quantity(&self) -> impl Iterator<Item = f64> {
        let times = self.time.len();
        Quantity::ALL.into_iter().flat_map(move |quantity| {
            (0..times).flat_map(move |time| self.joints.iter().map(move |j| j.at(quantity, time)))
        })
    }

    /// Of the base at each time: the quaternion `w, x, y, z` that turns base axes into inertial axes; yaw, pitch and roll
    /// \[rad\]; where its centre of mass is, in inertial axes with their origin where it is at the start \[m\]; its angular
    /// velocity in base axes \[rad/s\].
    pub fn base(&self) -> &[[f64; 13]] {
        &self.base
    }

    /// Keeps the joints whose names are asked for.
    pub fn retain_joints(&mut self, is_asked: impl Fn(&str) -> bool) {
        self.joints.retain(|joint| is_asked(&joint.motion.name));
    }

    /// Whether a joint slides.
    pub(in crate::reorientation) fn slides(&self) -> bool {
        self.joints.iter().any(|joint| joint.motion.kind == JointKind::Prismatic)
    }
}

impl JointRecord {
    /// A quantity at one of the times.
    pub(super) fn at(&self, quantity: Quantity, time: usize) -> f64 {
        match quantity {
            Quantity::Torque => self.torque[time],
            _ => self.motion.derivatives[time][quantity as usize],
        }
    }
}
