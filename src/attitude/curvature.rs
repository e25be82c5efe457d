//! The second derivative of the base's rotation by the path's coefficients.

use nalgebra::{DMatrix, Matrix3, Matrix3xX, UnitQuaternion, Vector3};

use super::node::Node;
use crate::robot::Robot;
use crate::so3;
use crate::trajectory::{Basis, Path};

/// How the end of a path turns with its coefficients, to second order.
#[derive(Debug, Clone)]
pub struct RotationCurvature {
    /// First derivative of the rotation vector from the path's own end \[rad\], one column a
    /// coefficient.
    pub by_coefficient: Matrix3xX<f64>,
    /// Second derivative of that vector's product with a given one.
    pub curvature: DMatrix<f64>,
}

/// Step of the differences that stand for the second derivatives of the base's rate.
const STEP: f64 = 1e-5;

/// First and second derivative, by the midpoint rule: of second order, so for a few digits.
///
/// The base's rate `ω` bends with the coefficients, and what a node adds to the end, `e`, is turned by
/// the nodes that follow it, hence with the given vector `p`
///
/// ```text
///     Σ_n  Q_n p · ∂²ω/∂c_k ∂c_l  +  p · (e_nk × Σ_{m>n} e_ml)      symmetric in k and l
/// ```
pub fn net_rotation_curvature(
    robot: &Robot,
    path: &Path<'_, f64>,
    steps: usize,
    p: &Vector3<f64>,
) -> RotationCurvature {
    let width = 1.0 / steps as f64;
    let dimension = path.dimension();
    let mut by_coefficient = Matrix3xX::zeros(dimension);
    let mut own = by_coefficient.clone();
    let mut curvature = DMatrix::zeros(dimension, dimension);
    let mut following = UnitQuaternion::identity();
    let (mut node, mut beside) = (Node::new(robot), Node::new(robot));
    for step in (0..steps).rev() {
        let tau = (step as f64 + 0.5) * width;
        node.evaluate(robot, path, tau);
        let half = so3::exp(&(node.rate() * (width / 2.0)));
        following = half * following;
        let turn: Matrix3<f64> = following.inverse().to_rotation_matrix().into_inner() * width;
        own.fill(0.0);
        node.add_slopes(path.basis(), tau, &turn, &mut own);
        curvature.gemm_tr(1.0, &(p.cross_matrix() * &own), &by_coefficient, 1.0);
        by_coefficient += &own;
        let bent = bend(&node, &mut beside, robot, path, &turn.tr_mul(p));
        add_bend(&bent, path.basis(), tau, &mut curvature);
        following = half * following;
    }
    curvature = (&curvature + curvature.transpose()) / 2.0;
    RotationCurvature { by_coefficient, curvature }
}

/// Second derivatives of `p · ω` by the joints' `s`, and by `s'` (row) and `s` (column); those by
/// `s'` alone vanish.
struct Bend {
    phases: DMatrix<f64>,
    mixed: DMatrix<f64>,
}

fn bend(
    node: &Node,
    beside: &mut Node,
    robot: &Robot,
    path: &Path<'_, f64>,
    p: &Vector3<f64>,
) -> Bend {
    let joints = robot.joint_count();
    let mut bend =
        Bend { phases: DMatrix::zeros(joints, joints), mixed: DMatrix::zeros(joints, joints) };
    beside.phases.copy_from_slice(&node.phases);
    for j in 0..joints {
        beside.phases[j][0] += STEP;
        beside.evaluate_at_phases(robot, path);
        beside.phases[j] = node.phases[j];
        for i in 0..joints {
            bend.phases[(i, j)] = p.dot(&(beside.by_phase[i] - node.by_phase[i])) / STEP;
            bend.mixed[(i, j)] = p.dot(&(beside.by_phase_rate[i] - node.by_phase_rate[i])) / STEP;
        }
    }
    bend
}

/// Adds what the bend means for the coefficients, once symmetrised; of the mixed derivatives both
/// halves stand on one side.
fn add_bend(bend: &Bend, basis: &Basis, tau: f64, sum: &mut DMatrix<f64>) {
    let terms = basis.terms();
    let bumps: Vec<[f64; 2]> = basis.bumps(tau).collect();
    for (i, j) in
        (0..bend.phases.nrows()).flat_map(|i| (0..bend.phases.ncols()).map(move |j| (i, j)))
    {
        for (k, [value, slope]) in bumps.iter().enumerate() {
            let row = value * bend.phases[(i, j)] + 2.0 * slope * bend.mixed[(i, j)];
            for (l, [other, _]) in bumps.iter().enumerate() {
                sum[(i * terms + k, j * terms + l)] += row * other;
            }
        }
    }
}
