//! Parquet.

use polars::prelude::ParquetWriter;

use super::ExportError;
use crate::reorientation::exhibits::motion_table;
use crate::reorientation::motion::Motion;

/// The table of a motion.
pub(super) fn motion(motion: &Motion) -> Result<Vec<u8>, ExportError> {
    let mut bytes = Vec::new();
    motion_table(motion)
        .and_then(|mut table| ParquetWriter::new(&mut bytes).finish(&mut table.frame))
        .map_err(|e| ExportError::Format { format: "Parquet", reason: e.to_string() })?;
    Ok(bytes)
}
