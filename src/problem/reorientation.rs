//! The fitness of the paper (eqs. 18, 20, 25–28, 33): turn the base, soon, within limits.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use crate::attitude::net_rotation;
use crate::task::Task;
use crate::trajectory::{Family, Path, Peaks};

/// The base error that counts as one: `k_q = sin(½ · 1°)` (eq. 33; its "δ" is π).
const K_Q_DEG: f64 = 1.0;

/// `k_v = k_a = k_j`, the relative excess over a limit that counts as one (eq. 33).
const K_EXCESS: f64 = 0.01;

/// How finely a motion is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Accuracy {
    /// Magnus steps along the path, each with three evaluations of the base's rate.
    pub attitude_steps: usize,
    /// Intervals in which peaks of rate, acceleration and jerk are bracketed.
    pub peak_intervals: usize,
}

impl Accuracy {
    /// For what is recorded and shown: on the motions of interest exact to rounding.
    pub const FINE: Self = Self { attitude_steps: 400, peak_intervals: 1024 };
}

/// The reorientation task over one trajectory family.
#[derive(Debug, Clone)]
pub struct Reorientation {
    task: Arc<Task>,
    family: Family,
    accuracy: Accuracy,
}

/// What is known of one motion.
#[derive(Debug, Clone)]
pub struct Assessment {
    /// The cost `J` (eq. 25).
    pub cost: f64,
    /// `‖δq_b‖`, the sine of half the base's error angle.
    pub attitude_error: f64,
    /// Duration \[s\].
    pub duration: f64,
    /// `F` of eqs. 26–28 for rate, acceleration and jerk.
    pub excess: [f64; 3],
    /// Largest rate, acceleration and jerk of each joint \[rad/s, rad/s², rad/s³\].
    pub peaks: Peaks,
}

impl Reorientation {
    /// The task over the family with `terms` free coefficients a joint.
    ///
    /// # Panics
    ///
    /// Panics without a term, a step or an interval, or when the task does not fit its robot.
    pub fn new(task: Arc<Task>, terms: usize, accuracy: Accuracy) -> Self {
        assert!(accuracy.attitude_steps > 0 && accuracy.peak_intervals > 0, "no accuracy at all");
        assert_eq!(task.limits.0.len(), task.robot.joint_count(), "limits for every joint");
        let ranges: Vec<_> = task.robot.joints.iter().map(|j| j.range).collect();
        let family = Family::new(&ranges, &task.start.joints, &task.goal.joints, terms);
        Self { task, family, accuracy }
    }

    /// The same problem, evaluated more or less finely.
    #[must_use]
    pub fn with_accuracy(&self, accuracy: Accuracy) -> Self {
        Self { accuracy, ..self.clone() }
    }

    /// How finely motions are evaluated.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// The task.
    pub fn task(&self) -> &Arc<Task> {
        &self.task
    }

    /// The trajectory family.
    pub fn family(&self) -> &Family {
        &self.family
    }

    /// The motion along the path with these coefficients, in `duration` seconds or, without one, in
    /// the shortest time within the limits.
    pub fn assess(&self, coefficients: &[f64], duration: Option<f64>) -> Assessment {
        let path = self.family.path(coefficients);
        let peaks = Peaks::of(&path, self.accuracy.peak_intervals);
        let (duration, excess) = match duration {
            Some(duration) => (duration, peaks.over(duration).excess(&self.task.limits)),
            None => (peaks.shortest_duration(&self.task.limits), [0.0; 3]),
        };
        let attitude_error = self.base_error(&path).norm();
        Assessment {
            cost: cost(self.task.base_weight, attitude_error, duration, &excess),
            attitude_error,
            duration,
            excess,
            peaks: peaks.over(duration),
        }
    }

    /// `δq_b` of eq. 20 at the end of a path.
    fn base_error(&self, path: &Path<'_, f64>) -> Vector3<f64> {
        let net = net_rotation(&self.task.robot, path, self.accuracy.attitude_steps);
        self.error_after(net).imag()
    }

    /// The rotation from the goal to where the base ends after it has turned so.
    pub(super) fn error_after(&self, net: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
        self.task.goal.base.inverse() * self.task.start.base * net
    }

    /// What `‖δq_b‖` and `t_f` weigh in `J` where no limit is exceeded.
    pub(super) fn weights(&self) -> (f64, f64) {
        weights(self.task.base_weight)
    }
}

fn weights(base_weight: f64) -> (f64, f64) {
    let k_q = (K_Q_DEG.to_radians() / 2.0).sin();
    (base_weight / k_q, 1.0 - base_weight)
}

/// `‖δq_b‖` of eq. 20, the vector part of the rotation from the goal to `end`.
pub(super) fn attitude_error(goal: &UnitQuaternion<f64>, end: &UnitQuaternion<f64>) -> f64 {
    (goal.inverse() * end).imag().norm()
}

/// `J` of eq. 25.
pub(super) fn cost(base_weight: f64, error: f64, duration: f64, excess: &[f64; 3]) -> f64 {
    let (error_weight, time_weight) = weights(base_weight);
    error_weight * error + time_weight * duration + penalty(excess)
}

fn penalty(excess: &[f64; 3]) -> f64 {
    excess.iter().sum::<f64>() / K_EXCESS
}

impl Assessment {
    /// The base's error angle \[rad\].
    pub fn residual(&self) -> f64 {
        2.0 * self.attitude_error.min(1.0).asin()
    }

    /// The last three terms of `J`.
    pub fn penalty(&self) -> f64 {
        penalty(&self.excess)
    }
}
