//! Replaying a given motion, also the way the paper's own numbers seem to have been made.

use std::sync::Arc;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::accuracy::Accuracy;
use super::any::AnyReorientation;
use super::family::FamilyName;
use super::fitness::{Assessment, Reorientation, attitude_error};
use super::settings::{DEFAULTS, TrajectoryTable, check_terms};
use crate::input::{Document, Finite, InputError, Positive};
use crate::momentum::base_twist;
use crate::robot::Robot;
use crate::task::{Posture, Task, TaskTable};
use crate::trajectory::{Path, Peak, Peaks};
use crate::words::plural;

/// How a published motion is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reading {
    /// The physics that the equations state.
    Physics,
    /// What reproduces the paper's `J*`: the base's rotation matrix transposed where eq. 9 takes the
    /// angular velocity into the inertial frame, start angles composed roll first, limits looked at
    /// every 10 ms only. That the authors did so is inferred from the numbers, not known.
    AsPublished,
}

impl Reading {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Physics, Self::AsPublished];

    /// The name and what it stands for.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Physics => "as physics",
            Self::AsPublished => {
                "as published (base rotation transposed, roll first, limits seen every 10 ms)"
            }
        }
    }
}

/// A file with one motion to replay.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct ReplayFile {
    task: TaskTable,
    trajectory: TrajectoryTable,
    motion: Spanned<MotionTable>,
}

/// The `[motion]` table: `alpha6` and `alpha7`, or `coefficients`.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct MotionTable {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alpha6: Option<Spanned<Vec<Finite>>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alpha7: Option<Spanned<Vec<Finite>>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coefficients: Option<Spanned<Vec<Vec<Finite>>>>,
    t_f: Spanned<Positive>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    j: Option<Finite>,
}

/// A motion to replay and what was claimed of it.
#[derive(Debug, Clone)]
pub struct Published {
    /// The task it is for, over a family of the motion's size.
    pub problem: Arc<dyn AnyReorientation>,
    /// Coefficients, joint by joint.
    pub coefficients: Vec<f64>,
    /// Duration \[s\].
    pub duration: f64,
    /// The cost claimed.
    pub cost: Option<f64>,
}

/// Step of the time grid on which the as-published reading looks at the limits \[s\].
const SAMPLE_STEP: f64 = 0.01;

/// Shortest and longest motion to replay \[s\].
const SHORTEST: f64 = 1e-3;
const LONGEST: f64 = 1e9;

/// Most samples of the as-published reading; a motion that would need more is looked at less often.
const MOST_SAMPLES: f64 = 1e6;

/// Runge–Kutta steps of the as-published reading.
const RUNGE_KUTTA_STEPS: usize = 2000;

impl ReplayFile {
    /// Reads a file; the task it leaves out is the paper's.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        let Self { task, trajectory, motion } = document.parse_over(&[DEFAULTS])?;
        let trajectory = trajectory.implied();
        trajectory.check_keys(document)?;
        let rows = motion.get_ref().coefficients.as_ref().map(Spanned::get_ref);
        let free = rows.and_then(|rows| rows.first()).map_or(0, Vec::len);
        Ok(Self { trajectory: trajectory.for_free(free), task, motion })
    }

    /// The motion published in the paper.
    pub fn paper() -> Document {
        Document::embedded("published.toml", include_str!("published.toml"))
    }

    /// The motion and its task.
    pub fn build(&self, document: &Document) -> Result<Published, InputError> {
        let task = Arc::new(self.task.build(document)?);
        let motion = self.motion.get_ref();
        let duration = motion.t_f.get_ref().0;
        if !(SHORTEST..=LONGEST).contains(&duration) {
            let message = format!("found {duration} s, expected {SHORTEST} to {LONGEST} s");
            return Err(document.error_at(motion.t_f.span(), message, None));
        }
        let shape = self.shape(&task.robot, document)?;
        let (problem, coefficients) = match self.trajectory.family() {
            FamilyName::SinePolynomial => {
                let terms = shape.free();
                check_terms(terms, self.motion.span(), document)?;
                let problem = Reorientation::new(task, terms, Accuracy::FINE);
                let coefficients = match shape {
                    Shape::Alpha(alpha) => problem.family().from_alpha(&alpha, duration),
                    Shape::Coefficients(rows) => rows.concat(),
                };
                (Arc::new(problem) as Arc<dyn AnyReorientation>, coefficients)
            }
            FamilyName::Spline => {
                let Shape::Coefficients(rows) = &shape else {
                    let message = "found `alpha6`, expected `coefficients` of a spline";
                    return Err(document.error_at(self.motion.span(), message, None));
                };
                let family = self.trajectory.spline(&task, document)?;
                let (found, expected) = (shape.free(), family.free());
                if found != expected {
                    let message = format!(
                        "found rows of {found} coefficients, expected {expected}: pieces + degree − 6"
                    );
                    return Err(document.error_at(self.motion.span(), message, None));
                }
                let problem = Reorientation::over(task, family, Accuracy::FINE);
                (Arc::new(problem) as Arc<dyn AnyReorientation>, rows.concat())
            }
        };
        let cost = motion.j.map(|claim| claim.0);
        Ok(Published { problem, coefficients, duration, cost })
    }

    /// The shape as given, with as many values as the robot has joints that follow none.
    fn shape(&self, robot: &Robot, document: &Document) -> Result<Shape, InputError> {
        let (motion, joints) = (self.motion.get_ref(), robot.leading_count());
        let own = if joints < robot.joint_count() { " that follows no other" } else { "" };
        let error = |span, message: String| Err(document.error_at(span, message, None));
        match (&motion.alpha6, &motion.alpha7, &motion.coefficients) {
            (Some(alpha6), Some(alpha7), None) => {
                for list in [alpha6, alpha7] {
                    let found = list.get_ref().len();
                    if found != joints {
                        let found = plural(found, "value");
                        let message =
                            format!("found {found}, expected {joints}, one per joint{own}");
                        return error(list.span(), message);
                    }
                }
                let all = alpha6.get_ref().iter().chain(alpha7.get_ref());
                Ok(Shape::Alpha(all.map(|a| a.0).collect()))
            }
            (None, None, Some(list)) => {
                let rows = list.get_ref();
                let terms = rows.first().map_or(0, Vec::len);
                if terms == 0 || rows.len() != joints || rows.iter().any(|row| row.len() != terms) {
                    let message = format!(
                        "expected {}, one per joint{own}, with the same number of coefficients",
                        plural(joints, "row")
                    );
                    return error(list.span(), message);
                }
                let row = |row: &Vec<Finite>| row.iter().map(|c| c.0).collect();
                Ok(Shape::Coefficients(rows.iter().map(row).collect()))
            }
            _ => error(
                self.motion.span(),
                "expected either `alpha6` and `alpha7`, or `coefficients`".to_owned(),
            ),
        }
    }
}

