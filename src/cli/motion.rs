//! What `plan` and `replay` say of a motion.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::sampling::SamplingOptions;
use crate::inverse_kinematics::{Miss, Orientation};
#[cfg(feature = "harness")]
use crate::output::create_folder;
use crate::output::{check_folder_writable, check_writable};
use crate::reorientation::{
    AnyReorientation, Assessment, Closest, Excursions, ExportError, Motion, MotionFormat, Record,
    Sampling, TooManySamples, ToolEnd, Used, intervals, write_motion,
};
use crate::robot::{JointKind, MovingJoint, Robot, ShapeSource};
use crate::task::{Task, ToolGoal};

/// Where to write a motion.
#[derive(Debug, Args)]
pub(super) struct MotionFiles {
    /// Write the motion in the format of the extension: .csv or .parquet (a row for each time and joint), .wide.csv (a row for
    /// each time), .mat (MATLAB), .yaml (ROS JointTrajectory), .goal.yaml (goal of ROS 2's FollowJointTrajectory), .mujoco (a folder
    /// with a MuJoCo model that plays it)
    #[arg(long, value_name = "FILE")]
    motion: Option<PathBuf>,
    #[command(flatten)]
    sampling: SamplingOptions,
    /// Joints to write with --motion: names, or prefixes such as left_* [default: all]
    #[arg(long, value_name = "JOINTS", value_delimiter = ',', requires = "motion")]
    joints: Vec<String>,
    /// Draw joint angles, their derivatives, the base's attitude and snapshots into a folder
    #[cfg(feature = "harness")]
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

impl MotionFiles {
    /// Checks the files' names and folders before any work is done.
    pub(super) fn check(&self) -> Result<(), CliError> {
        match self.format()? {
            Some((path, MotionFormat::Mujoco)) => {
                if !self.joints.is_empty() {
                    let message = "--joints: a motion for MuJoCo always has all joints".to_owned();
                    return Err(CliError::Usage { message, help: None });
                }
                check_folder_writable(path)?;
            }
            Some((path, _)) => check_writable(path)?,
            None => self.sampling.check_unused("--motion FILE")?,
        }
        #[cfg(feature = "harness")]
        if let Some(folder) = &self.figures {
            create_folder(folder)?;
        }
        Ok(())
    }

    /// Refuses a format that cannot have a load that changes on the way, before any work is done.
    pub(super) fn check_changing_load(&self) -> Result<(), CliError> {
        match self.format()? {
            Some((path, format)) if !format.takes_changing_load() => Err(CliError::Usage {
                message: format!(
                    "cannot write {}: the robot's load changes during the motion, and a MuJoCo model has one load",
                    path.display()
                ),
                help: None,
            }),
            _ => Ok(()),
        }
    }

    /// Checks the joints asked for before any work is done.
    pub(super) fn check_joints(&self, robot: &Robot) -> Result<(), CliError> {
        let names: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
        match self.joints.iter().find(|asked| !names.iter().any(|name| is_meant(asked, name))) {
            None => Ok(()),
            Some(asked) => Err(CliError::Usage {
                message: format!("--joints: no joint `{asked}` of robot `{}`", robot.name()),
                help: Some(format!("its joints are {}", names.join(", "))),
            }),
        }
    }

    /// Says which of the files that were asked for there are not, as there is no motion.
    pub(super) fn tell_unwritten(&self) {
        if let Some(path) = &self.motion {
            note!("note: no motion is written to {}", path.display());
        }
        #[cfg(feature = "harness")]
        if let Some(folder) = &self.figures {
            note!("note: nothing is drawn into {}", folder.display());
        }
    }

    fn format(&self) -> Result<Option<(&Path, MotionFormat)>, CliError> {
        let Some(path) = &self.motion else { return Ok(None) };
        let usage = |message: String| CliError::Usage { message, help: None };
        match MotionFormat::of(path) {
            Some(format) if format.is_available() => Ok(Some((path, format))),
            Some(_) => Err(usage("this build leaves out Parquet".to_owned())),
            None => Err(usage(format!(
                "cannot tell the format of {}, expected a name in {}",
                path.display(),
                MotionFormat::endings()
            ))),
        }
    }

