//! The best motion of every instance of an experiment, one file each.

use std::collections::HashSet;
use std::path::Path;

use super::suite::{file_name, unlike};
use super::{ExportError, INTERVALS, MotionFormat, write_motion};
use crate::analysis::{Run, best_run};
use crate::experiment::Plan;
use crate::output::write_folder;
use crate::reorientation::Motion;

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
        for (i, instance) in plan.instances.iter().enumerate() {
            let best = best_run(runs.iter().filter(|run| run.instance == i));
            let (Some(problem), Some(best)) = (instance.reorientation(), best) else { continue };
            let label = if instance.label.is_empty() { "best" } else { &instance.label };
            let name = unlike(&file_name(label), &mut taken);
            let path = folder.join(name).with_extension(format.extension());
            let motion = Motion::sample(problem, &best.coefficients, best.duration, INTERVALS);
            write_motion(&path, format, &motion)?;
        }
        Ok::<(), ExportError>(())
    })?;
    Ok(taken.len())
}
