//! A motion sampled in time, for charts and exports.

use std::array::from_fn;
use std::f64::consts::{PI, TAU};

use nalgebra::{UnitQuaternion, Vector3};

use super::fitness::Reorientation;
use super::sampling::Sampling;
use crate::attitude::increments;
use crate::robot::JointKind;
use crate::trajectory::{Curve as _, Family};

/// Intervals are cut into ever more steps until the base's attitudes change by no more than this angle \[rad\], or there are so
/// many steps.
const SAME_ATTITUDE: f64 = 1e-8;
const MOST_STEPS: usize = 1 << 17;

/// Everything that moves, at times from start to end.
#[derive(Debug, Clone, Default)]
pub struct Motion {
    /// Time since the start \[s\].
    pub time: Vec<f64>,
    /// The joints, from the base outward.
    pub joints: Vec<JointMotion>,
    /// The base's attitude, base axes into inertial axes.
    pub base: Vec<UnitQuaternion<f64>>,
    /// Total angular momentum, inertial axes \[N·m·s\].
    pub angular_momentum: Vector3<f64>,
}

/// One joint over time.
#[derive(Debug, Clone)]
pub struct JointMotion {
    /// The joint's name.
    pub name: String,
    /// Whether it turns or slides.
    pub kind: JointKind,
    /// Position \[rad or m\] and its first three derivatives by time \[s\] at each time.
    pub derivatives: Vec<[f64; 4]>,
}

impl Motion {
    /// Samples the path with these coefficients over `duration` seconds.
    pub fn sample<F: Family>(
        problem: &Reorientation<F>,
        coefficients: &[f64],
        duration: f64,
        sampling: impl Into<Sampling>,
    ) -> Self {
        let sampling = sampling.into();
        let (intervals, share) = sampling.grid(duration);
        let task = problem.task();
        let family = problem.family();
        let curve = |joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]);
        let curves: Vec<_> = (0..family.joints()).map(curve).collect();
        let time = sampling.times(duration);
        // Equal intervals are places of the path, whatever its duration.
        let tau = |(i, time): (usize, &f64)| match sampling {
            Sampling::Intervals(_) => i as f64 / intervals as f64,
            Sampling::Rate(_) => time / duration,
        };
        let taus: Vec<f64> = time.iter().enumerate().map(tau).collect();
        let joints = task.robot.joints().zip(&curves).map(|(joint, path)| {
            let derivatives = taus.iter().map(|&tau| {
                let values = path.derivatives::<4>(tau);
                from_fn(|k| values[k] / duration.powi(k as i32))
            });
            let (name, kind) = (joint.name.to_owned(), joint.kind);
            JointMotion { name, kind, derivatives: derivatives.collect() }
        });
        let write = &|tau, angles: &mut [f64], rates: &mut [f64]| {
            for ((angle, rate), curve) in angles.iter_mut().zip(rates).zip(&curves) {
                [*angle, *rate] = curve.derivatives(tau);
            }
        };
        let turns = |start: UnitQuaternion<f64>, [from, to]: [f64; 2], steps| {
            let drift = task.drift(start, duration * (to - from));
            let part = move |place, angles: &mut [f64], rates: &mut [f64]| {
                write(from + place * (to - from), angles, rates);
                for rate in rates {
                    *rate *= to - from;
                }
            };
            increments(&task.robot, steps, drift, part)
        };
        let base_in = |steps: usize| -> Vec<UnitQuaternion<f64>> {
            let mut attitude = task.start.base;
            let mut all = vec![attitude];
            let mut follow = |span: [f64; 2], intervals: usize| {
                for (i, step) in (1..).zip(turns(attitude, span, intervals * steps)) {
                    attitude *= step;
                    all.extend((i % steps == 0).then_some(attitude));
                }
            };
            follow([0.0, share], intervals);
            if share < 1.0 {
                follow([share, 1.0], 1);
            }
            all
        };
        let (mut base, mut steps) = (base_in(1), 1);
        let joints: Vec<JointMotion> = joints.collect();
        let mut rates =
            joints.iter().flat_map(|joint| &joint.derivatives).map(|at| (at[1] * duration).abs());
        // Steps that are more than a radian wide follow nothing.
        let most = if rates.all(|rate| rate <= MOST_STEPS as f64) { MOST_STEPS } else { 0 };
        while intervals * steps < most {
            steps *= 2;
            let finer = base_in(steps);
            let is_same = base.iter().zip(&finer).all(|(a, b)| a.angle_to(b) <= SAME_ATTITUDE);
            base = finer;
            if is_same {
                break;
            }
        }
        Self { time, joints, base, angular_momentum: task.angular_momentum.unwrap_or_default() }
    }

    /// Goes on with another motion, which starts where and when this one ends.
    pub(super) fn go_on(&mut self, next: Self) {
        let end = self.time.last().copied().unwrap_or_default();
        self.time.extend(next.time.iter().skip(1).map(|time| end + time));
        self.base.extend(&next.base[1..]);
        for (joint, next) in self.joints.iter_mut().zip(next.joints) {
            joint.derivatives.extend(&next.derivatives[1..]);
        }
    }

    /// The base's ZYX Euler angles, `[yaw, pitch, roll]` \[rad\] at each time. Of all triples that an attitude has, that nearest to
    /// the one before, so that angles go on where a full or a half turn is passed.
    pub fn base_zyx(&self) -> Vec<[f64; 3]> {
        let mut before = self.base.first().map_or([0.0; 3], zyx);
        let next = |attitude| {
            before = zyx_near(attitude, before);
            before
        };
        self.base.iter().map(next).collect()
    }
}

