//! Motions that other programs have planned, given by points: read, and evaluated as a controller plays them.

mod assess;
mod base;
mod collect;
mod error;
mod faults;
mod header;
mod json;
#[cfg(feature = "harness")]
mod parquet;
mod table;
mod units;
mod yaml;

use std::fs::File;
use std::path::Path;

pub use assess::{PointReading, ReadPath, Replayed};
pub use error::TrajectoryError;
pub use faults::{Fault, FaultKind};
pub use json::{JointPeaks, PeakJson, ReplayedJson};
pub use units::AngleUnit;

use crate::robot::Robot;
use crate::trajectory::Points;
use collect::MOST_BYTES;
use error::Source;

/// A format of trajectories.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Table,
    Parquet,
    Message,
    /// Which is written, but not read.
    Mat,
}

impl Format {
    /// The format that a file's name asks for.
    fn of(path: &Path) -> Option<Self> {
        match &*path.extension()?.to_str()?.to_ascii_lowercase() {
            "csv" => Some(Self::Table),
            "parquet" => Some(Self::Parquet),
            "yaml" | "yml" | "json" => Some(Self::Message),
            "mat" => Some(Self::Mat),
            _ => None,
        }
    }
}

/// A trajectory of another program.
#[derive(Debug, Clone)]
pub struct GivenTrajectory {
    /// Its points, joints in the robot's order.
    pub points: Points,
    /// Columns of its table that were not read.
    pub ignored: Vec<String>,
}

impl GivenTrajectory {
    /// Whether a file is one by its name: `.csv`, `.parquet`, `.yaml`, `.yml` or `.json`; or `.mat`, which is refused.
    pub fn has_name(path: &Path) -> bool {
        Format::of(path).is_some()
    }

    /// Reads a file. `unit` is that of angles in a table whose columns do not state any.
    pub fn read(
        path: &Path,
        robot: &Robot,
        unit: Option<AngleUnit>,
    ) -> Result<Self, TrajectoryError> {
        let format = Format::of(path);
        let source = Source { path, is_text: format != Some(Format::Parquet) };
        let unreadable = |error| source.unreadable(error);
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.len() > MOST_BYTES {
            return Err(
                source.error(format!("found more than {} GiB, expected less", MOST_BYTES >> 30))
            );
        }
        let (points, ignored) = match format {
            Some(Format::Table) => table::read(file, robot, unit, source)?,
            #[cfg(feature = "harness")]
            Some(Format::Parquet) => parquet::read(file, robot, unit, source)?,
            #[cfg(not(feature = "harness"))]
            Some(Format::Parquet) => return Err(source.error("this build leaves out Parquet")),
            Some(Format::Message) if unit.is_some() => {
                return Err(source.error(
                    "found `--unit`, which is for tables: a JointTrajectory is in radians",
                ));
            }
            Some(Format::Message) => (yaml::read(file, robot, source)?, Vec::new()),
            Some(Format::Mat) | None => {
                let found = if format.is_some() {
                    "MAT-files are written, but not read"
                } else {
                    "cannot tell the format"
                };
                return Err(source
                    .error(format!("{found}, expected a name in .csv, .parquet, .yaml or .json")));
            }
        };
        Ok(Self { points, ignored })
    }
}
