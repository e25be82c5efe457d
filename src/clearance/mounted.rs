//! Shapes, what carries them, and where they are.

use nalgebra::{Rotation3, Vector3};

use super::cuboid::Cuboid;
use super::segment::Segment;
use crate::kinematics::Pose;
use crate::robot::{Rigid, Shape};
use crate::scalar::Scalar;
use crate::vec3::{Mat3, Vec3};

/// A solid that bodies have to keep out of.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// What messages call it.
    pub name: String,
    /// Its shape, in the axes that it is fixed in.
    pub shape: Shape,
    /// What it is fixed in.
    pub anchor: Anchor,
}

/// What a solid is fixed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Base axes: it moves with the base.
    Base,
    /// Inertial axes, with their origin at the system's centre of mass.
    Inertial,
}

/// What a shape belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// The base.
    Base,
    /// The link of this index.
    Link(usize),
    /// The solid of this index.
    Solid(usize),
}

/// What moves a shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Carrier {
    Base,
    /// The link of this index, which a joint moves.
    Link(usize),
    /// Nothing: it is fixed in inertial axes.
    Inertial,
}

/// A shape in the frame of what carries it.
#[derive(Debug, Clone)]
pub(super) struct Mounted {
    pub(super) owner: Owner,
    /// Its place among the shapes of its owner.
    pub(super) index: usize,
    pub(super) carrier: Carrier,
    solid: Placed<f64>,
}

/// A shape in base axes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Placed<T> {
    Capsule(Segment<T>, f64),
    Cuboid(Cuboid<T>),
}

impl Mounted {
    /// A shape in a frame that sits so in that of the carrier.
    pub(super) fn new(
        (owner, index): (Owner, usize),
        carrier: Carrier,
        frame: &Rigid,
        shape: &Shape,
    ) -> Self {
        let Rigid { translation, rotation } = frame;
        let place = |point: &Vector3<f64>| Vec3::of(&(translation + rotation * point));
        let turn = |vector: Vector3<f64>| Vec3::of(&(rotation * vector));
        let solid = match shape {
            Shape::Capsule { ends: [a, b], radius } => {
                let half = turn((b - a) / 2.0);
                Placed::Capsule(Segment { middle: place(&((a + b) / 2.0)), half }, *radius)
            }
            Shape::Cuboid { centre, half, rotation: own } => {
                let turn: Rotation3<f64> = rotation * own;
                let axes = Mat3::of(turn.matrix());
                Placed::Cuboid(Cuboid { centre: place(centre), axes, half: Vec3::of(half) })
            }
        };
        Self { owner, index, carrier, solid }
    }

    /// The shape where its carrier's frame is so.
    #[inline(always)]
    pub(super) fn at<T: Scalar>(&self, frame: &Pose<T>) -> Placed<T> {
        match &self.solid {
            Placed::Capsule(Segment { middle, half }, radius) => Placed::Capsule(
                Segment {
                    middle: frame.position + frame.rotation * middle.lift(),
                    half: frame.rotation * half.lift(),
                },
                *radius,
            ),
            Placed::Cuboid(Cuboid { centre, axes, half }) => {
                let Mat3([x, y, z]) = *axes;
                Placed::Cuboid(Cuboid {
                    centre: frame.position + frame.rotation * centre.lift(),
                    axes: frame.rotation * Mat3([x.lift(), y.lift(), z.lift()]),
                    half: *half,
                })
            }
        }
    }

    /// The shape in the axes of its carrier.
    #[inline(always)]
    pub(super) fn still<T: Scalar>(&self) -> Placed<T> {
        match &self.solid {
            Placed::Capsule(Segment { middle, half }, radius) => {
                Placed::Capsule(Segment { middle: middle.lift(), half: half.lift() }, *radius)
            }
            Placed::Cuboid(Cuboid { centre, axes: Mat3([x, y, z]), half }) => {
                let axes = Mat3([x.lift(), y.lift(), z.lift()]);
                Placed::Cuboid(Cuboid { centre: centre.lift(), axes, half: *half })
            }
        }
    }
}

impl<T: Scalar> Placed<T> {
    /// A point, for room that is filled later.
    #[inline(always)]
    pub(super) fn nothing() -> Self {
        Self::Capsule(Segment { middle: Vec3::zero(), half: Vec3::zero() }, 0.0)
    }

    /// Clearance from another shape. From `far` on a lower bound, which is not below `far`, may be told.
    #[inline(always)]
    pub(super) fn clearance(&self, other: &Self, far: f64) -> T {
        match (self, other) {
            (Self::Capsule(a, first), Self::Capsule(b, second)) => {
                a.nearest(b).squared.sqrt() - T::of(first + second)
            }
            (Self::Capsule(segment, radius), Self::Cuboid(cuboid))
            | (Self::Cuboid(cuboid), Self::Capsule(segment, radius)) => {
                cuboid.inward(segment).clearance(*radius, cuboid.half, far)
            }
            (Self::Cuboid(a), Self::Cuboid(b)) => a.clearance(b, far),
        }
    }
}
