//! Comma-separated values: a row for each time, or one for each time and joint.

use std::fs::File;
use std::io::{BufRead as _, BufReader};

use csv::{Position, ReaderBuilder, StringRecord, Trim};

use super::collect::Collector;
use super::error::{Source, TrajectoryError, cut};
use super::header::{Header, UNIT};
use super::units::AngleUnit;
use crate::robot::Robot;
use crate::trajectory::Points;

/// Bytes in which the first line is looked at.
const BUFFER: usize = 1 << 16;

/// The points of a table, and the names of columns that were not read.
pub(super) fn read(
    file: File,
    robot: &Robot,
    unit: Option<AngleUnit>,
    source: Source<'_>,
) -> Result<(Points, Vec<String>), TrajectoryError> {
    let mut file = BufReader::with_capacity(BUFFER, file);
    let start = file.fill_buf().map_err(|error| source.unreadable(error))?;
    let delimiter = delimiter(start.split(|&byte| byte == b'\n').next().unwrap_or_default());
    let mut reader = ReaderBuilder::new().trim(Trim::All).delimiter(delimiter).from_reader(file);
    let wrong = |error: csv::Error| csv_error(error, source);
    let names: Vec<String> = reader.headers().map_err(wrong)?.iter().map(str::to_owned).collect();
    if names.is_empty() {
        return Err(source.error("found an empty file, expected a line with the columns' names"));
    }
    let header = Header::read(&names, robot, unit, source)?;
    let unit_column = header.joint.and_then(|_| names.iter().position(|name| name == UNIT));
    let mut collector = Collector::new(&header, robot, source);
    let mut record = StringRecord::new();
    while reader.read_record(&mut record).map_err(wrong)? {
        let line = record.position().map_or(0, Position::line);
        let found = unit_column.and_then(|column| record.get(column));
        if let Some(found) = found.filter(|found| !["rad", "m"].contains(found)) {
            let message = format!("found the unit `{}`, expected `rad` or `m`", cut(found));
            return Err(source.error_at(line, message));
        }
        let joint = header.joint.and_then(|column| record.get(column));
        collector.take(line, joint, |column| {
            let text = record.get(column).unwrap_or_default();
            text.parse().map_err(|_| {
                let point = if text.contains(',') { " with a decimal point" } else { "" };
                let (text, column) = (cut(text), cut(&names[column]));
                let message =
                    format!("found `{text}` in the column `{column}`, expected a number{point}");
                source.error_at(line, message)
            })
        })?;
    }
    Ok((collector.finish()?, header.ignored))
}

/// What most often stands between the columns' names.
fn delimiter(line: &[u8]) -> u8 {
    let count = |delimiter: u8| line.split(|&byte| byte == delimiter).count();
    // The last of equal ones.
    [b'\t', b';', b','].into_iter().max_by_key(|&delimiter| count(delimiter)).unwrap_or(b',')
}

fn csv_error(error: csv::Error, source: Source<'_>) -> TrajectoryError {
    let line = error.position().map_or(1, Position::line);
    let message = match error.into_kind() {
        csv::ErrorKind::Io(error) => return source.unreadable(error),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("found {len} fields, expected {expected_len} as in the first line")
        }
        csv::ErrorKind::Utf8 { .. } => "found bytes that are not text, expected UTF-8".to_owned(),
        _ => "found no comma-separated values".to_owned(),
    };
    source.error_at(line, message)
}
