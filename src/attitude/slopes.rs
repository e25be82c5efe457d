//! The base's rotation along a path with its derivatives by the path's coefficients.

use nalgebra::{Matrix3, Matrix3xX, UnitQuaternion, Vector3};

use super::node::Node;
use super::{NODES, SQRT_15, magnus};
use crate::robot::Robot;
use crate::so3;
use crate::trajectory::Path;

/// The base's rotation over a path and how it changes with the path.
#[derive(Debug, Clone)]
pub struct RotationSlopes {
    /// The rotation, from the attitude at the start, in base axes.
    pub rotation: UnitQuaternion<f64>,
    /// Angular change in base axes at the end \[rad\], one column a coefficient of the path.
    pub by_coefficient: Matrix3xX<f64>,
}

/// [`net_rotation`](super::net_rotation) with its derivatives.
///
/// A change of the rotation vector `Ω` of one step turns the end by `Qᵀ J(Ω) dΩ`, where `J` is the
/// right Jacobian and `Q` the rotation of all steps that follow.
pub fn net_rotation_slopes(robot: &Robot, path: &Path<'_, f64>, steps: usize) -> RotationSlopes {
    let width = 1.0 / steps as f64;
    let mut rotation = UnitQuaternion::identity();
    let mut by_coefficient = Matrix3xX::zeros(path.dimension());
    let mut nodes = std::array::from_fn(|_| Node::new(robot));
    for step in (0..steps).rev() {
        let times = NODES.map(|node| (step as f64 + node) * width);
        for (node, tau) in nodes.iter_mut().zip(times) {
            node.evaluate(robot, path, tau);
        }
        let rates = nodes.each_ref().map(|node| node.rate() * width);
        let vector = magnus(rates);
        let following = rotation.to_rotation_matrix();
        let turn = following.matrix().transpose() * so3::right_jacobian(&vector) * width;
        for ((node, tau), by_rate) in nodes.iter().zip(times).zip(magnus_slopes(rates)) {
            node.add_slopes(path.basis(), tau, &(turn * by_rate), &mut by_coefficient);
        }
        rotation = so3::exp(&vector) * rotation;
    }
    RotationSlopes { rotation, by_coefficient }
}

/// Derivatives of [`magnus`] by the rates at its three nodes.
fn magnus_slopes([w1, w2, w3]: [Vector3<f64>; 3]) -> [Matrix3<f64>; 3] {
    // In the order and with the letters of `magnus`.
    let a1 = w2;
    let a2 = (w3 - w1) * (SQRT_15 / 3.0);
    let a3 = (w3 - w2 * 2.0 + w1) * (10.0 / 3.0);
    let c1 = a2.cross(&a1);
    let inner = a3 * 2.0 + c1;
    let c2 = a1.cross(&inner) / 60.0;
    let left = (c1 - a1 * 20.0 - a3).cross_matrix();
    let right = (a2 + c2).cross_matrix();
    let [x1, x2, inner] = [a1, a2, inner].map(|v| v.cross_matrix());

    let one = Matrix3::identity();
    // Derivatives of c1 and c2, then of the commutator, by a1, a2 and a3.
    let (c1_1, c1_2) = (x2, -x1);
    let (c2_1, c2_2, c2_3) = ((x1 * c1_1 - inner) / 60.0, x1 * c1_2 / 60.0, x1 / 30.0);
    let by_1 = left * c2_1 - right * (c1_1 - one * 20.0);
    let by_2 = left * (one + c2_2) - right * c1_2;
    let by_3 = left * c2_3 + right;
    let d1 = one - by_1 / 240.0;
    let d2 = -by_2 / 240.0;
    let d3 = one / 12.0 - by_3 / 240.0;

    let odd = d2 * (SQRT_15 / 3.0);
    let even = d3 * (10.0 / 3.0);
    [even - odd, d1 - even * 2.0, even + odd]
}
