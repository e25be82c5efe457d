//! Which branch of the tool's goal a motion ends in.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::{PlanError, Planned, Planner, Search, Spent};
use crate::input::InputError;
use crate::reorientation::reach::Reach;
use crate::task::Task;

/// Branches that are looked at, the nearest ones.
const BRANCHES: usize = 8;

/// Evaluations that a look at one of them takes at least.
const LEAST_LOOK: u64 = 200;

/// Starts that are followed for the first look at each, over the paper's family.
const STARTS: usize = 4;

/// Branches that are searched in earnest where motions do not reach their goals.
const TRIES: usize = 3;

impl Planner {
    /// The best of several tasks by a first look, searched in earnest; of tasks that differ in their ends. Gives which one that is.
    pub(super) fn plan_one_of(
        &self,
        tasks: Vec<Task>,
        search: Search<'_>,
    ) -> Result<(usize, Planned), PlanError> {
        // Looks may spend half of the budget.
        let affordable = (search.budget / (2 * LEAST_LOOK)).max(1) as usize;
        let planners = tasks.into_iter().take(BRANCHES.min(affordable)).map(|task| self.on(task));
        let planners: Vec<Self> = planners.collect::<Result<_, _>>()?;
        if let [only] = &planners[..] {
            return Ok((0, only.waiting(only.search(search)?, search)?));
        }
        let started = Instant::now();
        let looked =
            Search { budget: (search.budget / (2 * planners.len() as u64)).max(1), ..search };
        let looks: Vec<Option<Planned>> = planners.par_iter().map(|p| p.look(looked)).collect();
        let mut spent =
            looks.iter().flatten().fold(Spent::default(), |all, look| all.and(look.spent));
        let rank = |look: &Option<Planned>| {
            let of = |look: &Planned| (look.reach != Reach::Reached, look.assessment.cost);
            look.as_ref().map_or((true, f64::INFINITY), of)
        };
        let mut order: Vec<usize> = (0..planners.len()).collect();
        order.sort_by(|&a, &b| {
            let ((a_misses, a), (b_misses, b)) = (rank(&looks[a]), rank(&looks[b]));
            a_misses.cmp(&b_misses).then(a.total_cmp(&b))
        });
        let mut best: Option<(usize, Planned)> = None;
        let mut interrupted = looks.iter().flatten().any(|look| look.interrupted);
        for branch in order.into_iter().take(TRIES) {
            let left = search.budget.saturating_sub(spent.evaluations);
            let is_over = |found: &Planned| found.reach == Reach::Reached;
            if left == 0 || interrupted || best.as_ref().is_some_and(|(_, found)| is_over(found)) {
                break;
            }
            let found = match planners[branch].search(Search { budget: left, ..search }) {
                Err(PlanError::Interrupted) => {
                    interrupted = true;
                    break;
                }
                found => found?,
            };
            spent = spent.and(found.spent);
            interrupted |= found.interrupted;
            let is_better = best.as_ref().is_none_or(|(_, best)| found.is_better_than(best));
            if is_better {
                best = Some((branch, found));
            }
        }
        // Where there was no time for more, the best of the looks is what there is.
        let first = |look: (usize, Option<Planned>)| Some((look.0, look.1?));
        let looked = looks.into_iter().enumerate().filter_map(first);
        let looked = looked.min_by(|a, b| a.1.assessment.cost.total_cmp(&b.1.assessment.cost));
        let none = if interrupted { PlanError::Interrupted } else { PlanError::NoMotion };
        let (branch, best) = best.or(looked).ok_or(none)?;
        spent.seconds = started.elapsed().as_secs_f64();
        let best = Planned { spent, interrupted, ..best };
        Ok((branch, planners[branch].waiting(best, search)?))
    }

    /// The same for another task.
    pub(super) fn on(&self, task: Task) -> Result<Self, InputError> {
        let task = Arc::new(task);
        let problem = self.file.trajectory.build(task.clone(), &self.document)?;
        let other = self.other.as_ref().map(|_| self.file.few_terms(task, &self.document));
        Ok(Self { problem, other: other.transpose()?, ..self.clone() })
    }

    /// A first look at what the task comes to.
    fn look(&self, search: Search<'_>) -> Option<Planned> {
        let problem = self.file.few_terms(self.task().clone(), &self.document).ok()?;
        search.few_terms(&problem, STARTS)
    }
}
