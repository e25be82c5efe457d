//! The reorientation task as a subject of experiments.

use std::sync::Arc;

use super::fitness::Reorientation;
use super::formulation::{Formulated, Formulation};
use super::settings::Boxes;
use crate::experiment::Instance;
use crate::lanes::Width;
use crate::search::{Failure, Problem as _};

/// The name of the kind.
pub(super) const KIND: &str = "reorientation";

/// The names of the formulations, the preferred one first.
pub(super) const SPACES: [&str; 3] =
    [Formulation::TimeFree.name(), Formulation::Scaled.name(), Formulation::Raw.name()];

/// Costs of motions that differ by less than this share are the same: that is how far searches go.
pub(super) const SAME_MOTION: f64 = 1e-6;

/// Names of measures: the base's error, the duration.
pub(super) const RESIDUAL: &str = "residual_deg";
pub(super) const DURATION: &str = "t_f";

/// The task within its boxes.
#[derive(Debug)]
pub struct TaskSubject {
    pub(super) problem: Arc<Reorientation>,
    pub(super) boxes: Boxes,
}

impl TaskSubject {
    /// The task over its family, to be searched in these boxes.
    pub fn new(problem: Arc<Reorientation>, boxes: Boxes) -> Self {
        Self { problem, boxes }
    }

    /// The subject of an instance, where it is a task.
    pub fn of(instance: &Instance) -> Option<&Self> {
        instance.subject.as_any()?.downcast_ref()
    }

    /// The task over its family.
    pub fn reorientation(&self) -> &Reorientation {
        &self.problem
    }

    /// The same, evaluated with so many lanes; see [`Reorientation::with_width`].
    #[must_use]
    pub fn with_width(&self, width: Width) -> Self {
        Self { problem: Arc::new(self.problem.with_width(width)), boxes: self.boxes.clone() }
    }

    pub(super) fn formulated(&self, space: &str) -> Result<Formulated, Failure> {
        let formulation = Formulation::named(Some(space))
            .ok_or_else(|| Failure::new(format!("the task has no formulation `{space}`")))?;
        Formulated::new(formulation, self.problem.clone(), &self.boxes)
            .map_err(|error| Failure::new(error.to_string()))
    }

    /// The coefficients of a point.
    pub fn coefficients(&self, space: &str, x: &[f64]) -> Option<Vec<f64>> {
        let formulated = self.formulated(space).ok()?;
        (x.len() == formulated.bounds().len()).then(|| formulated.decode(x).0)
    }
}
