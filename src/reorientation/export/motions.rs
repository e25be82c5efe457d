//! The best motion of every instance of an experiment, one file each.

use std::collections::HashSet;
use std::path::Path;

use super::{ExportError, INTERVALS, MotionFormat, write_motion};
use crate::experiment::{Plan, Run};
use crate::output::{file_name, unlike, write_folder};
use crate::reorientation::exhibits::best::best_motions;

/// Writes the best motion of every instance that is a task into a folder of their own, whole or not at
/// all; the number of motions. A file has the instance's label as its name, or `best` where there is none.
pub fn write_motions(
    folder: &Path,
    format: MotionFormat,
    plan: &Plan,
    runs: &[Run],
) -> Result<usize, ExportError> {
    let mut taken = HashSet::new();
    write_folder(folder, |folder| {
        for best in best_motions(&plan.results(runs)) {
            let label = &best.instance.label;
            let label = if label.is_empty() { "best" } else { label };
            let name = unlike(&file_name(label), &mut taken);
            let path = folder.join(name).with_extension(format.extension());
            write_motion(&path, format, &best.sample(INTERVALS))?;
        }
        Ok::<(), ExportError>(())
    })?;
    Ok(taken.len())
}
