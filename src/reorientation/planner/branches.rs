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
        let planners = tasks.into_iter().take(BRANCHES).map(|task| self.on(task));
        let planners: Vec<Self> = planners.collect::<Result<_, _>>()?;
        if let [only] = &planners[..] {
            return Ok((0, only.search(search)?));
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
        for branch in order.into_iter().take(TRIES) {
            let left = search.budget.saturating_sub(spent.evaluations);
            let is_over = |found: &Planned| found.interrupted || found.reach == Reach::Reached;
            if left == 0 || best.as_ref().is_some_and(|(_, found)| is_over(found)) {
                break;
            }
            let found = planners[branch].search(Search { budget: left, ..search })?;
            spent = spent.and(found.spent);
            let is_better = best.as_ref().is_none_or(|(_, best)| found.is_better_than(best));
            if is_better {
                best = Some((branch, found));
            }
        }
        let (branch, best) = best.ok_or(PlanError::NoMotion)?;
        spent.seconds = started.elapsed().as_secs_f64();
        Ok((branch, Planned { spent, ..best }))
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
