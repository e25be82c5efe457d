//! What a motion through points comes to.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use super::base::{BasePath, Seen};
use super::faults::{Fault, faults, of_tool, on_the_way};
use crate::reorientation::excursions::Excursions;
use crate::reorientation::motion::{JointMotion, Motion};
use crate::reorientation::sampling::Sampling;
use crate::task::Task;
use crate::trajectory::{Extent, Interpolation, Peak, Peaks, PointPath, Points};

/// A way to read what lies between points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointReading {
    /// Straight lines.
    Linear,
    /// Cubics with the points' rates.
    Cubic,
    /// Quintics with the points' rates and accelerations.
    Quintic,
    /// The cubic spline with a continuous acceleration, through positions alone, at rest at both ends.
    Spline,
}

/// A motion through points, read in one way.
#[derive(Debug, Clone)]
pub struct ReadPath {
    /// The way.
    pub reading: PointReading,
    /// Where the base ends, base axes into inertial axes.
    pub end: UnitQuaternion<f64>,
    /// How far that is from the goal \[rad\].
    pub residual: f64,
    /// By how much that may be wrong \[rad\]; infinite where it is not known.
    pub residual_error: f64,
    /// Largest rate, acceleration and jerk of each joint between points \[rad or m, s\].
    pub peaks: Peaks,
}

/// A motion through points, as a controller plays it.
#[derive(Debug, Clone)]
pub struct Replayed<'a> {
    pub(super) task: &'a Task,
    points: &'a Points,
    base: BasePath,
    /// As `ros2_control`'s `joint_trajectory_controller` plays it.
    pub played: ReadPath,
    /// Read in other ways.
    pub others: Vec<ReadPath>,
    /// The largest turn of the base from its attitude at the start \[rad\].
    pub base_turn: Peak,
    /// Its largest angular speed \[rad/s\].
    pub base_rate: Peak,
    /// The largest linear \[N·s\] and angular momentum \[N·m·s\] of base and arm together, beside the task's own: a check, which
    /// should be zero but for rounding.
    pub momentum: [f64; 2],
    /// How far each joint goes.
    pub extents: Vec<Extent>,
    /// What of the motion is not as it should be.
    pub faults: Vec<Fault>,
    /// What else happens on the way.
    pub excursions: Excursions,
}

/// Intervals in which a motion is looked at on its way.
const LOOKS: usize = 2000;

impl PointReading {
    /// All that points can be read as.
    const ALL: [Self; 4] = [Self::Linear, Self::Cubic, Self::Quintic, Self::Spline];

    fn path(self, points: &Points) -> Option<PointPath<'_>> {
        match self {
            Self::Linear => points.path(Interpolation::Linear),
            Self::Cubic => points.path(Interpolation::Cubic),
            Self::Quintic => points.path(Interpolation::Quintic),
            Self::Spline => Some(points.smooth()),
        }
    }

    /// What a controller makes of points.
    fn played(points: &Points) -> Self {
        match points.interpolation() {
            Interpolation::Linear => Self::Linear,
            Interpolation::Cubic => Self::Cubic,
            Interpolation::Quintic => Self::Quintic,
        }
    }
}

impl ReadPath {
    fn of(task: &Task, reading: PointReading, path: &PointPath<'_>, base: &BasePath) -> Self {
        let end = task.start.base * base.end();
        Self {
            reading,
            end,
            residual: task.goal.base.angle_to(&end),
            residual_error: base.error,
            peaks: path.peaks(),
        }
    }

    /// The largest rate, acceleration or jerk (order 0, 1, 2) of any joint as a share of its limit.
    pub fn largest_share(&self, task: &Task, order: usize) -> f64 {
        let joints = self.peaks.0.iter().zip(&task.limits.0);
        joints.map(|(peaks, limits)| peaks[order].value / limits[order]).fold(0.0, f64::max)
    }
}

impl<'a> Replayed<'a> {
    /// The motion through these points, whose joints are those of the task's robot.
    ///
    /// # Panics
    ///
    /// Panics when the robot has more or fewer joints than the points.
    pub fn new(task: &'a Task, points: &'a Points) -> Self {
        assert_eq!(points.joints(), task.robot.joint_count(), "points of another robot");
        let reading = PointReading::played(points);
        let others = PointReading::ALL.into_iter().filter(|other| *other != reading);
        let others = others.filter_map(|other| {
            let path = other.path(points)?;
            Some(ReadPath::of(task, other, &path, &BasePath::of(task, &path)))
        });
        let others = others.collect();
        let path = points.played();
        let base = BasePath::of(task, &path);
        let Seen { turn, rate, momentum } = base.look(task, &path);
        let played = ReadPath::of(task, reading, &path, &base);
        let extents = path.extents();
        let mut faults = faults(task, &path, played.residual, &played.peaks, &extents);
        let excursions = Excursions::of(
            task,
            &sample(task, points, &base, Sampling::Intervals(LOOKS).times(points.duration())),
        );
        faults.extend(on_the_way(&excursions.used));
        faults.extend(of_tool(task, excursions.tool.as_ref(), points.duration()));
        Self {
            task,
            points,
            base,
            played,
            others,
            base_turn: turn,
            base_rate: rate,
            momentum,
            extents,
            faults,
            excursions,
        }
    }

    /// The points.
    pub fn points(&self) -> &'a Points {
        self.points
    }

    /// The task.
    pub fn task(&self) -> &'a Task {
        self.task
    }

    /// Whether the base ends within the goal's tolerance, as far as is sure.
    fn is_at_goal(&self) -> bool {
        let ReadPath { residual, residual_error, .. } = self.played;
        residual + residual_error <= self.task.goal_tolerance
    }

    /// Whether it is what the task asks for: from its start to its goal, within all limits and ranges, as far as is sure.
    pub fn is_as_asked(&self) -> bool {
        self.is_at_goal() && self.faults.is_empty()
    }

    /// Whether all limits and ranges are kept, from rest to rest.
    pub fn keeps_limits(&self) -> bool {
        !self.faults.iter().any(|fault| fault.kind.breaks_a_limit())
    }

    /// The motion, sampled.
    pub fn sample(&self, sampling: impl Into<Sampling>) -> Motion {
        sample(self.task, self.points, &self.base, sampling.into().times(self.points.duration()))
    }

    /// The motion at its own points, where these alone determine it: where they have rates and accelerations.
    pub fn at_points(&self) -> Option<Motion> {
        let is_determined = self.points.interpolation() == Interpolation::Quintic;
        let times = || self.points.times().to_vec();
        is_determined.then(|| sample(self.task, self.points, &self.base, times()))
    }
}

fn sample(task: &Task, points: &Points, base: &BasePath, time: Vec<f64>) -> Motion {
    let path = points.played();
    let joints = task.robot.joints().enumerate().map(|(joint, own)| {
        let at = |&time: &f64| {
            let (segment, share) = path.place(time);
            path.derivatives(segment, joint, share)
        };
        JointMotion {
            name: own.name.to_owned(),
            kind: own.kind,
            derivatives: time.iter().map(at).collect(),
        }
    });
    let joints = joints.collect();
    let base = base.at(task, &path, &time);
    let base = base.into_iter().map(|turn| task.start.base * turn).collect();
    Motion { time, joints, base, angular_momentum: task.angular_momentum.unwrap_or_default() }
}
