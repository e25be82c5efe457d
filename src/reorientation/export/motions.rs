//! The best motion of every instance of an experiment, one file each.

use std::collections::HashSet;
use std::path::Path;

use super::{ExportError, MotionFormat, Record, intervals, write_motion};
use crate::experiment::{Plan, Run};
use crate::output::{file_name, unlike, write_folder};
use crate::reorientation::exhibits::best::best_motions;
use crate::reorientation::exhibits::words::AT_GOAL_DEG;
use crate::reorientation::sampling::Sampling;

/// What was written.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct WrittenMotions {
    /// How many motions.
    pub motions: usize,
    /// How many of them end further than that from their goals.
    pub missed: usize,
    /// How far that is \[°\].
    pub tolerance_deg: f64,
}

/// Writes the best motion of every instance that is a task into a folder of their own, whole or not at
/// all. A file has the instance's label as its name, or `best` where there is none. Without a sampling, each has its family's
/// [`intervals`].
pub fn write_motions(
    folder: &Path,
    format: MotionFormat,
    sampling: Option<Sampling>,
    plan: &Plan,
    runs: &[Run],
) -> Result<WrittenMotions, ExportError> {
    let (mut taken, mut missed) = (HashSet::new(), 0);
    write_folder(folder, |folder| {
        for best in best_motions(&plan.results(runs)) {
            let label = &best.instance.label;
            let label = if label.is_empty() { "best" } else { label };
            let name = unlike(&file_name(label), &mut taken);
            missed += usize::from(best.residual_deg > AT_GOAL_DEG);
            let sampling = sampling.unwrap_or_else(|| intervals(best.problem.spec()).into());
            sampling.check(best.duration)?;
            let record = Record::new(&best.problem.task().robot, best.sample(sampling));
            write_motion(&folder.join(name + format.ending()), format, &record)?;
        }
        Ok::<(), ExportError>(())
    })?;
    Ok(WrittenMotions { motions: taken.len(), missed, tolerance_deg: AT_GOAL_DEG })
}
