//! Distances of random shapes, by certificates: two points of two convex shapes bound their distance from above, and what the
//! shapes leave free between them along any direction bounds it from below. Where both agree the distance is exact. Where they
//! overlap it is the other way round: any direction bounds from above how far they do.

use nalgebra::{Rotation3, Vector3};

use super::Random;
use crate::clearance::mounted::{Carrier, Mounted, Owner, Placed};
use crate::clearance::witness::Witness;
use crate::robot::{Rigid, Shape};

impl Random {
    /// A third of them with all edges along axes, and numbers that make edges, faces and corners meet; a third nearly so.
    fn shape(&mut self, spread: f64) -> Shape {
        let kind = self.index(3);
        let noise = 0.1_f64.powi(3 + self.index(15) as i32);
        let mut vector = |limit: f64| {
            let v = self.vector(limit);
            let even = v.map(|x| (x * 4.0).round() / 4.0);
            match kind {
                0 => even,
                1 => even + self.vector(noise),
                _ => v,
            }
        };
        let (centre, half) = (vector(spread), vector(1.0));
        let turn = match kind {
            0 => Vector3::zeros(),
            1 => self.vector(noise),
            _ => self.vector(3.0),
        };
        match self.index(8) {
            0 => Shape::sphere(centre, self.within(0.5).abs()),
            1 | 2 => Shape::Capsule { ends: [centre - half, centre + half], radius: 0.0 },
            3 => Shape::Capsule { ends: [centre, centre + half], radius: self.within(0.5).abs() },
            kind => {
                let mut half = half.abs();
                if kind == 4 {
                    half.z = 0.0;
                }
                Shape::Cuboid { centre, half, rotation: Rotation3::from_scaled_axis(turn) }
            }
        }
    }
}

/// How far a shape reaches along a direction.
fn reach(shape: &Shape, along: Vector3<f64>) -> f64 {
    match shape {
        Shape::Capsule { ends: [a, b], radius } => along.dot(a).max(along.dot(b)) + radius,
        Shape::Cuboid { centre, half, rotation } => {
            along.dot(centre) + (rotation.inverse() * along).abs().dot(half)
        }
    }
}

fn radius(shape: &Shape) -> f64 {
    match shape {
        Shape::Capsule { radius, .. } => *radius,
        Shape::Cuboid { .. } => 0.0,
    }
}

/// How far a point is out of a shape.
fn outside(shape: &Shape, point: Vector3<f64>) -> f64 {
    match shape {
        Shape::Capsule { ends: [a, b], radius } => {
            let way = b - a;
            let along = (point - a).dot(&way) / way.norm_squared().max(1e-300);
            (point - a - way * along.clamp(0.0, 1.0)).norm() - radius
        }
        Shape::Cuboid { centre, half, rotation } => {
            let p = rotation.inverse() * (point - centre);
            (p - p.zip_map(half, |p, h| p.clamp(-h, h))).norm()
        }
    }
}

fn placed(shape: &Shape) -> Placed<f64> {
    Mounted::new((Owner::Base, 0), Carrier::Base, &Rigid::identity(), shape).still()
}

fn directions() -> Vec<Vector3<f64>> {
    let mut random = Random::new(9);
    (0..300).map(|_| random.vector(1.0).normalize()).collect()
}

#[test]
fn distances_are_certified() {
    let mut random = Random::new(3);
    let directions = directions();
    let (mut apart, mut over) = (0, 0);
    for n in 0..40_000 {
        let spread = if n % 3 == 0 { 0.5 } else { 2.0 };
        let (a, b) = (random.shape(spread), random.shape(spread));
        let Witness { distance, points, normal } = Witness::of(&placed(&a), &placed(&b));
        let told = format!("{n}: {distance} {points:?} {normal:?}\n{a:?}\n{b:?}");
        let normal = Vector3::from(normal);
        let [p, q] = points.map(Vector3::from);
        assert!((normal.norm() - 1.0).abs() < 1e-12, "{told}");
        assert!((q - p - normal * distance).norm() < 1e-12, "{told}");
        let lane = placed(&a).clearance(&placed(&b), f64::INFINITY);
        assert!((distance - lane).abs() < 1e-12, "{lane} {told}");
        for far in [0.1, 0.5] {
            let bound = placed(&a).clearance(&placed(&b), far);
            assert!(bound == lane || (far..=distance + 1e-12).contains(&bound), "{bound} {told}");
        }
        let free = |along: Vector3<f64>| -reach(&a, along) - reach(&b, -along);
        // Squares tell the closest points, so of shapes with edges that nearly meet these have half the digits of the distance.
        // Where boxes and axes of capsules nearly meet, the way between them is too short to have all digits.
        let bare = distance + radius(&a) + radius(&b);
        let is_short = bare > 0.0 && bare < 1e-6;
        assert!(is_short || (free(normal) - distance).abs() < 1e-7, "{} {told}", free(normal));
        assert!(outside(&a, p) < 1e-7 && outside(&b, q) < 1e-7, "{told}");
        *(if distance > 0.0 { &mut apart } else { &mut over }) += 1;
        for along in &directions {
            assert!(free(*along) <= distance + 1e-12, "{} {told}", free(*along));
        }
    }
    assert!(apart > 20_000 && over > 5_000, "{apart} {over}");
}
