//! Motions in formats that other tools read.

mod csv;
mod joint_trajectory;
#[cfg(feature = "harness")]
mod motions;
#[cfg(feature = "harness")]
mod parquet;

use std::path::Path;

use super::family::FamilySpec;
use super::motion::Motion;
use crate::output::{FileError, folder_of, remove_temporary, write_file};
#[cfg(feature = "harness")]
pub use motions::write_motions;

/// Intervals between the samples of an exported motion.
pub const INTERVALS: usize = 500;

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
    /// The same table as Parquet.
    Parquet,
    /// ROS `trajectory_msgs/JointTrajectory` as YAML.
    Yaml,
}

/// A motion that could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
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
    /// The format that a file's name asks for.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "csv" => Some(Self::Csv),
            "parquet" => Some(Self::Parquet),
            "yaml" | "yml" => Some(Self::Yaml),
            _ => None,
        }
    }

    /// The end of its files' names.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Yaml => "yaml",
        }
    }

    /// Whether this build can write it.
    pub fn is_available(self) -> bool {
        self != Self::Parquet || cfg!(feature = "harness")
    }
}

/// Writes a motion, whole or not at all.
pub fn write_motion(path: &Path, format: MotionFormat, motion: &Motion) -> Result<(), ExportError> {
    let bytes = match format {
        MotionFormat::Csv => csv::motion(motion)?,
        MotionFormat::Yaml => joint_trajectory::motion(motion)?,
        #[cfg(feature = "harness")]
        MotionFormat::Parquet => parquet::motion(motion)?,
        #[cfg(not(feature = "harness"))]
        MotionFormat::Parquet => {
            let reason = "this build leaves out the feature `harness`".to_owned();
            return Err(ExportError::Format { format: "Parquet", reason });
        }
    };
    remove_temporary(folder_of(path));
    Ok(write_file(path, &bytes)?)
}

/// One row of the table of a motion. Positions in radians, or in the unit that a row says; the base's attitude turns base axes
/// into inertial axes.
#[derive(Debug, serde::Serialize)]
struct Row<'a> {
    time: f64,
    joint: &'a str,
    /// Of robots with joints that slide alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    angle: f64,
    rate: f64,
    acceleration: f64,
    jerk: f64,
    base_w: f64,
    base_x: f64,
    base_y: f64,
    base_z: f64,
}

/// The rows of a motion, by time, then by joint.
fn rows(motion: &Motion) -> impl Iterator<Item = Row<'_>> {
    let slides = motion.slides();
    motion.time.iter().zip(&motion.base).enumerate().flat_map(move |(i, (&time, base))| {
        motion.joints.iter().map(move |joint| {
            let [angle, rate, acceleration, jerk] = joint.derivatives[i];
            let [base_x, base_y, base_z, base_w] = base.coords.into();
            Row {
                time,
                joint: &joint.name,
                unit: slides.then_some(joint.kind.si_unit()),
                angle,
                rate,
                acceleration,
                jerk,
                base_w,
                base_x,
                base_y,
                base_z,
            }
        })
    })
}
