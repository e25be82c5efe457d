//! Rotations: the exponential map, smooth at zero.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::lanes::{Lanes, MOST};
use crate::scalar::{Scalar, polynomial};
use crate::vec3::{Mat3, Vec3};

/// Half angle, squared, below which the exponential is summed as a series.
const SERIES_LIMIT: f64 = 0.25;

/// Coefficients of `cos √u` in powers of `u`; the first one left out is `u⁸/16!`, below 1e-18.
const COSINE: [f64; 8] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];

/// Coefficients of `sin √u / √u` in powers of `u`.
const SINE: [f64; 8] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];

/// Coefficients of `(√u − sin √u) / (u √u)` in powers of `u`.
const LAG: [f64; 8] = [
    1.0 / 6.0,
    -1.0 / 120.0,
    1.0 / 5_040.0,
    -1.0 / 362_880.0,
    1.0 / 39_916_800.0,
    -1.0 / 6_227_020_800.0,
    1.0 / 1_307_674_368_000.0,
    -1.0 / 355_687_428_096_000.0,
];

/// A unit quaternion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quat<T> {
    /// Scalar part.
    pub scalar: T,
    /// Vector part.
    pub vector: Vec3<T>,
}

impl<T: Scalar> Quat<T> {
    /// No rotation.
    #[inline(always)]
    pub fn identity() -> Self {
        Self { scalar: T::of(1.0), vector: Vec3::zero() }
    }

    /// This rotation, then `next` about axes that it has turned: `self ⊗ next`.
    #[inline(always)]
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        let Self { scalar: a, vector: u } = self;
        let Self { scalar: b, vector: v } = next;
        let vector = v.mul_add(a, u.mul_add(b, u.cross(v)));
        Self { scalar: a * b - u.dot(v), vector }
    }

    /// The rotation back.
    #[inline(always)]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { vector: -self.vector, ..self }
    }

    /// Turns vectors as the rotation does.
    #[inline(always)]
    pub fn matrix(self) -> Mat3<T> {
        let Self { scalar: w, vector: v } = self;
        let cross = Mat3::cross(v);
        let turn = cross * cross + Mat3::cross(v * w);
        Mat3::diagonal(T::of(1.0)) + turn.times(2.0)
    }
}

impl<T: Lanes> Quat<T> {
    /// From one quaternion per lane.
    #[inline(always)]
    pub fn gather(from: &[Quat<f64>]) -> Self {
        let part = |part: fn(&Quat<f64>) -> f64| {
            let mut numbers = [0.0; MOST];
            for (number, from) in numbers.iter_mut().zip(&from[..T::COUNT]) {
                *number = part(from);
            }
            T::load(&numbers)
        };
        let vector = Vec3::new(part(|q| q.vector.x), part(|q| q.vector.y), part(|q| q.vector.z));
        Self { scalar: part(|q| q.scalar), vector }
    }

    /// Writes every lane's quaternion to a place of its own.
    #[inline(always)]
    pub fn spread(self, to: &mut [Quat<f64>]) {
        let (scalars, vectors) = (self.scalar.numbers(), self.vector.lanes());
        for (i, to) in to[..T::COUNT].iter_mut().enumerate() {
            *to = Quat { scalar: scalars[i], vector: vectors[i] };
        }
    }
}

impl From<Quat<f64>> for UnitQuaternion<f64> {
    fn from(q: Quat<f64>) -> Self {
        Self::new_unchecked(Quaternion::from_parts(q.scalar, q.vector.into()))
    }
}

impl From<UnitQuaternion<f64>> for Quat<f64> {
    fn from(q: UnitQuaternion<f64>) -> Self {
        Self { scalar: q.scalar(), vector: Vec3::of(&q.imag()) }
    }
}

