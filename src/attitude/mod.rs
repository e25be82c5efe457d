//! The base's rotation along a joint path (eqs. 9 and 19), by Magnus composition.
//!
//! With zero momentum `ω_b dt = W(θ) dθ`: the base's final attitude depends on the shape of the path
//! alone, so everything here is in normalised time. The rate is in base axes, hence every step
//! multiplies from the right.

mod curvature;
mod node;
mod slopes;

pub use curvature::{RotationCurvature, net_rotation_curvature};
pub use slopes::{RotationSlopes, net_rotation_slopes};

use nalgebra::{UnitQuaternion, Vector3};

use crate::momentum::base_twist;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::so3;
use crate::trajectory::Path;

/// `√15`, in the sixth-order step and its three Gauss–Legendre nodes.
const SQRT_15: f64 = 3.872_983_346_207_417;

/// Where the nodes lie in a step, in its widths.
const NODES: [f64; 3] = [0.5 - SQRT_15 / 10.0, 0.5, 0.5 + SQRT_15 / 10.0];

/// The rotations of `steps` equal steps of the path, in order; their product turns the attitude at
/// the start into the attitude at the end.
///
/// One step is the sixth-order Magnus exponential on three Gauss nodes (Blanes, Casas, Oteo and Ros
/// 2009, doi:10.1016/j.physrep.2008.11.001, section 5.4), with the signs of an equation that
/// multiplies from the right.
pub fn increments<'a, T: Scalar>(
    robot: &'a Robot,
    path: &'a Path<'_, T>,
    steps: usize,
) -> impl ExactSizeIterator<Item = UnitQuaternion<T>> {
    let width = 1.0 / steps as f64;
    let mut angles = vec![T::zero(); robot.joint_count()];
    let mut rates = angles.clone();
    (0..steps).map(move |i| {
        let mut step_rate = |node: f64| {
            path.angles_and_rates((i as f64 + node) * width, &mut angles, &mut rates);
            base_twist(robot, &angles, &rates).angular * T::of(width)
        };
        so3::exp(&magnus(NODES.map(&mut step_rate)))
    })
}

/// The rotation vector of a step from the rates at its three nodes, times its width.
fn magnus<T: Scalar>([w1, w2, w3]: [Vector3<T>; 3]) -> Vector3<T> {
    let a1 = w2;
    let a2 = (w3 - w1) * T::of(SQRT_15 / 3.0);
    let a3 = (w3 - w2 * T::of(2.0) + w1) * T::of(10.0 / 3.0);
    let c1 = a2.cross(&a1);
    let c2 = a1.cross(&(a3 * T::of(2.0) + c1)) * T::of(1.0 / 60.0);
    let commutator = (c1 - a1 * T::of(20.0) - a3).cross(&(a2 + c2));
    a1 + a3 * T::of(1.0 / 12.0) - commutator * T::of(1.0 / 240.0)
}

/// The rotation of the base over the whole path, from its attitude at the start, in base axes.
pub fn net_rotation<T: Scalar>(
    robot: &Robot,
    path: &Path<'_, T>,
    steps: usize,
) -> UnitQuaternion<T> {
    increments(robot, path, steps).fold(UnitQuaternion::identity(), |net, step| net * step)
}
