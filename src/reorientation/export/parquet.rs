//! Parquet.

use super::ExportError;
use crate::reorientation::exhibits::motion_table;
use crate::reorientation::motion::Motion;

/// The table of a motion.
pub(super) fn motion(motion: &Motion) -> Result<Vec<u8>, ExportError> {
    let table = motion_table(motion).map_err(|error| error.to_string());
    let bytes = table.and_then(|table| table.parquet());
    bytes.map_err(|reason| ExportError::Format { format: "Parquet", reason })
}
