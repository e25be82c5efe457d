//! Parquet.

use super::{ExportError, Record};
use crate::reorientation::exhibits::motion_table;

/// The table of a motion.
pub(super) fn motion(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    let table = motion_table(record).map_err(|error| error.to_string());
    let bytes = table.and_then(|table| table.parquet());
    bytes.map_err(|reason| ExportError::Format { format: "Parquet", reason })
}