/// The two ways to write a shape down.
enum Shape {
    /// `α_6` of all joints, then `α_7`.
    Alpha(Vec<f64>),
    /// One row per joint, all of the same length.
    Coefficients(Vec<Vec<f64>>),
}

impl Shape {
    /// Free coefficients per joint.
    fn free(&self) -> usize {
        match self {
            Self::Alpha(_) => 2,
            Self::Coefficients(rows) => rows[0].len(),
        }
    }
}

impl Published {
    /// The motion under every reading that it has.
    pub fn readings(&self) -> Vec<(Reading, Assessment)> {
        let read = |reading| Some((reading, self.assess(reading)?));
        Reading::ALL.into_iter().filter_map(read).collect()
    }

    /// The motion under a reading; none where the paper has nothing of the motion's family.
    pub fn assess(&self, reading: Reading) -> Option<Assessment> {
        match reading {
            Reading::Physics => Some(self.problem.certify(&self.coefficients, Some(self.duration))),
            Reading::AsPublished => self.assess_as_published(),
        }
    }

    fn assess_as_published(&self) -> Option<Assessment> {
        let task = self.problem.task();
        let problem =
            Reorientation::new(task.clone(), self.problem.spec().terms()?, Accuracy::FINE);
        let path = problem.family().path(&self.coefficients);
        let end = transposed_attitude(task, &path, roll_first(&task.start));
        let peaks = sampled_peaks(&path, self.duration);
        let excess = peaks.excess(&task.limits);
        let attitude_error = attitude_error(&roll_first(&task.goal), &end);
        Some(Assessment {
            cost: problem.terms().cost(attitude_error, self.duration, &excess, 0.0),
            attitude_error,
            duration: self.duration,
            excess,
            range_excess: 0.0,
            path_excess: 0.0,
            path: Vec::new(),
            residual_error: None,
            peaks,
        })
    }
}

/// The same ZYX angles composed in the other order, `Rx Ry Rz`.
fn roll_first(posture: &Posture) -> UnitQuaternion<f64> {
    let (roll, pitch, yaw) = posture.base.euler_angles();
    let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
    about(Vector3::x_axis(), roll) * about(Vector3::y_axis(), pitch) * about(Vector3::z_axis(), yaw)
}

/// Eq. 9 driven with `R(Q)ᵀ ω_b`: classical Runge–Kutta in `τ`.
fn transposed_attitude(
    task: &Task,
    path: &Path<'_>,
    start: UnitQuaternion<f64>,
) -> UnitQuaternion<f64> {
    let width = 1.0 / RUNGE_KUTTA_STEPS as f64;
    let mut angles = vec![0.0; task.robot.joint_count()];
    let mut rates = angles.clone();
    let mut base_rate = |tau: f64| {
        path.angles_and_rates(tau, &mut angles, &mut rates);
        Vector3::from(base_twist(&task.robot, &angles, &rates).angular)
    };
    let slope = |q: Quaternion<f64>, omega: Vector3<f64>| {
        let inertial = UnitQuaternion::new_normalize(q).inverse() * omega;
        Quaternion::from_imag(inertial * 0.5) * q
    };
    let mut q = start.into_inner();
    for i in 0..RUNGE_KUTTA_STEPS {
        let tau = i as f64 * width;
        let rates = [tau, tau + width / 2.0, tau + width].map(&mut base_rate);
        let k1 = slope(q, rates[0]);
        let k2 = slope(q + k1 * (width / 2.0), rates[1]);
        let k3 = slope(q + k2 * (width / 2.0), rates[1]);
        let k4 = slope(q + k3 * width, rates[2]);
        q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (width / 6.0);
    }
    UnitQuaternion::new_normalize(q)
}

/// The largest values on a grid from zero that stops short of the end \[rad/s, rad/s², rad/s³\].
fn sampled_peaks(path: &Path<'_>, duration: f64) -> Peaks {
    let step = SAMPLE_STEP.max(duration / MOST_SAMPLES);
    let last = (duration / step + 1e-9).floor() as usize;
    let peaks = path.joints().map(|joint| {
        (0..=last).fold([Peak::default(); 3], |peak, i| {
            let tau = i as f64 * step / duration;
            let sample = joint.derivatives::<4>(tau);
            std::array::from_fn(|k| peak[k].or(Peak { value: sample[k + 1].abs(), tau }))
        })
    });
    Peaks(peaks.collect()).over(duration)
}
