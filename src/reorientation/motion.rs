//! A motion sampled in time, for charts and exports.

use nalgebra::UnitQuaternion;

use super::fitness::Reorientation;
use crate::attitude::increments;
use crate::trajectory::{Curve as _, Family};

/// Everything that moves, at equally spaced times from start to end.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Time since the start \[s\].
    pub time: Vec<f64>,
    /// The joints, from the base outward.
    pub joints: Vec<JointMotion>,
    /// The base's attitude, base axes into inertial axes.
    pub base: Vec<UnitQuaternion<f64>>,
}

/// One joint over time.
#[derive(Debug, Clone)]
pub struct JointMotion {
    /// The joint's name.
    pub name: String,
    /// Angle \[rad\], rate \[rad/s\], acceleration \[rad/s²\] and jerk \[rad/s³\] at each time.
    pub derivatives: Vec<[f64; 4]>,
}

impl Motion {
    /// Samples the path with these coefficients at `intervals + 1` times over `duration` seconds.
    pub fn sample<F: Family>(
        problem: &Reorientation<F>,
        coefficients: &[f64],
        duration: f64,
        intervals: usize,
    ) -> Self {
        let task = problem.task();
        let family = problem.family();
        let curve = |joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]);
        let curves: Vec<_> = (0..family.joints()).map(curve).collect();
        let taus: Vec<f64> = (0..=intervals).map(|i| i as f64 / intervals as f64).collect();
        let joints = task.robot.joints().zip(&curves).map(|(joint, path)| {
            let derivatives = taus.iter().map(|&tau| {
                let values = path.derivatives::<4>(tau);
                std::array::from_fn(|k| values[k] / duration.powi(k as i32))
            });
            JointMotion { name: joint.name.to_owned(), derivatives: derivatives.collect() }
        });
        let steps = increments(&task.robot, intervals, |tau, angles, rates| {
            for ((angle, rate), curve) in angles.iter_mut().zip(rates).zip(&curves) {
                [*angle, *rate] = curve.derivatives(tau);
            }
        });
        let mut base = vec![task.start.base];
        base.extend(steps.scan(task.start.base, |attitude, step| {
            *attitude *= step;
            Some(*attitude)
        }));
        Self {
            joints: joints.collect(),
            time: taus.iter().map(|tau| tau * duration).collect(),
            base,
        }
    }

    /// The base's ZYX Euler angles, `[yaw, pitch, roll]` \[rad\] at each time.
    pub fn base_zyx(&self) -> Vec<[f64; 3]> {
        let angles = self.base.iter().map(UnitQuaternion::euler_angles);
        angles.map(|(roll, pitch, yaw)| [yaw, pitch, roll]).collect()
    }
}
