//! The best motion of every instance that is a task.

use crate::experiment::{Instance, Plan, Run, best_runs};
use crate::reorientation::fitness::Reorientation;
use crate::reorientation::motion::Motion;
use crate::reorientation::subject::{DURATION, RESIDUAL, TaskSubject};

/// The best motion of an instance.
#[derive(Debug)]
pub(in crate::reorientation) struct BestMotion<'a> {
    pub(in crate::reorientation) run: &'a Run,
    pub(in crate::reorientation) instance: &'a Instance,
    /// The optimiser's label.
    pub(in crate::reorientation) optimiser: &'a str,
    pub(in crate::reorientation) problem: &'a Reorientation,
    pub(in crate::reorientation) coefficients: Vec<f64>,
    /// Error of the base \[°\].
    pub(in crate::reorientation) residual_deg: f64,
    /// Duration \[s\].
    pub(in crate::reorientation) duration: f64,
}

impl BestMotion<'_> {
    /// Sampled at so many intervals.
    pub(in crate::reorientation) fn sample(&self, intervals: usize) -> Motion {
        Motion::sample(self.problem, &self.coefficients, self.duration, intervals)
    }
}

/// The best motion of every instance that has one, in the order of the plan.
pub(in crate::reorientation) fn best_motions<'a>(
    plan: &'a Plan,
    runs: &'a [Run],
) -> Vec<BestMotion<'a>> {
    let (residual, duration) = (plan.measure(RESIDUAL), plan.measure(DURATION));
    let measure = |run: &Run, place: Option<usize>| place.map_or(f64::NAN, |p| run.measure(p));
    let motion = |run: &'a Run| {
        let (instance, entrant) = (&plan.instances[run.instance], &plan.optimisers[run.optimiser]);
        let subject = TaskSubject::of(instance)?;
        Some(BestMotion {
            run,
            instance,
            optimiser: &entrant.label,
            problem: subject.reorientation(),
            coefficients: subject.coefficients(&entrant.space(instance), &run.x)?,
            residual_deg: measure(run, residual),
            duration: measure(run, duration),
        })
    };
    best_runs(plan, runs).into_iter().filter_map(motion).collect()
}
