//! Parquet, and the frame that it is made of.

use polars::prelude::*;

use super::{ExportError, Row, rows};
use crate::problem::Motion;

/// A motion in Parquet.
pub(super) fn motion(motion: &Motion) -> Result<Vec<u8>, ExportError> {
    let mut bytes = Vec::new();
    motion_table(motion)
        .and_then(|mut frame| ParquetWriter::new(&mut bytes).finish(&mut frame))
        .map_err(|e| ExportError::Format { format: "Parquet", reason: e.to_string() })?;
    Ok(bytes)
}

/// The table of a motion: a row for each time and joint, angles in radians, all else in SI units.
pub fn motion_table(motion: &Motion) -> PolarsResult<DataFrame> {
    let rows: Vec<Row<'_>> = rows(motion).collect();
    let real = |value: fn(&Row<'_>) -> f64| rows.iter().map(value).collect::<Vec<_>>();
    df!(
        "time" => real(|r| r.time),
        "joint" => rows.iter().map(|r| r.joint).collect::<Vec<_>>(),
        "angle" => real(|r| r.angle),
        "rate" => real(|r| r.rate),
        "acceleration" => real(|r| r.acceleration),
        "jerk" => real(|r| r.jerk),
        "base_w" => real(|r| r.base_w),
        "base_x" => real(|r| r.base_x),
        "base_y" => real(|r| r.base_y),
        "base_z" => real(|r| r.base_z),
    )
}
