//! Motions in formats that other tools read.

mod csv;
mod joint_trajectory;
mod long;
mod mat;
#[cfg(feature = "harness")]
mod motions;
mod mujoco;
#[cfg(feature = "harness")]
mod parquet;
mod record;
mod wide;

use std::path::Path;

use super::family::FamilySpec;
use super::sampling::{INTERVALS, TooManySamples};
use crate::output::{FileError, folder_of, remove_temporary, write_file};
pub(super) use long::number_columns;
#[cfg(feature = "harness")]
pub use motions::write_motions;
pub use record::Record;
pub(super) use wide::header;

/// Intervals between the samples of an exported motion of a family: of splines as many more as cut all pieces into equal parts,
/// so that quintics through the samples, which robots' controllers play, are the spline again.
pub fn intervals(family: FamilySpec) -> usize {
    match family {
        FamilySpec::SinePolynomial { .. } => INTERVALS,
        FamilySpec::Spline { pieces, .. } => INTERVALS.next_multiple_of(pieces),
    }
}

/// A format for one motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionFormat {
    /// Comma-separated values, one row per time and joint.
    Csv,
    /// Comma-separated values, one row per time.
    WideCsv,
    /// The first table as Parquet.
    Parquet,
    /// MATLAB's binary file.
    Mat,
    /// ROS `trajectory_msgs/JointTrajectory` as YAML.
    Yaml,
    /// The goal of a ROS 2 `control_msgs/action/FollowJointTrajectory` as YAML.
    GoalYaml,
    /// A folder with the robot for MuJoCo and a script that plays the motion.
    Mujoco,
}

/// A motion that could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// There would be too many samples.
    #[error(transparent)]
    Samples(#[from] TooManySamples),
    /// The motion could not be brought into the format.
    #[error("cannot write a motion as {format}: {reason}")]
    Format {
        /// The format.
        format: &'static str,
        /// Why not.
        reason: String,
    },
}

impl MotionFormat {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Csv,
        Self::WideCsv,
        Self::Parquet,
        Self::Mat,
        Self::Yaml,
        Self::GoalYaml,
        Self::Mujoco,
    ];

    /// The format that a file's name asks for.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let long = name.strip_suffix(".yml").map(|stem| format!("{stem}.yaml"));
        let name = long.as_deref().unwrap_or(name);
        // `a.wide.csv` ends in `.csv`, too.
        let formats = Self::ALL.into_iter().filter(|format| name.ends_with(format.ending()));
        formats.max_by_key(|format| format.ending().len())
    }

    /// The end of its files' names.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Csv => ".csv",
            Self::WideCsv => ".wide.csv",
            Self::Parquet => ".parquet",
            Self::Mat => ".mat",
            Self::Yaml => ".yaml",
            Self::GoalYaml => ".goal.yaml",
            Self::Mujoco => ".mujoco",
        }
    }

    /// All ends of names, for people.
    pub fn endings() -> String {
        let [all @ .., last] = Self::ALL.map(Self::ending);
        format!("{} or {last}", all.join(", "))
    }

    /// Whether it can have a load that is caught or let go of on the way.
    pub fn takes_changing_load(self) -> bool {
        self != Self::Mujoco
    }

    /// Whether this build can write it.
    pub fn is_available(self) -> bool {
        self != Self::Parquet || cfg!(feature = "harness")
    }
}

/// Writes a motion, whole or not at all.
pub fn write_motion(
    path: &Path,
    format: MotionFormat,
    record: &Record<'_>,
) -> Result<(), ExportError> {
    let bytes = match format {
        MotionFormat::Csv => csv::long(record)?,
        MotionFormat::WideCsv => csv::wide(record)?,
        MotionFormat::Mat => mat::motion(record)?,
        MotionFormat::Yaml => joint_trajectory::motion(record)?,
        MotionFormat::GoalYaml => joint_trajectory::goal(record)?,
        MotionFormat::Mujoco => return mujoco::write(path, record),
        #[cfg(feature = "harness")]
        MotionFormat::Parquet => parquet::motion(record)?,
        #[cfg(not(feature = "harness"))]
        MotionFormat::Parquet => {
            let reason = "this build leaves out the feature `harness`".to_owned();
            return Err(ExportError::Format { format: "Parquet", reason });
        }
    };
    remove_temporary(folder_of(path));
    Ok(write_file(path, &bytes)?)
}