    /// Writes what was asked for.
    pub(super) fn write(
        &self,
        problem: &dyn AnyReorientation,
        coefficients: &[f64],
        duration: f64,
    ) -> Result<(), CliError> {
        let record = |sampling: Option<Sampling>| {
            let sampling = sampling.unwrap_or_else(|| intervals(problem.spec()).into());
            sampling.check(duration)?;
            let motion = problem.sample_at(coefficients, duration, sampling);
            Ok(Record::new(&problem.task().robot, motion))
        };
        let sample = |intervals| problem.sample(coefficients, duration, intervals);
        self.write_samples(problem.task(), record, sample)
    }

    /// The same, of a motion that has to be sampled: for other tools at the times that were asked for, if any, and for charts
    /// in so many intervals.
    pub(super) fn write_samples<'a>(
        &self,
        task: &Task,
        record: impl FnOnce(Option<Sampling>) -> Result<Record<'a>, TooManySamples>,
        sample: impl Fn(usize) -> Motion,
    ) -> Result<(), CliError> {
        if let Some((path, format)) = self.format()? {
            let mut record = record(self.sampling.choice()).map_err(ExportError::from)?;
            if !self.joints.is_empty() {
                record.retain_joints(|name| self.joints.iter().any(|asked| is_meant(asked, name)));
            }
            write_motion(path, format, &record)?;
        }
        #[cfg(feature = "harness")]
        if let Some(folder) = &self.figures {
            let motion = sample(crate::reorientation::SAMPLES);
            crate::reorientation::write_motion_figures(folder, &motion, task)?;
        }
        #[cfg(not(feature = "harness"))]
        let _ = (task, sample);
        Ok(())
    }
}

/// Whether a name is the one asked for, or begins as that does before a `*`.
fn is_meant(asked: &str, name: &str) -> bool {
    asked.strip_suffix('*').map_or(asked == name, |start| name.starts_with(start))
}

/// Errors of the residual that its digits show \[°\].
const SHOWN_ERROR: f64 = 5e-7;

/// A residual \[rad\] and by how much it may be wrong, where that shows.
pub(super) fn residual(residual: f64, error: Option<f64>) -> String {
    let degrees = residual.to_degrees();
    match error.map(f64::to_degrees) {
        Some(error) if error.is_infinite() => {
            format!("{degrees:.6}° (uncertain: the motion swings too often)")
        }
        Some(error) if error >= SHOWN_ERROR => format!("{degrees:.6}° ± {error:.6}°"),
        _ => format!("{degrees:.6}°"),
    }
}

/// Where the tool ends, and where that leaves the joints.
fn tool_told(task: &Task, goal: &ToolGoal, end: &ToolEnd) -> String {
    let Miss { position, angle } = end.miss;
    let mut misses = Vec::new();
    if goal.target.position.is_some() {
        misses.push(format!("{position:.1e} m"));
    }
    if goal.target.orientation != Orientation::Any {
        misses.push(format!("{:.1e}°", angle.to_degrees()));
    }
    let joints = task.robot.joints().zip(&end.joints);
    let at = |(joint, at): (MovingJoint<'_>, &f64)| {
        let value = joint.kind.to_file_units(*at);
        match joint.kind {
            JointKind::Revolute => format!("{value:.3}°"),
            JointKind::Prismatic => format!("{value:.4} m"),
        }
    };
    let joints: Vec<String> = joints.map(at).collect();
    format!(
        "  tool           {} from its goal; joints end at {}",
        misses.join(" and "),
        joints.join(", ")
    )
}

