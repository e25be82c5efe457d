//! Comma-separated values.

use super::{ExportError, rows};
use crate::reorientation::motion::Motion;

/// The table of a motion.
pub(super) fn motion(motion: &Motion) -> Result<Vec<u8>, ExportError> {
    let error = |reason: String| ExportError::Format { format: "CSV", reason };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows(motion) {
        writer.serialize(row).map_err(|e| error(e.to_string()))?;
    }
    writer.into_inner().map_err(|e| error(e.to_string()))
}
