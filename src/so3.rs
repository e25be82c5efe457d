//! Rotations: the exponential map, smooth at zero.

use nalgebra::{Matrix3, Quaternion, SimdBool, UnitQuaternion, Vector3};

use crate::scalar::Scalar;

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

/// The rotation by `|v|` radians about `v`.
///
/// A series in `|v|²` serves small angles, so that the value and every derivative of it are right
/// at zero, where `√(v·v)` has none.
pub fn exp<T: Scalar>(v: &Vector3<T>) -> UnitQuaternion<T> {
    let half_squared = v.dot(v) * T::of(0.25);
    let small = half_squared.simd_lt(T::of(SERIES_LIMIT));
    let series = (polynomial(&COSINE, half_squared), polynomial(&SINE, half_squared));
    let (cosine, sine) = if small.all() {
        series
    } else {
        let half = half_squared.simd_sqrt();
        let (sin, cos) = half.simd_sin_cos();
        (series.0.select(small, cos), series.1.select(small, sin / half))
    };
    let vector = v * (sine * T::of(0.5));
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, vector))
}

/// The right Jacobian of the exponential map: `exp(v + d) ≈ exp(v) exp(J d)` for small `d`.
pub fn right_jacobian(v: &Vector3<f64>) -> Matrix3<f64> {
    let squared = v.dot(v);
    // (1 − cos |v|) / |v|² is half the square of sin(|v|/2) / (|v|/2).
    let [first, second] = if squared < 4.0 * SERIES_LIMIT {
        [polynomial(&SINE, squared / 4.0).powi(2) / 2.0, polynomial(&LAG, squared)]
    } else {
        let angle = squared.sqrt();
        [(1.0 - angle.cos()) / squared, (angle - angle.sin()) / (angle * squared)]
    };
    let cross = v.cross_matrix();
    Matrix3::identity() - cross * first + cross * cross * second
}

/// Horner's rule, lowest power first.
fn polynomial<T: Scalar>(coefficients: &[f64], x: T) -> T {
    coefficients.iter().rev().fold(T::zero(), |sum, &c| sum * x + T::of(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both branches against nalgebra's closed form, across the switch at one radian.
    #[test]
    fn agrees_with_the_closed_form() {
        for angle in [1e-8, 1e-3, 0.1, 0.5, 0.999_999, 1.000_001, 2.0, 3.0, 6.0] {
            let v = Vector3::new(0.6, -0.64, 0.48) * angle;
            let difference = exp(&v).into_inner() - UnitQuaternion::new(v).into_inner();
            assert!(difference.norm() < 4e-16, "angle {angle}: {difference}");
        }
    }

    /// Against central differences of the exponential, across the switch.
    #[test]
    fn right_jacobian_is_the_derivative() {
        for angle in [0.0, 1e-6, 0.3, 0.999_999, 1.000_001, 2.5] {
            let v = Vector3::new(0.6, -0.64, 0.48) * angle;
            let jacobian = right_jacobian(&v);
            for j in 0..3 {
                let turned = |step: f64| {
                    let mut there = v;
                    there[j] += step;
                    (exp(&v).inverse() * exp(&there)).scaled_axis()
                };
                let h = 1e-4;
                let far = (turned(2.0 * h) - turned(-2.0 * h)) / (4.0 * h);
                let near = (turned(h) - turned(-h)) / (2.0 * h);
                let difference = (near * 4.0 - far) / 3.0 - jacobian.column(j);
                assert!(difference.norm() < 1e-11, "angle {angle}: {difference}");
            }
        }
    }

    #[test]
    fn zero_is_the_identity() {
        assert_eq!(exp(&Vector3::<f64>::zeros()), UnitQuaternion::identity());
    }

    /// Lanes on both sides of the switch at once.
    #[test]
    fn lanes_agree_with_scalars() {
        use nalgebra::SimdValue as _;
        use simba::simd::WideF64x4;
        let angles = [0.0, 1e-6, 0.7, 2.5];
        let lane = WideF64x4::from(angles);
        let wide = exp(&Vector3::new(lane, -lane, lane * WideF64x4::of(0.5)));
        for (i, &a) in angles.iter().enumerate() {
            let scalar = exp(&Vector3::new(a, -a, a * 0.5));
            let difference = wide.into_inner().extract(i) - scalar.into_inner();
            assert!(difference.norm() < 4e-16, "lane {i}: {difference}");
        }
    }
}
