//! The base's rotation along a path with its derivatives by the path's coefficients.

use nalgebra::{Matrix3, Matrix3xX, UnitQuaternion, Vector3};

use super::{OFFSET, SQRT_15, magnus};
use crate::momentum::RateSlopes;
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
    let mut by_coefficient = Matrix3xX::zeros(robot.joint_count() * path.basis().terms());
    let mut nodes = std::array::from_fn(|_| Node::new(robot));
    for step in (0..steps).rev() {
        for (node, place) in nodes.iter_mut().zip([0.5 - OFFSET, 0.5, 0.5 + OFFSET]) {
            node.evaluate(robot, path, (step as f64 + place) * width);
        }
        let rates = nodes.each_ref().map(|node| node.slopes.angular * width);
        let vector = magnus(rates);
        let following = rotation.to_rotation_matrix();
        let turn = following.matrix().transpose() * so3::right_jacobian(&vector) * width;
        for (node, by_rate) in nodes.iter().zip(magnus_slopes(rates)) {
            node.add_slopes(path, &(turn * by_rate), &mut by_coefficient);
        }
        rotation = so3::exp(&vector) * rotation;
    }
    RotationSlopes { rotation, by_coefficient }
}

/// What is known at one node of a step.
struct Node {
    tau: f64,
    angles: Vec<f64>,
    rates: Vec<f64>,
    slopes: RateSlopes<f64>,
}

impl Node {
    fn new(robot: &Robot) -> Self {
        let zeros = vec![0.0; robot.joint_count()];
        let slopes = RateSlopes::new(robot);
        Self { tau: 0.0, angles: zeros.clone(), rates: zeros, slopes }
    }

    fn evaluate(&mut self, robot: &Robot, path: &Path<'_, f64>, tau: f64) {
        self.tau = tau;
        path.angles_and_rates(tau, &mut self.angles, &mut self.rates);
        self.slopes.evaluate(robot, &self.angles, &self.rates);
    }

    /// Adds `by_rate · ∂ω/∂c` for every coefficient `c`.
    fn add_slopes(&self, path: &Path<'_, f64>, by_rate: &Matrix3<f64>, sum: &mut Matrix3xX<f64>) {
        let terms = path.basis().terms();
        for (j, joint) in path.joints().enumerate() {
            let phase = joint.phase_slopes(self.tau);
            let angle = by_rate * self.slopes.by_angle[j];
            let rate = by_rate * self.slopes.by_rate[j];
            let value = angle * phase.angle + rate * phase.rate;
            let slope = rate * phase.angle;
            for (k, [bump, bump_slope]) in path.basis().bumps(self.tau).enumerate() {
                let mut column = sum.column_mut(j * terms + k);
                column += value * bump + slope * bump_slope;
            }
        }
    }
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
    // Derivatives of c1 and c2 by a1 and a2, and of the commutator by all three.
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
