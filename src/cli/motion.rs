//! What `plan` and `replay` say of a motion.

use std::fmt;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use crate::output::check_writable;
#[cfg(feature = "harness")]
use crate::output::create_folder;
use crate::reorientation::{
    AnyReorientation, Assessment, Excursions, INTERVALS, MotionFormat, write_motion,
};
use crate::task::Task;

/// Where to write a motion.
#[derive(Debug, Args)]
pub(super) struct MotionFiles {
    /// Write the motion to a .csv, .parquet or .yaml file (ROS JointTrajectory)
    #[arg(long, value_name = "FILE")]
    motion: Option<PathBuf>,
    /// Draw joint angles, their derivatives and the base's attitude into a folder
    #[cfg(feature = "harness")]
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

impl MotionFiles {
    /// Finds fault with the files' names and folders before any work is done.
    pub(super) fn check(&self) -> Result<(), CliError> {
        if let Some((path, _)) = self.format()? {
            check_writable(path)?;
        }
        #[cfg(feature = "harness")]
        if let Some(folder) = &self.figures {
            create_folder(folder)?;
        }
        Ok(())
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
                "cannot tell the format of {}, expected a name in .csv, .parquet or .yaml",
                path.display()
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
        if let Some((path, format)) = self.format()? {
            let motion = problem.sample(coefficients, duration, INTERVALS);
            write_motion(path, format, &motion)?;
        }
        #[cfg(feature = "harness")]
        if let Some(folder) = &self.figures {
            let motion = problem.sample(coefficients, duration, crate::reorientation::SAMPLES);
            crate::reorientation::write_motion_figures(folder, &motion, problem.task())?;
        }
        Ok(())
    }
}

/// Errors of the residual that its digits show \[°\].
const SHOWN_ERROR: f64 = 5e-7;

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
        write!(f, "  base residual  {:.6}°", assessment.residual().to_degrees())?;
        match assessment.residual_error.map(f64::to_degrees) {
            Some(error) if error.is_infinite() => {
                writeln!(f, " (uncertain: the motion swings too often)")?;
            }
            Some(error) if error >= SHOWN_ERROR => writeln!(f, " ± {error:.6}°")?,
            _ => writeln!(f)?,
        }
        writeln!(f, "  penalty        {:.6}", assessment.penalty())?;
        let names = task.robot.joints().map(|joint| joint.name.chars().count());
        let width = names.max().unwrap_or_default().max(12);
        writeln!(
            f,
            "  {:<width$}   rate [°/s]     acceleration [°/s²]   jerk [°/s³]           range",
            "joint"
        )?;
        let used = excursions.range_used(task);
        let joints = task.robot.joints().zip(&assessment.peaks.0).zip(&task.limits.0).zip(used);
        for (((joint, peaks), limits), used) in joints {
            write!(f, "  {:<width$}", joint.name)?;
            for (peak, limit) in peaks.iter().zip(limits) {
                let share = 100.0 * peak.value / limit;
                write!(f, "  {:>9.4} ({share:>4.0} %)", peak.value.to_degrees())?;
            }
            writeln!(f, "  {:>5.0} %", 100.0 * used)?;
        }
        let largest = |k: usize| {
            let all = task.robot.joints().zip(&assessment.peaks.0);
            all.max_by(|a, b| a.1[k].value.total_cmp(&b.1[k].value))
        };
        if let Some((joint, peaks)) = largest(2) {
            let (jerk, time) = (peaks[2].value.to_degrees(), peaks[2].tau * assessment.duration);
            writeln!(f, "  largest jerk   {jerk:.4} °/s³ on {} at {time:.4} s", joint.name)?;
        }
        write!(
            f,
            "  on the way     the base is up to {:.3}° from its start (at {:.4} s), turning at up to {:.3} °/s",
            excursions.base_turn.to_degrees(),
            excursions.base_turn_at,
            excursions.base_rate.to_degrees()
        )
    }
}
