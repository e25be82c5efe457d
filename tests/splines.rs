//! Splines in the kernels: the base's rotation along them, beside a plain integration.

use std::sync::Arc;

use driftless::momentum::base_twist;
use driftless::reorientation::{Accuracy, Reorientation, TaskFile};
use driftless::task::Task;
use driftless::trajectory::{Curve as _, Family as _, Spline};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

fn paper() -> Arc<Task> {
    let document = TaskFile::paper();
    let (task, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    task.task().clone()
}

/// The base's rotation by the classical Runge–Kutta method on `Q̇ = ½ Q ⊗ (0, ω_b)` (eq. 9), so many steps per piece.
fn integrated(
    task: &Task,
    family: &Spline,
    coefficients: &[f64],
    steps: usize,
) -> UnitQuaternion<f64> {
    let curves: Vec<_> = (0..family.joints())
        .map(|joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]))
        .collect();
    let rate = |tau: f64| -> Vector3<f64> {
        let at: Vec<[f64; 2]> = curves.iter().map(|curve| curve.derivatives(tau)).collect();
        let [angles, rates] = [0, 1].map(|n| at.iter().map(|at| at[n]).collect::<Vec<f64>>());
        base_twist(&task.robot, &angles, &rates).angular.into()
    };
    let count = steps * family.knots().pieces();
    let h = 1.0 / count as f64;
    let mut q = Quaternion::identity();
    for i in 0..count {
        let start = i as f64 * h;
        let slope = |q: Quaternion<f64>, w: Vector3<f64>| q * Quaternion::from_imag(w) * 0.5;
        let [w1, w2, w3] = [rate(start), rate(start + 0.5 * h), rate(start + h)];
        let k1 = slope(q, w1);
        let k2 = slope(q + k1 * (0.5 * h), w2);
        let k3 = slope(q + k2 * (0.5 * h), w2);
        let k4 = slope(q + k3 * h, w3);
        q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    UnitQuaternion::from_quaternion(q)
}

/// A panel is one piece or part of one, within which paths are smooth: few steps are enough for all degrees.
#[test]
fn rotations_are_those_of_a_plain_integration() {
    let task = paper();
    for (degree, pieces) in [(3, 10), (4, 12), (5, 4)] {
        let family = Spline::new(&task.start.joints, &task.goal.joints, pieces, degree);
        let own = |i: usize| 0.3 * f64::sin(2.9 * i as f64);
        let coefficients: Vec<f64> = (0..family.dimension()).map(own).collect();
        let expected = integrated(&task, &family, &coefficients, 2000 / pieces);
        let accuracy = Accuracy { attitude_steps: 3 * pieces.max(8), peak_intervals: 1 };
        let problem = Reorientation::over(task.clone(), family, accuracy);
        let miss = problem.net_rotation(&coefficients).angle_to(&expected);
        assert!(miss < 1e-7, "degree {degree}, {pieces} pieces: {miss} rad");
        let fine = problem.with_accuracy(Accuracy::FINE).net_rotation(&coefficients);
        assert!(fine.angle_to(&expected) < 1e-10, "degree {degree}: {}", fine.angle_to(&expected));
    }
}
