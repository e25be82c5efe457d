//! Goals of the tool that move while the robot does: when they are met.

use super::{PlanError, Planned, Planner, Search};
use crate::input::{Document, InputError};
use crate::reorientation::reach::Reach;
use crate::task::{Task, TaskTable};

/// Times \[s\] at which a target is first looked for.
const MEETING_TIMES: [f64; 16] =
    [8.0, 16.0, 4.0, 32.0, 2.0, 64.0, 1.0, 12.0, 24.0, 48.0, 6.0, 96.0, 3.0, 128.0, 192.0, 256.0];

/// How often a later meeting is tried, and by how much later than a motion takes.
const TRIES: usize = 6;
const LATER: f64 = 1.01;

/// The task with its goal where the target is at some time at which the tool can be brought there.
pub(super) fn reachable(task: TaskTable, document: &Document) -> Result<TaskTable, InputError> {
    let mut refused = None;
    for time in MEETING_TIMES {
        let met = task.with_least_duration(time);
        match met.build_ends(document) {
            Ok(_) => return Ok(met),
            Err(error) => refused.get_or_insert(error),
        };
    }
    refused.map_or(Ok(task), Err)
}

impl Planner {
    /// The motion that meets the target soonest, as far as a few tries show: each meets it where it is a little later than the one
    /// before has taken, and lasts until then.
    pub(super) fn meeting(&self, search: Search<'_>) -> Result<Planned, PlanError> {
        let hasty = Task { least_duration: 0.0, ..(**self.task()).clone() };
        let mut found = self.on(hasty)?.plan_once(search)?;
        for _ in 0..TRIES {
            let budget = search.budget.saturating_sub(found.spent.evaluations);
            if found.interrupted || budget == 0 {
                break;
            }
            let time = LATER * found.assessment.duration;
            let task = self.file.task.with_least_duration(time).build(&self.document)?;
            let next = self.on(task)?.plan_once(Search { budget, ..search })?;
            let is_met = next.reach == Reach::Reached && next.assessment.duration <= time;
            found = Planned { spent: found.spent.and(next.spent), ..next };
            if is_met {
                return Ok(found);
            }
        }
        let reach = if found.reach == Reach::Reached { Reach::NotFound } else { found.reach };
        Ok(Planned { reach, ..found })
    }
}
