//! The reorientation task as a subject of experiments.

use std::fmt::Debug;
use std::sync::Arc;

use super::any::{AnyReorientation, SearchedFamily};
use super::best_known::BestKnown;
use super::fitness::{Assessment, Reorientation};
use super::formulation::{Formulated, Formulation};
use super::settings::TaskProblem;
use crate::experiment::Instance;
use crate::lanes::Width;
use crate::search::{Failure, Problem};

/// The name of the kind.
pub(super) const KIND: &str = "reorientation";

/// The names of the formulations, the preferred one first.
pub(super) const SPACES: [&str; 3] =
    [Formulation::TimeFree.name(), Formulation::Scaled.name(), Formulation::Raw.name()];

/// Costs of motions that differ by less than this share are the same: that is how far searches go.
pub(super) const SAME_MOTION: f64 = 1e-6;

/// Targets where none are stated: by which shares they exceed the best known cost.
const GAPS: [f64; 3] = [0.1, 0.01, 0.001];

/// Names of measures: the base's error, the duration, the base's largest turn on the way.
pub(super) const RESIDUAL: &str = "residual_deg";
pub(super) const DURATION: &str = "t_f";
pub(super) const LARGEST_TURN: &str = "largest_base_turn_deg";

/// The task within a box of its family.
#[derive(Debug)]
pub struct TaskSubject {
    within: Arc<dyn Searched>,
}

impl TaskSubject {
    /// The task over its family, to be searched in these boxes.
    pub fn new<F: SearchedFamily>(problem: Arc<Reorientation<F>>, boxes: F::Boxes) -> Self {
        Self { within: Arc::new(Within { problem, boxes }) }
    }

    /// The subject of an instance, where it is a task.
    pub fn of(instance: &Instance) -> Option<&Self> {
        instance.subject.as_any()?.downcast_ref()
    }

    /// An instance on it, with targets where its best cost is known.
    pub fn into_instance(self, label: impl Into<String>) -> Instance {
        let known = BestKnown::of(self.reorientation());
        let targets = known.into_iter().flat_map(|known| GAPS.map(|gap| known.target(gap)));
        let targets: Vec<f64> = targets.collect();
        Instance::new(label, Arc::new(self)).with_targets(targets)
    }

    /// The task over its family.
    pub fn reorientation(&self) -> &dyn AnyReorientation {
        self.within.problem()
    }

    /// The same, evaluated with so many lanes; see [`Reorientation::with_width`].
    #[must_use]
    pub fn with_width(&self, width: Width) -> Self {
        Self { within: self.within.with_width(width) }
    }

    pub(super) fn formulated(&self, space: &str) -> Result<Arc<dyn Searchable>, Failure> {
        let formulation = Formulation::named(Some(space))
            .ok_or_else(|| Failure::new(format!("the task has no formulation `{space}`")))?;
        self.within.formulated(formulation)
    }

    /// The coefficients of a point.
    pub fn coefficients(&self, space: &str, x: &[f64]) -> Option<Vec<f64>> {
        let formulated = self.formulated(space).ok()?;
        (x.len() == formulated.bounds().len()).then(|| formulated.coefficients(x))
    }

    pub(super) fn formulations(&self) -> &'static [Formulation] {
        self.within.formulations()
    }

    pub(super) fn box_identity(&self) -> serde_json::Value {
        self.within.box_identity()
    }
}

impl From<TaskProblem> for TaskSubject {
    fn from(problem: TaskProblem) -> Self {
        match problem {
            TaskProblem::SinePolynomial(problem, boxes) => Self::new(Arc::new(problem), boxes),
            TaskProblem::Spline(problem, boxes) => Self::new(Arc::new(problem), boxes),
        }
    }
}

/// The task in one of its formulations, over whichever family.
pub(super) trait Searchable: Problem {
    /// The coefficients of a point.
    fn coefficients(&self, x: &[f64]) -> Vec<f64>;

    /// The motion of a point, evaluated finely: its coefficients and what is known of it.
    fn certify(&self, x: &[f64]) -> (Vec<f64>, Assessment);
}

impl<F: SearchedFamily> Searchable for Formulated<F> {
    fn coefficients(&self, x: &[f64]) -> Vec<f64> {
        self.decode(x).0
    }

    fn certify(&self, x: &[f64]) -> (Vec<f64>, Assessment) {
        self.certify(x)
    }
}

/// The task within a box, over whichever family.
trait Searched: Debug + Send + Sync {
    fn problem(&self) -> &dyn AnyReorientation;
    fn with_width(&self, width: Width) -> Arc<dyn Searched>;
    fn formulations(&self) -> &'static [Formulation];
    fn formulated(&self, formulation: Formulation) -> Result<Arc<dyn Searchable>, Failure>;
    fn box_identity(&self) -> serde_json::Value;
}

#[derive(Debug)]
struct Within<F: SearchedFamily> {
    problem: Arc<Reorientation<F>>,
    boxes: F::Boxes,
}

impl<F: SearchedFamily> Searched for Within<F> {
    fn problem(&self) -> &dyn AnyReorientation {
        &*self.problem
    }

    fn with_width(&self, width: Width) -> Arc<dyn Searched> {
        let problem = Arc::new(self.problem.with_width(width));
        Arc::new(Self { problem, boxes: self.boxes.clone() })
    }

    fn formulations(&self) -> &'static [Formulation] {
        F::FORMULATIONS
    }

    fn formulated(&self, formulation: Formulation) -> Result<Arc<dyn Searchable>, Failure> {
        Ok(Arc::new(F::formulated(formulation, self.problem.clone(), &self.boxes)?))
    }

    fn box_identity(&self) -> serde_json::Value {
        F::box_identity(&self.boxes)
    }
}