/// The rotation by `|v|` radians about `v`.
///
/// A series in `|v|²` serves small angles, so that the value and every derivative of it are right
/// at zero, where `√(v·v)` has none.
#[inline(always)]
pub fn exp<T: Scalar>(v: Vec3<T>) -> Quat<T> {
    let half_squared = v.dot(v) * T::of(0.25);
    let (mut scalar, mut sine) =
        (polynomial(&COSINE, half_squared), polynomial(&SINE, half_squared));
    if !half_squared.all_below(SERIES_LIMIT) {
        let half = half_squared.sqrt();
        let (sin, cos) = half.sin_cos();
        scalar = half_squared.select_below(SERIES_LIMIT, scalar, cos);
        sine = half_squared.select_below(SERIES_LIMIT, sine, sin / half);
    }
    Quat { scalar, vector: v * (sine * T::of(0.5)) }
}

/// The right Jacobian of the exponential map: `exp(v + d) ≈ exp(v) exp(J d)` for small `d`.
#[inline(always)]
pub fn right_jacobian<T: Scalar>(v: Vec3<T>) -> Mat3<T> {
    let squared = v.dot(v);
    // (1 − cos |v|) / |v|² is half the square of sin(|v|/2) / (|v|/2).
    let sine = polynomial(&SINE, squared * T::of(0.25));
    let (mut first, mut second) = (sine * sine * T::of(0.5), polynomial(&LAG, squared));
    let limit = 4.0 * SERIES_LIMIT;
    if !squared.all_below(limit) {
        let angle = squared.sqrt();
        let (sin, cos) = angle.sin_cos();
        first = squared.select_below(limit, first, (T::of(1.0) - cos) / squared);
        second = squared.select_below(limit, second, (angle - sin) / (angle * squared));
    }
    let cross = Mat3::cross(v);
    let square = cross * cross;
    Mat3::diagonal(T::of(1.0)) - cross * first + square * second
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    fn along(angle: f64) -> Vec3<f64> {
        Vec3::new(0.6, -0.64, 0.48) * angle
    }

    /// Both branches against nalgebra's closed form, across the switch at one radian.
    #[test]
    fn agrees_with_the_closed_form() {
        for angle in [1e-8, 1e-3, 0.1, 0.5, 0.999_999, 1.000_001, 2.0, 3.0, 6.0] {
            let v = along(angle);
            let found = UnitQuaternion::from(exp(v)).into_inner();
            let difference = found - UnitQuaternion::new(v.into()).into_inner();
            assert!(difference.norm() < 4e-16, "angle {angle}: {difference}");
        }
    }

    /// Against central differences of the exponential, across the switch.
    #[test]
    fn right_jacobian_is_the_derivative() {
        for angle in [0.0, 1e-6, 0.3, 0.999_999, 1.000_001, 2.5] {
            let v = Vector3::from(along(angle));
            let jacobian = Matrix3::from(right_jacobian(along(angle)));
            for j in 0..3 {
                let turned = |step: f64| {
                    let mut there = v;
                    there[j] += step;
                    let change = exp(Vec3::of(&v)).inverse().then(exp(Vec3::of(&there)));
                    UnitQuaternion::from(change).scaled_axis()
                };
                let h = 1e-4;
                let far = (turned(2.0 * h) - turned(-2.0 * h)) / (4.0 * h);
                let near = (turned(h) - turned(-h)) / (2.0 * h);
                let difference = (near * 4.0 - far) / 3.0 - jacobian.column(j);
                assert!(difference.norm() < 1e-11, "angle {angle}: {difference}");
            }
        }
    }

    /// Products and matrices against nalgebra's.
    #[test]
    fn composes_and_turns_as_nalgebra_does() {
        let (a, b) = (exp(along(0.7)), exp(Vec3::new(0.2, 1.1, -0.4)));
        let [p, q] = [a, b].map(UnitQuaternion::from);
        let product = UnitQuaternion::from(a.then(b));
        assert!((product.into_inner() - (p * q).into_inner()).norm() < 4e-16);
        let difference = Matrix3::from(b.matrix()) - q.to_rotation_matrix().into_inner();
        assert!(difference.norm() < 1e-15, "{difference}");
    }

    #[test]
    fn zero_is_the_identity() {
        assert_eq!(exp(Vec3::<f64>::zero()), Quat::identity());
    }
}
