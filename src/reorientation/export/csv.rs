//! Comma-separated values.

use super::ExportError;
use super::long::number_columns;
use super::record::Record;
use super::wide::header;

/// The table with one row for each time and joint.
pub(super) fn long(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    let unit = record.slides().then_some("unit");
    let names = ["time", "joint"].into_iter().chain(unit).chain(number_columns());
    written(
        names.map(str::to_owned),
        record.rows().map(|(time, joint)| {
            let own = &record.joints[joint].motion;
            let unit = unit.map(|_| own.kind.si_unit().to_owned());
            let numbers = record.numbers(time, joint).into_iter().map(shown);
            [shown(record.time[time]), own.name.clone()].into_iter().chain(unit).chain(numbers)
        }),
    )
}

/// The table with one row for each time.
pub(super) fn wide(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    let joints = record.joints.iter().map(|joint| (&*joint.motion.name, joint.motion.kind));
    let rows = (0..record.time.len()).map(|time| record.wide_row(time).map(shown));
    written(header(joints).into_iter(), rows)
}

/// With all digits.
fn shown(number: f64) -> String {
    format!("{number:?}")
}

fn written<R: Iterator<Item = String>>(
    names: impl Iterator<Item = String>,
    rows: impl Iterator<Item = R>,
) -> Result<Vec<u8>, ExportError> {
    let error = |reason: String| ExportError::Format { format: "CSV", reason };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(names.map(String::into_bytes)).map_err(|e| error(e.to_string()))?;
    for row in rows {
        writer.write_record(row.map(String::into_bytes)).map_err(|e| error(e.to_string()))?;
    }
    writer.into_inner().map_err(|e| error(e.to_string()))
}
