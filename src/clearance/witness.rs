//! The closest points of two shapes, and the normal between them.

use super::cuboid::Cuboid;
use super::mounted::Placed;
use super::segment::{Gap, Segment, array};
use crate::vec3::{Mat3, Vec3};

/// Distances of segments below this \[m\] are too short to have a direction of their own.
const SHORT: f64 = 1e-10;

/// A clearance, where it is, and along what: `points[1] − points[0] = distance · normal`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Witness {
    pub(super) distance: f64,
    pub(super) points: [Vec3<f64>; 2],
    pub(super) normal: Vec3<f64>,
}

impl Witness {
    pub(super) fn of(a: &Placed<f64>, b: &Placed<f64>) -> Self {
        match (a, b) {
            (Placed::Capsule(a, first), Placed::Capsule(b, second)) => {
                Self::segments(a, b).thicker([*first, *second])
            }
            (Placed::Cuboid(cuboid), Placed::Capsule(segment, radius)) => {
                Self::cuboids(cuboid, &segment.as_cuboid()).thicker([0.0, *radius])
            }
            (Placed::Capsule(segment, radius), Placed::Cuboid(cuboid)) => {
                Self::cuboids(cuboid, &segment.as_cuboid()).thicker([0.0, *radius]).reversed()
            }
            (Placed::Cuboid(a), Placed::Cuboid(b)) => Self::cuboids(a, b),
        }
    }
}

impl Witness {
    /// Of two segments.
    fn segments(a: &Segment<f64>, b: &Segment<f64>) -> Self {
        let [s, t] = a.nearest(b).places;
        let points = [a.at(s), b.at(t)];
        let way = points[1] - points[0];
        let distance = length(way);
        if distance > SHORT {
            return Self { distance, points, normal: way.times(1.0 / distance) };
        }
        let across = unit(a.half.cross(b.half)).or_else(|| unit(beside(a.half)));
        let across = across.or_else(|| unit(beside(b.half))).unwrap_or(X);
        let normal = if way.dot(across) < 0.0 { -across } else { across };
        Self { distance, points: [points[0], points[0] + normal.times(distance)], normal }
    }

    /// Of two boxes.
    fn cuboids(a: &Cuboid<f64>, b: &Cuboid<f64>) -> Self {
        let relative = a.relative(b);
        let crossed = relative.crossed_gaps(a.half).map(Gap::width);
        let parted = [relative.face_gaps(a.half).as_slice(), &crossed].concat();
        let along = (1..parted.len()).fold(0, |i, j| if parted[j] > parted[i] { j } else { i });
        if parted[along] > 0.0 {
            let points = a.closest_points(b);
            let way = points[1] - points[0];
            let distance = length(way);
            // Where bodies nearly touch and a plane leaves as much free, its normal has more digits.
            if distance > 1e-6 || distance > parted[along] + 1e-12 {
                return Self { distance, points, normal: way.times(1.0 / distance) };
            }
        }
        Self::along([a, b], &relative, along, parted[along])
    }

    /// Of boxes that overlap, touch or have a face or edges towards each other, from the direction that leaves the most free.
    fn along(
        [a, b]: [&Cuboid<f64>; 2],
        relative: &Cuboid<f64>,
        along: usize,
        distance: f64,
    ) -> Self {
        let (i, j) = if along < 6 { (along % 3, along % 3) } else { ((along - 6) / 3, along % 3) };
        let normal = a.axes
            * match along {
                0..3 => UNITS[i],
                3..6 => relative.axes.0[i],
                _ => unit(UNITS[i].cross(relative.axes.0[j])).unwrap_or(X),
            };
        let normal = if normal.dot(b.centre - a.centre) < 0.0 { -normal } else { normal };
        // What of both is outermost meets once one is shifted: corners, edges or faces.
        let (ours, mut theirs) = (a.outermost(normal), b.outermost(-normal));
        theirs.centre -= normal.times(distance);
        let [first, _] = ours.closest_points(&theirs);
        Self { distance, points: [first, first + normal.times(distance)], normal }
    }

    /// The same where each shape is thicker by a radius.
    fn thicker(self, radii: [f64; 2]) -> Self {
        let Self { distance, points: [a, b], normal } = self;
        let points = [a + normal.times(radii[0]), b - normal.times(radii[1])];
        Self { distance: distance - radii[0] - radii[1], points, normal }
    }

    /// From the second to the first.
    fn reversed(self) -> Self {
        let [a, b] = self.points;
        Self { points: [b, a], normal: -self.normal, ..self }
    }
}

impl Segment<f64> {
    /// A box of no thickness.
    fn as_cuboid(&self) -> Cuboid<f64> {
        let x = unit(self.half).unwrap_or(X);
        let y = unit(beside(x)).unwrap_or(X);
        let half = Vec3::new(length(self.half), 0.0, 0.0);
        Cuboid { centre: self.middle, axes: Mat3([x, y, x.cross(y)]), half }
    }
}

impl Cuboid<f64> {
    /// The closest points of this box and another one that it does not overlap.
    fn closest_points(&self, other: &Self) -> [Vec3<f64>; 2] {
        let reached = self.reached(other);
        let edge = reached.edge as usize;
        if edge < 12 {
            let point = other.edge(edge).at(reached.place);
            [self.closest(point), point]
        } else {
            let point = self.edge(edge - 12).at(reached.place);
            [point, other.closest(point)]
        }
    }

    /// The corner, edge or face that is farthest in a direction, as a box of no thickness.
    fn outermost(&self, direction: Vec3<f64>) -> Self {
        let mut half = array(self.half);
        let mut centre = self.centre;
        for (axis, half) in self.axes.0.into_iter().zip(&mut half) {
            let part = direction.dot(axis);
            if part.abs() > LEVEL {
                centre += axis.times(*half * part.signum());
                *half = 0.0;
            }
        }
        let [x, y, z] = half;
        Self { centre, half: Vec3::new(x, y, z), ..*self }
    }
}

/// Cosines below this are those of right angles.
const LEVEL: f64 = 1e-9;

const X: Vec3<f64> = Vec3 { x: 1.0, y: 0.0, z: 0.0 };
const UNITS: [Vec3<f64>; 3] = [X, Vec3 { x: 0.0, y: 1.0, z: 0.0 }, Vec3 { x: 0.0, y: 0.0, z: 1.0 }];

fn length(v: Vec3<f64>) -> f64 {
    v.dot(v).sqrt()
}

/// The direction, unless there is hardly any.
fn unit(v: Vec3<f64>) -> Option<Vec3<f64>> {
    let length = length(v);
    (length > 1e-100).then(|| v.times(1.0 / length))
}

/// A vector at right angles, not much shorter.
fn beside(v: Vec3<f64>) -> Vec3<f64> {
    let sizes = array(v.map(f64::abs));
    let least = (1..3).fold(0, |i, j| if sizes[j] < sizes[i] { j } else { i });
    v.cross(UNITS[least])
}
