//! What is known of a motion through points, as JSON.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use super::assess::{PointReading, ReadPath, Replayed};
use super::faults::{Fault, Shown};
use crate::reorientation::json::WayJson;
use crate::reorientation::motion::zyx;

/// All of a motion through points. Times since the first point.
#[derive(Debug, Serialize)]
pub struct ReplayedJson<'a> {
    points: usize,
    /// When the first is, as given.
    starts_at: f64,
    t_f: f64,
    interpolation: PointReading,
    /// `w, x, y, z`, base axes into inertial axes.
    base_quaternion: [f64; 4],
    base_zyx_deg: [f64; 3],
    residual_deg: f64,
    /// Null where the motion is too wild for an estimate.
    residual_error_deg: f64,
    tolerance_deg: f64,
    /// Whether there are no faults, as far as is sure.
    reached: bool,
    within_limits: bool,
    largest_base_turn_deg: f64,
    largest_base_turn_at: f64,
    largest_base_rate_deg_s: f64,
    largest_base_rate_at: f64,
    largest_momentum: f64,
    largest_angular_momentum: f64,
    #[serde(flatten)]
    way: WayJson,
    joints: Vec<JointPeaks<'a>>,
    readings: Vec<ReadJson>,
    faults: &'a [Fault],
    ignored_columns: &'a [String],
}

/// A joint's motion between points; in degrees or, where it slides, in metres.
#[derive(Debug, Serialize)]
#[non_exhaustive]
pub struct JointPeaks<'a> {
    /// The joint.
    pub name: &'a str,
    /// `deg` or `m`.
    pub unit: &'static str,
    /// Its least position.
    pub least_position: f64,
    /// Its largest position.
    pub largest_position: f64,
    /// Its largest rate.
    pub rate: PeakJson,
    /// Its largest acceleration.
    pub acceleration: PeakJson,
    /// Its largest jerk.
    pub jerk: PeakJson,
}

/// The largest value of something.
#[derive(Debug, Clone, Copy, Serialize)]
#[non_exhaustive]
pub struct PeakJson {
    /// The value, in the joint's unit and seconds.
    pub peak: f64,
    /// When, since the first point \[s\].
    pub at: f64,
    /// Its share of the limit.
    pub share: f64,
}

/// One way to read what lies between points.
#[derive(Debug, Serialize)]
struct ReadJson {
    interpolation: PointReading,
    /// Whether controllers play it so.
    played: bool,
    residual_deg: f64,
    residual_error_deg: f64,
    base_quaternion: [f64; 4],
    /// The largest rate, acceleration and jerk between points as shares of their limits.
    rate_share: f64,
    acceleration_share: f64,
    jerk_share: f64,
}

impl<'a> ReplayedJson<'a> {
    /// Of a motion, and of a table's columns that were not read.
    pub fn new(replayed: &'a Replayed<'_>, ignored_columns: &'a [String]) -> Self {
        let (task, points, played) = (replayed.task(), replayed.points(), &replayed.played);
        let (t_f, turn, rate) = (points.duration(), replayed.base_turn, replayed.base_rate);
        let [momentum, angular_momentum] = replayed.momentum;
        let reading = |read: &ReadPath, played| ReadJson {
            interpolation: read.reading,
            played,
            residual_deg: read.residual.to_degrees(),
            residual_error_deg: read.residual_error.to_degrees(),
            base_quaternion: quaternion(&read.end),
            rate_share: read.largest_share(task, 0),
            acceleration_share: read.largest_share(task, 1),
            jerk_share: read.largest_share(task, 2),
        };
        let others = replayed.others.iter().map(|other| reading(other, false));
        Self {
            points: points.count(),
            starts_at: points.start(),
            t_f,
            interpolation: played.reading,
            base_quaternion: quaternion(&played.end),
            base_zyx_deg: zyx(&played.end).map(f64::to_degrees),
            residual_deg: played.residual.to_degrees(),
            residual_error_deg: played.residual_error.to_degrees(),
            tolerance_deg: task.goal_tolerance_deg(),
            reached: replayed.is_as_asked(),
            within_limits: replayed.keeps_limits(),
            largest_base_turn_deg: turn.value.to_degrees(),
            largest_base_turn_at: turn.tau * t_f,
            largest_base_rate_deg_s: rate.value.to_degrees(),
            largest_base_rate_at: rate.tau * t_f,
            largest_momentum: momentum,
            largest_angular_momentum: angular_momentum,
            way: WayJson::new(&replayed.excursions, task, &played.peaks),
            joints: replayed.joints(),
            readings: std::iter::once(reading(played, true)).chain(others).collect(),
            faults: &replayed.faults,
            ignored_columns,
        }
    }
}

impl Replayed<'_> {
    /// Each joint's motion between points.
    pub fn joints(&self) -> Vec<JointPeaks<'_>> {
        let (task, duration) = (self.task(), self.points().duration());
        let joints = Shown::all(task).into_iter().enumerate().map(|(joint, shown)| {
            let (peaks, limits) = (&self.played.peaks.0[joint], &task.limits.0[joint]);
            let [least_position, largest_position] =
                self.extents[joint].position.map(|position| shown.value(position));
            let [rate, acceleration, jerk] = [0, 1, 2].map(|order| PeakJson {
                peak: shown.value(peaks[order].value),
                at: peaks[order].tau * duration,
                share: peaks[order].value / limits[order],
            });
            JointPeaks {
                name: shown.name,
                unit: shown.kind.file_unit(),
                least_position,
                largest_position,
                rate,
                acceleration,
                jerk,
            }
        });
        joints.collect()
    }
}

fn quaternion(attitude: &UnitQuaternion<f64>) -> [f64; 4] {
    let [x, y, z, w]: [f64; 4] = attitude.coords.into();
    [w, x, y, z]
}
