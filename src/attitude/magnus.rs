//! One Magnus step of sixth order.

use std::ops::{Add, Mul, Sub};

use crate::scalar::Scalar;
use crate::vec3::{Mat3, Vec3};

/// `√15`, in the three Gauss–Legendre nodes.
const SQRT_15: f64 = 3.872_983_346_207_417;

/// Where three Gauss–Legendre nodes lie in a step, in its widths.
pub(super) const GAUSS: [f64; 3] = [0.5 - SQRT_15 / 10.0, 0.5, 0.5 + SQRT_15 / 10.0];

/// The moments of a step from what stands at its three Gauss nodes.
pub(super) fn gauss_moments<V>([w1, w2, w3]: [V; 3]) -> [V; 3]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    [w2, (w3 - w1) * (SQRT_15 / 3.0), (w3 - w2 * 2.0 + w1) * (10.0 / 3.0)]
}

/// What the rate at each node adds to the moments of a step of this width that has its Gauss nodes at these places.
pub(super) fn step_weights<const N: usize>(
    nodes: &[f64; N],
    gauss: [f64; 3],
    width: f64,
) -> [[f64; N]; 3] {
    let mut moments = [[0.0; N]; 3];
    for n in 0..N {
        let at = |place: f64| -> f64 {
            let others = (0..N).filter(|&m| m != n);
            others.map(|m| (place - nodes[m]) / (nodes[n] - nodes[m])).product()
        };
        for (moment, own) in moments.iter_mut().zip(gauss_moments(gauss.map(|p| width * at(p)))) {
            moment[n] = own;
        }
    }
    moments
}

/// The moments of one step.
#[inline(always)]
pub(super) fn step_moments<T: Scalar, const N: usize>(
    step: &[[f64; N]; 3],
    rates: &[Vec3<T>; N],
) -> [Vec3<T>; 3] {
    let mut moments = [Vec3::zero(); 3];
    for (moment, weights) in moments.iter_mut().zip(step) {
        for n in 0..N {
            *moment = rates[n].mul_add(T::of(weights[n]), *moment);
        }
    }
    moments
}

/// The rotation vector of a step, to sixth order, from its moments: `a₁ + a₂ t + a₃ t²`, `t` from −½ to ½
/// over the step, is the rate times the step's width (Blanes, Casas, Oteo and Ros 2009,
/// doi:10.1016/j.physrep.2008.11.001, section 5.4, with the signs of an equation that multiplies from
/// the right).
#[inline(always)]
pub(super) fn magnus<T: Scalar>([a1, a2, a3]: [Vec3<T>; 3]) -> Vec3<T> {
    let c1 = a2.cross(a1);
    let c2 = a1.cross(a3.times(2.0) + c1).times(1.0 / 60.0);
    let commutator = (c1 - a1.times(20.0) - a3).cross(a2 + c2);
    a1 + a3.times(1.0 / 12.0) - commutator.times(1.0 / 240.0)
}

/// Derivatives of [`magnus`] by the three moments, in its order and with its letters.
#[inline(always)]
pub(super) fn magnus_slopes<T: Scalar>([a1, a2, a3]: [Vec3<T>; 3]) -> [Mat3<T>; 3] {
    let c1 = a2.cross(a1);
    let inner = a3.times(2.0) + c1;
    let c2 = a1.cross(inner).times(1.0 / 60.0);
    let left = Mat3::cross(c1 - a1.times(20.0) - a3);
    let right = Mat3::cross(a2 + c2);
    let (x1, x2, inner) = (Mat3::cross(a1), Mat3::cross(a2), Mat3::cross(inner));

    let one = |factor: f64| Mat3::diagonal(T::of(factor));
    // Derivatives of c1 and c2, then of the commutator, by a1, a2 and a3.
    let (c1_1, c1_2) = (x2, -x1);
    let c2_1 = (x1 * c1_1 - inner).times(1.0 / 60.0);
    let c2_2 = (x1 * c1_2).times(1.0 / 60.0);
    let c2_3 = x1.times(1.0 / 30.0);
    let by_1 = left * c2_1 - right * (c1_1 - one(20.0));
    let by_2 = left * (one(1.0) + c2_2) - right * c1_2;
    let by_3 = left * c2_3 + right;
    [
        one(1.0) - by_1.times(1.0 / 240.0),
        -by_2.times(1.0 / 240.0),
        one(1.0 / 12.0) - by_3.times(1.0 / 240.0),
    ]
}
