//! Parquet: the tables that comma-separated values have.

use std::fs::File;

use polars::io::parquet::read::ParallelStrategy;
use polars::prelude::*;

use super::collect::{Collector, MOST_POINTS};
use super::error::{Source, TrajectoryError, cut};
use super::header::Header;
use super::units::AngleUnit;
use crate::experiment::caught;
use crate::robot::Robot;
use crate::trajectory::Points;

/// The points of a table, and the names of columns that were not read.
pub(super) fn read(
    file: File,
    robot: &Robot,
    unit: Option<AngleUnit>,
    source: Source<'_>,
) -> Result<(Points, Vec<String>), TrajectoryError> {
    // Some damage makes polars panic.
    let (header, names, frame) = caught(|| read_columns(file, robot, unit, source))
        .unwrap_or_else(|_| Err(damaged(source)))?;
    let column = |column: usize| frame.column(&names[column]).map_err(|_| damaged(source));
    let numbers = |place: usize| {
        let wrong = || {
            let column = cut(&names[place]);
            source.error(format!("found the column `{column}` that has no numbers, expected some"))
        };
        let column = column(place)?;
        if !column.dtype().is_primitive_numeric() {
            return Err(wrong());
        }
        let column = column.cast(&DataType::Float64).map_err(|_| wrong())?;
        Ok(column.f64().map_err(|_| wrong())?.clone())
    };
    let joints = header.joint.map(|place| {
        let wrong = || {
            let column = cut(&names[place]);
            source.error(format!("found the column `{column}` that has no texts, expected names"))
        };
        let texts = column(place)?.cast(&DataType::String).map_err(|_| wrong())?;
        Ok::<_, TrajectoryError>(texts.str().map_err(|_| wrong())?.clone())
    });
    let joints = joints.transpose()?;
    let mut columns: Vec<Option<Float64Chunked>> = vec![None; names.len()];
    for place in header.values.iter().map(|v| v.column).chain([header.time]) {
        columns[place] = Some(numbers(place)?);
    }
    let mut collector = Collector::new(&header, robot, source);
    for row in 0..frame.height() {
        let at = row as u64 + 1;
        let joint = joints.as_ref().map(|joints| joints.get(row).unwrap_or_default());
        collector.take(at, joint, |place| {
            columns[place].as_ref().and_then(|column| column.get(row)).ok_or_else(|| {
                let column = cut(&names[place]);
                source.error_at(
                    at,
                    format!("found nothing in the column `{column}`, expected a number"),
                )
            })
        })?;
    }
    let points = collector.finish()?;
    Ok((points, header.ignored))
}

/// The columns that are needed, what they are, and the names of all.
fn read_columns(
    file: File,
    robot: &Robot,
    unit: Option<AngleUnit>,
    source: Source<'_>,
) -> Result<(Header, Vec<String>, DataFrame), TrajectoryError> {
    let mut reader = ParquetReader::new(file).read_parallel(ParallelStrategy::None);
    let schema = reader.schema().map_err(|_| damaged(source))?;
    let names: Vec<String> = schema.iter_names().map(ToString::to_string).collect();
    let header = Header::read(&names, robot, unit, source)?;
    let most = MOST_POINTS * if header.joint.is_some() { robot.joint_count() } else { 1 };
    if reader.num_rows().map_err(|_| damaged(source))? > most {
        return Err(source.error(format!("found more than {MOST_POINTS} points, expected fewer")));
    }
    let needed = header.values.iter().map(|v| v.column).chain([header.time]).chain(header.joint);
    let needed = needed.map(|place| names[place].clone()).collect();
    let frame = reader.with_columns(Some(needed)).finish().map_err(|_| damaged(source))?;
    Ok((header, names, frame))
}

fn damaged(source: Source<'_>) -> TrajectoryError {
    source.error("found a damaged file or another format, expected Parquet")
}
