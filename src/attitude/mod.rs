//! The base's rotation along a joint path (eqs. 9 and 19), by Magnus composition.
//!
//! With zero momentum `ω_b dt = W(θ) dθ`: the base's final attitude depends on the shape of the path
//! alone, so everything here is in normalised time. With angular momentum it depends on the duration, too ([`Drift`]). The
//! rate is in base axes, hence every step multiplies from the right.

mod curvature;
mod drift;
mod drifting;
mod node;
mod rollout;
mod slopes;

pub use curvature::{Midpoints, RotationCurvature};
pub use drift::Drift;
pub use rollout::Rollout;
pub use slopes::RotationSlopes;

use drift::Collocation;
use std::ops::{Add, Mul, Sub};

use nalgebra::UnitQuaternion;

use crate::momentum::{BaseResponse, base_twist};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::so3::{self, Quat};
use crate::trajectory::Path;
use crate::vec3::{Mat3, Vec3};

/// `√15`, in the three Gauss–Legendre nodes.
const SQRT_15: f64 = 3.872_983_346_207_417;

/// Where three Gauss–Legendre nodes lie in a step, in its widths.
const GAUSS: [f64; 3] = [0.5 - SQRT_15 / 10.0, 0.5, 0.5 + SQRT_15 / 10.0];

/// The rotations of `steps` equal steps of a path, in order; their product turns the attitude at the start into the
/// attitude at the end. `write` gives the path's angles and rates at a time.
///
/// Every step has three nodes of its own: the plain form of what [`Rollout`] does.
pub fn increments<'a>(
    robot: &'a Robot,
    steps: usize,
    drift: Option<Drift>,
    write: impl Fn(f64, &mut [f64], &mut [f64]) + 'a,
) -> impl ExactSizeIterator<Item = UnitQuaternion<f64>> {
    let width = 1.0 / steps as f64;
    let mut angles = vec![0.0; robot.joint_count()];
    let mut rates = angles.clone();
    let mut drift = drift.map(|drift| {
        (Collocation::<3, 1>::new(&GAUSS, width), Quat::from(drift.start), drift.impulse())
    });
    (0..steps).map(move |i| {
        let mut at = |node: f64| {
            write((i as f64 + node) * width, &mut angles, &mut rates);
            BaseResponse::of(robot, &angles, &rates)
        };
        let Some((collocation, attitude, impulse)) = &mut drift else {
            let rates = GAUSS.map(|node| at(node).rate * width);
            return so3::exp(magnus(gauss_moments(rates))).into();
        };
        let responses = GAUSS.map(at);
        let step = collocation.panel(*attitude, *impulse, responses).rotation();
        *attitude = attitude.then(step);
        step.into()
    })
}

/// The rotation of the base between two times, in base axes at the first, by one step of three nodes.
pub fn increment(
    robot: &Robot,
    [from, to]: [f64; 2],
    mut write: impl FnMut(f64, &mut [f64], &mut [f64]),
) -> UnitQuaternion<f64> {
    let mut angles = vec![0.0; robot.joint_count()];
    let mut rates = angles.clone();
    let rates_at = GAUSS.map(|node| {
        write(from + node * (to - from), &mut angles, &mut rates);
        base_twist(robot, &angles, &rates).angular * (to - from)
    });
    so3::exp(magnus(gauss_moments(rates_at))).into()
}

/// The rotation of the base over the whole path, from its attitude at the start, in base axes.
pub fn net_rotation(robot: &Robot, path: &Path<'_>, steps: usize) -> UnitQuaternion<f64> {
    let write = |tau, angles: &mut [f64], rates: &mut [f64]| {
        path.angles_and_rates(tau, angles, rates);
    };
    increments(robot, steps, None, write).fold(UnitQuaternion::identity(), |net, step| net * step)
}

/// The moments of a step from what stands at its three Gauss nodes.
fn gauss_moments<V>([w1, w2, w3]: [V; 3]) -> [V; 3]
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    [w2, (w3 - w1) * (SQRT_15 / 3.0), (w3 - w2 * 2.0 + w1) * (10.0 / 3.0)]
}

/// The rotation vector of a step, to sixth order, from its moments: `a₁ + a₂ t + a₃ t²`, `t` from −½ to ½
/// over the step, is the rate times the step's width (Blanes, Casas, Oteo and Ros 2009,
/// doi:10.1016/j.physrep.2008.11.001, section 5.4, with the signs of an equation that multiplies from
/// the right).
#[inline(always)]
fn magnus<T: Scalar>([a1, a2, a3]: [Vec3<T>; 3]) -> Vec3<T> {
    let c1 = a2.cross(a1);
    let c2 = a1.cross(a3.times(2.0) + c1).times(1.0 / 60.0);
    let commutator = (c1 - a1.times(20.0) - a3).cross(a2 + c2);
    a1 + a3.times(1.0 / 12.0) - commutator.times(1.0 / 240.0)
}

/// Derivatives of [`magnus`] by the three moments, in its order and with its letters.
#[inline(always)]
fn magnus_slopes<T: Scalar>([a1, a2, a3]: [Vec3<T>; 3]) -> [Mat3<T>; 3] {
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
