//! Against Pinocchio: `reference/xiao2023.json`, made by `reference/make_reference.py`.

use std::sync::Arc;

use driftless::kinematics::tool;
use driftless::momentum::{base_map, generalised_jacobian};
use driftless::reorientation::{Accuracy, Reorientation, TaskFile};
use driftless::task::Task;
use driftless::trajectory::Peaks;
use nalgebra::{DMatrix, Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    kinematics: Vec<Configuration>,
    attitude: Vec<Shape>,
    start_quaternion: [f64; 4],
}

#[derive(Deserialize)]
struct Configuration {
    theta: Vec<f64>,
    tool_position: [f64; 3],
    tool_rotation: Vec<Vec<f64>>,
    base_map: Vec<Vec<f64>>,
    generalised_jacobian: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
struct Shape {
    name: String,
    #[serde(rename = "A6")]
    a6: Vec<f64>,
    #[serde(rename = "A7")]
    a7: Vec<f64>,
    final_quaternion: [f64; 4],
    residual_deg: f64,
    peak_rate_times_tf: Vec<f64>,
    peak_acceleration_times_tf2: Vec<f64>,
    peak_jerk_times_tf3: Vec<f64>,
}

fn reference() -> Reference {
    serde_json::from_str(include_str!("reference/xiao2023.json")).unwrap()
}

fn paper() -> Reorientation {
    let document = TaskFile::paper();
    TaskFile::read(&document).unwrap().build(&document).unwrap().0
}

fn task() -> Arc<Task> {
    paper().task().clone()
}

fn quaternion([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

fn largest_difference(ours: &[f64], rows: &[Vec<f64>]) -> f64 {
    let theirs = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
    assert_eq!(ours.len(), theirs.len());
    ours.iter().zip(theirs.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn kinematics_and_momentum_to_1e_12() {
    let robot = &task().robot;
    for c in reference().kinematics {
        let pose = tool(robot, &c.theta);
        assert!((Vector3::from(pose.position) - Vector3::from(c.tool_position)).amax() < 1e-12);
        let rotation = Matrix3::from(pose.rotation);
        assert!(largest_difference(rotation.as_slice(), &c.tool_rotation) < 1e-12);
        let map = base_map(robot, &c.theta);
        assert!(largest_difference(map.as_slice(), &c.base_map) < 1e-12);
        let jacobian = generalised_jacobian(robot, &c.theta);
        assert!(largest_difference(jacobian.as_slice(), &c.generalised_jacobian) < 1e-12);
    }
}

#[test]
fn start_attitude() {
    let difference =
        task().start.base.into_inner() - quaternion(reference().start_quaternion).into_inner();
    assert!(difference.norm() < 1e-15);
}

/// The final attitude to 1e-10 when evaluated finely, to 1e-7 as evaluated during a search.
#[test]
fn final_attitude() {
    let problem = paper();
    let task = problem.task();
    for shape in reference().attitude {
        let alpha = [&shape.a6[..], &shape.a7].concat();
        let coefficients = problem.family().from_alpha(&alpha, 1.0);
        let expected = quaternion(shape.final_quaternion);
        for (accuracy, tolerance) in [(Accuracy::FINE, 1e-10), (problem.accuracy(), 1e-7)] {
            let steps = accuracy.attitude_steps;
            let end = task.start.base * problem.with_accuracy(accuracy).net_rotation(&coefficients);
            let difference = (end.into_inner() - expected.into_inner()).norm();
            println!("{} {steps}: {difference:.2e}", shape.name);
            assert!(difference < tolerance, "{} {steps}: {difference:e}", shape.name);
        }
        let fine = problem.with_accuracy(Accuracy::FINE).assess(&coefficients, Some(1.0));
        assert!((fine.residual().to_degrees() - shape.residual_deg).abs() < 1e-8);
    }
}

#[test]
fn peaks_to_1e_6_relative() {
    let problem = paper();
    let search = problem.accuracy().peak_intervals;
    for shape in reference().attitude {
        let alpha = [&shape.a6[..], &shape.a7].concat();
        let coefficients = problem.family().from_alpha(&alpha, 1.0);
        let expected = shape
            .peak_rate_times_tf
            .iter()
            .zip(&shape.peak_acceleration_times_tf2)
            .zip(&shape.peak_jerk_times_tf3)
            .map(|((&v, &a), &j)| [v, a, j]);
        for intervals in [search, Accuracy::FINE.peak_intervals] {
            let Peaks(peaks) = Peaks::of(problem.family(), &coefficients, intervals);
            for (ours, theirs) in peaks.iter().zip(expected.clone()) {
                for (a, b) in ours.iter().zip(theirs) {
                    assert!(
                        (a.value - b).abs() < 1e-6 * b,
                        "{} {intervals}: {a:?} {b}",
                        shape.name
                    );
                }
            }
        }
    }
}
