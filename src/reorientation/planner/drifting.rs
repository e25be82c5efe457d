//! Motions that wait until the momentum has turned the base to where the joints can bring it to its goal.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::{PlanError, Planned, Planner, Search};
use crate::momentum::BaseResponse;
use crate::optimiser::{Scp, Settings};
use crate::reorientation::fitness::Reorientation;
use crate::reorientation::formulation::Formulated;
use crate::reorientation::reach::Reach;
use crate::reorientation::settings::TaskProblem;
use crate::task::Task;
use crate::trajectory::{Family as _, Spline};

/// Durations that are looked at, longer than the motion that was found by up to a turn of the base by its momentum, but by no more
/// than so many times that motion's.
const DURATIONS: usize = 400;
const LONGEST: f64 = 100.0;

/// Durations that are searched in earnest, and how often one that reaches the goal is shortened.
const TRIES: usize = 4;
const SHORTER: usize = 6;

impl Planner {
    /// What was found or, where that does not reach its goal and momentum turns the base, a longer motion. Durations are tried at
    /// which the base would end near its goal by itself; then shorter ones, as long as they reach it.
    pub(super) fn waiting(&self, found: Planned, search: Search<'_>) -> Result<Planned, PlanError> {
        let is_wanted = |found: &Planned| found.reach == Reach::NotFound && !found.interrupted;
        let (Settings::Scp(scp), TaskProblem::Spline(problem, _)) =
            (&self.optimiser, &self.problem)
        else {
            return Ok(found);
        };
        if self.task().angular_momentum.is_none() || !is_wanted(&found) {
            return Ok(found);
        }
        let other = found.other.clone();
        let (mut best, mut too_short) = (found, 0.0);
        for least in near_passes(problem, best.assessment.duration) {
            let left = search.budget.saturating_sub(best.spent.evaluations);
            if !is_wanted(&best) || left == 0 {
                break;
            }
            let next = match self
                .with_least_duration(least)?
                .search(Search { budget: left, ..search })
            {
                Err(PlanError::Interrupted) => return Ok(Planned { interrupted: true, ..best }),
                next => next?,
            };
            if next.reach == Reach::Reached {
                let longer = Planned { spent: best.spent.and(next.spent), other, ..next };
                return self.shortened(longer, too_short, scp, search);
            }
            too_short = least;
            best = best.or(next);
        }
        Ok(best)
    }

    /// The same with motions that last so long at least \[s\].
    fn with_least_duration(&self, least: f64) -> Result<Self, PlanError> {
        let task = Task { least_duration: least, ..(**self.task()).clone() };
        Ok(Self { other: None, ..self.clone() }.on(task)?)
    }

    /// A motion that takes less time than one that reaches its goal, if one is found by going on from it.
    fn shortened(
        &self,
        mut best: Planned,
        mut too_short: f64,
        scp: &Scp,
        search: Search<'_>,
    ) -> Result<Planned, PlanError> {
        for _ in 0..SHORTER {
            let least = f64::midpoint(too_short, best.assessment.duration);
            let planner = self.with_least_duration(least)?;
            let TaskProblem::Spline(problem, boxes) = &planner.problem else { return Ok(best) };
            let formulated = Formulated::free_form(problem.clone().into())
                .map_err(|error| self.refused(&error))?;
            let before = best.clone();
            let next = search.onward(scp, before, &formulated, &formulated, boxes.duration[1])?;
            if next.reach == Reach::Reached && next.assessment.duration < best.assessment.duration {
                best = Planned { other: best.other, ..next };
            } else {
                (best.spent, best.interrupted) = (next.spent, next.interrupted);
                too_short = least;
            }
            if best.interrupted {
                break;
            }
        }
        Ok(best)
    }
}

/// When the base would pass nearest to its goal while the joints take the straight path, after a motion of some duration \[s\], the
/// earliest first.
fn near_passes(problem: &Reorientation<Spline>, duration: f64) -> Vec<f64> {
    let task = problem.task();
    let still = vec![0.0; task.robot.joint_count()];
    let response = BaseResponse::of(&task.robot, &task.start.joints, &still);
    let rate = Vector3::from(response.with(task.momentum_at(&task.start.base))).norm();
    let longest = duration + (TAU / rate).min(LONGEST * duration);
    let straight = vec![0.0; problem.family().dimension()];
    let time = |k: usize| duration + k as f64 / DURATIONS as f64 * (longest - duration);
    let error = |k| problem.error_after(problem.rotation_over(&straight, time(k))).angle();
    let errors: Vec<f64> = (0..=DURATIONS).map(error).collect();
    let is_least = |k: &usize| {
        let beside =
            [k.checked_sub(1), k.checked_add(1)].map(|at| at.and_then(|at| errors.get(at)));
        beside.into_iter().flatten().all(|error| *error > errors[*k])
    };
    (1..=DURATIONS).filter(is_least).map(time).take(TRIES).collect()
}