/// For people: cost and its parts, then the peaks joint by joint with the share of the limit used, and what happens on the way.
pub(super) struct Told<'a> {
    pub(super) task: &'a Task,
    pub(super) assessment: &'a Assessment,
    pub(super) excursions: &'a Excursions,
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { task, assessment, excursions } = self;
        writeln!(f, "  J              {:.6}", assessment.cost)?;
        writeln!(f, "  duration       {:.6} s", assessment.duration)?;
        let residual = residual(assessment.residual(), assessment.residual_error);
        writeln!(f, "  base residual  {residual}")?;
        writeln!(f, "  penalty        {:.6}", assessment.penalty())?;
        let names = task.robot.joints().map(|joint| joint.name.chars().count());
        let width = names.max().unwrap_or_default().max(12);
        let slides = task.robot.sliding_joint().is_some();
        let heads = if slides {
            "rate [unit/s]  acceleration [unit/s²] jerk [unit/s³]       range    unit"
        } else {
            "rate [°/s]     acceleration [°/s²]   jerk [°/s³]           range"
        };
        writeln!(f, "  {:<width$}   {heads}", "joint")?;
        let used = excursions.range_used(task);
        let joints = task.robot.joints().zip(&assessment.peaks.0).zip(&task.limits.0).zip(used);
        for (((joint, peaks), limits), used) in joints {
            write!(f, "  {:<width$}", joint.name)?;
            for (peak, limit) in peaks.iter().zip(limits) {
                let share = 100.0 * peak.value / limit;
                let value = joint.kind.to_file_units(peak.value);
                write!(f, "  {value:>9.4} ({share:>4.0} %)")?;
            }
            let unit = if slides { format!("    {}", joint.kind.symbol()) } else { String::new() };
            writeln!(f, "  {:>5.0} %{unit}", 100.0 * used)?;
        }
        // Angles and distances do not compare.
        for kind in [JointKind::Revolute, JointKind::Prismatic] {
            let all = task.robot.joints().zip(&assessment.peaks.0);
            let own = all.filter(|(joint, _)| joint.kind == kind);
            let largest = own.max_by(|a, b| a.1[2].value.total_cmp(&b.1[2].value));
            if let Some((joint, peaks)) = largest {
                let jerk = kind.to_file_units(peaks[2].value);
                let (unit, time) = (kind.symbol(), peaks[2].tau * assessment.duration);
                writeln!(
                    f,
                    "  largest jerk   {jerk:.4} {unit}/s³ on {} at {time:.4} s",
                    joint.name
                )?;
            }
        }
        writeln!(
            f,
            "  on the way     the base is up to {:.3}° from its start (at {:.4} s), turning at up to {:.3} °/s",
            excursions.base_turn.to_degrees(),
            excursions.base_turn_at,
            excursions.base_rate.to_degrees()
        )?;
        write!(f, "                 the tool moves at up to {:.4} m/s", excursions.tool_speed)?;
        for kind in [JointKind::Revolute, JointKind::Prismatic] {
            let own = task.robot.joints().zip(&excursions.torques).filter(|(j, _)| j.kind == kind);
            if let Some((joint, torque)) = own.max_by(|a, b| a.1.total_cmp(b.1)) {
                let unit = if kind == JointKind::Revolute { "N·m" } else { "N" };
                write!(f, ", {} takes up to {torque:.4} {unit}", joint.name)?;
            }
        }
        let mut lines = Vec::new();
        if let (Some(goal), Some(end)) = (&task.tool, &excursions.tool) {
            lines.push(tool_told(task, goal, end));
        }
        if let Some(Closest { between: [one, other], distance, at, shapes }) = &excursions.closest {
            let state = if *distance < 0.0 { "overlap by" } else { "come as near as" };
            let source = match shapes {
                ShapeSource::Stated => "",
                ShapeSource::Derived => ", by derived shapes",
            };
            let distance = distance.abs();
            lines.push(format!(
                "                 {one} and {other} {state} {distance:.4} m (at {at:.4} s){source}"
            ));
        }
        if let Some(rate) = excursions.end_rate {
            lines.push(format!(
                "  drift          at the end the base keeps turning at {:.4} °/s",
                rate.norm().to_degrees()
            ));
        }
        if !excursions.used.is_empty() {
            let share = |Used { limit, share, .. }: &Used| {
                format!("{} {:.1} %", limit.name().replace('_', " "), 100.0 * share)
            };
            let shares: Vec<String> = excursions.used.iter().map(share).collect();
            lines.push(format!("  limits used    {}", shares.join(", ")));
        }
        lines.iter().try_for_each(|line| write!(f, "\n{line}"))
    }
}
