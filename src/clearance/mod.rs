//! How far the bodies of a floating robot are from each other and from solids nearby.
//!
//! The clearance of two shapes is their distance where they are apart. Where they overlap it is negative: the length of
//! the shortest shift that parts them. It is a convex function of where one is against the other, and its slope
//! is a unit vector everywhere.
//!
//! - Capsules: the distance of their segments minus both radii.
//! - Capsule and cuboid: the segment's clearance from the box minus the radius. Outside, the squared distance to the box has a
//!   slope that is monotone and piecewise linear along the segment, so its zero is known in closed form. Inside, the
//!   shortest shift is along a normal of a face or along a product of an edge and the segment.
//! - Cuboids: outside, one of two closest points is on an edge, so the least over the edges of each against the other. Inside,
//!   the shortest shift is along a normal of a face or along a product of two edges.
//!
//! Bodies are what moves as one: links that fixed joints join. The clearance of two bodies is the least of their shapes'.
//! Where the distance is smooth, a change of it is `n · (v_b − v_a)` with the unit normal `n` from the first to the second, and the
//! velocities of both bodies at a point of the line that joins the closest points.
//!
//! All is worked out in base axes. A solid that is fixed in inertial axes, whose origin is the system's centre of mass,
//! moves there with the base's attitude and with the centre of mass.

mod bodies;
mod cuboid;
mod mounted;
mod scene;
mod segment;
mod witness;

pub use bodies::{Bodies, Overlap, Pair};
pub use mounted::{Anchor, Owner, Solid};
pub use scene::{Clearance, Scene, Slopes};

#[cfg(test)]
mod tests;
