//! The base's rotation along a joint path (eqs. 9 and 19), by Magnus composition.
//!
//! With zero momentum `ω_b dt = W(θ) dθ`: the base's final attitude depends on the shape of the path
//! alone, so everything here is in normalised time. With angular momentum it depends on the duration, too ([`Drift`]). The
//! rate is in base axes, hence every step multiplies from the right.

mod curvature;
mod drift;
mod drifting;
mod magnus;
mod node;
mod rollout;
mod slopes;

pub use curvature::{Midpoints, RotationCurvature};
pub use drift::Drift;
pub use rollout::Rollout;
pub use slopes::RotationSlopes;

use drift::Collocation;
use magnus::{GAUSS, gauss_moments, magnus};
use nalgebra::UnitQuaternion;

use crate::momentum::{BaseResponse, base_twist};
use crate::robot::Robot;
use crate::so3::{self, Quat};
use crate::trajectory::Path;

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
        (Collocation::<3, 1>::new(&GAUSS, width), Quat::from(drift.start), drift.scaled_momentum())
    });
    (0..steps).map(move |i| {
        let mut at = |node: f64| {
            write((i as f64 + node) * width, &mut angles, &mut rates);
            BaseResponse::of(robot, &angles, &rates)
        };
        let Some((collocation, attitude, scaled_momentum)) = &mut drift else {
            let rates = GAUSS.map(|node| at(node).rate * width);
            return so3::exp(magnus(gauss_moments(rates))).into();
        };
        let responses = GAUSS.map(at);
        let step = collocation.panel(*attitude, *scaled_momentum, responses).rotation();
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