/// `[yaw, pitch, roll]` \[rad\], the pitch within a quarter turn.
pub(super) fn zyx(attitude: &UnitQuaternion<f64>) -> [f64; 3] {
    let (roll, pitch, yaw) = attitude.euler_angles();
    [yaw, pitch, roll]
}

/// Of all triples `[yaw, pitch, roll]` \[rad\] of an attitude the nearest to another one.
pub(super) fn zyx_near(attitude: &UnitQuaternion<f64>, other: [f64; 3]) -> [f64; 3] {
    let [yaw, pitch, roll] = zyx(attitude);
    let near = |angles: [f64; 3]| -> [f64; 3] {
        from_fn(|k| angles[k] - TAU * ((angles[k] - other[k]) / TAU).round())
    };
    let distance = |angles: &[f64; 3]| -> f64 {
        angles.iter().zip(other).map(|(angle, other)| (angle - other).powi(2)).sum()
    };
    let [same, flipped] = [near([yaw, pitch, roll]), near([yaw + PI, PI - pitch, roll + PI])];
    if distance(&flipped) < distance(&same) { flipped } else { same }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Attitudes by the product of three rotations: angles that grow evenly are found again, beyond full and half turns, and beyond a
    /// quarter turn of the pitch.
    #[test]
    fn euler_angles_go_on() {
        for slopes in [[1.0, 0.1, -0.2], [0.05, 1.0, 0.02], [-0.3, 0.2, 1.0]] {
            let expected: Vec<[f64; 3]> =
                (0..400).map(|i| from_fn(|k| 0.3 + 0.02 * f64::from(i) * slopes[k])).collect();
            let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
            let base = expected.iter().map(|[yaw, pitch, roll]| {
                about(Vector3::z_axis(), *yaw)
                    * about(Vector3::y_axis(), *pitch)
                    * about(Vector3::x_axis(), *roll)
            });
            let motion = Motion { base: base.collect(), ..Motion::default() };
            for (found, expected) in motion.base_zyx().iter().zip(&expected) {
                let miss = (0..3).map(|k| (found[k] - expected[k]).abs()).fold(0.0, f64::max);
                assert!(miss < 1e-9, "{found:?} {expected:?}");
            }
        }
    }
}
