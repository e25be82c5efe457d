//! The best motion of every instance that is a task.

use crate::experiment::{Instance, Results, Run};
use crate::reorientation::any::AnyReorientation;
use crate::reorientation::motion::Motion;
use crate::reorientation::sampling::Sampling;
use crate::reorientation::subject::{DURATION, LARGEST_TURN, RESIDUAL, TaskSubject};

/// The best motion of an instance.
#[derive(Debug)]
pub(crate) struct BestMotion<'a> {
    pub(crate) run: &'a Run,
    pub(crate) instance: &'a Instance,
    /// The optimiser's label.
    pub(crate) optimiser: &'a str,
    pub(crate) problem: &'a dyn AnyReorientation,
    pub(crate) coefficients: Vec<f64>,
    /// Error of the base \[°\].
    pub(crate) residual_deg: f64,
    /// Duration \[s\].
    pub(crate) duration: f64,
    /// Largest turn of the base on the way \[°\]; NaN where it was not stored.
    pub(crate) turn_deg: f64,
}

impl BestMotion<'_> {
    /// Sampled.
    pub(crate) fn sample(&self, sampling: impl Into<Sampling>) -> Motion {
        self.problem.sample_at(&self.coefficients, self.duration, sampling.into())
    }
}

/// The best motion of every instance that has one, in the order of the plan.
pub(crate) fn best_motions<'a>(results: &Results<'a>) -> Vec<BestMotion<'a>> {
    let motion = |run: &'a Run| {
        let instance = results.instance(run);
        let subject = TaskSubject::of(instance)?;
        Some(BestMotion {
            run,
            instance,
            optimiser: results.label(run),
            problem: subject.reorientation(),
            coefficients: subject.coefficients(&results.space(run), &run.x)?,
            residual_deg: results.measure(run, RESIDUAL),
            duration: results.measure(run, DURATION),
            turn_deg: results.measure(run, LARGEST_TURN),
        })
    };
    results.best_runs_with_points().into_iter().filter_map(motion).collect()
}
