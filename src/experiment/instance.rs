//! What the runs of an experiment minimise.

use std::fmt;
use std::num::NonZeroU64;
use std::sync::Arc;

use super::caught::caught;
use crate::reorientation::{Assessment, BestKnown, Boxes, Formulated, Formulation, Reorientation};
use crate::search::Problem;

/// One problem of an experiment.
#[derive(Debug, Clone)]
pub struct Instance {
    /// What tells it from the others, such as `weight_base=0.5 terms=4`; empty where there is but one.
    pub label: String,
    /// What it shares with those it is summarised and drawn with; the label where there are none.
    pub group: String,
    /// The problem.
    pub subject: Subject,
    /// Evaluations that each run may spend, instead of the experiment's budget.
    pub budget: Option<NonZeroU64>,
    /// Costs that runs are asked to reach.
    pub targets: Vec<f64>,
}

/// The two kinds of problems.
#[derive(Clone)]
pub enum Subject {
    /// The reorientation task, in the variables of each optimiser's formulation.
    Task {
        /// The task over its family.
        problem: Arc<Reorientation>,
        /// Where to search.
        boxes: Boxes,
    },
    /// Any other problem, in its own variables.
    Other {
        /// Together with the instance's label it says which problem this is: a stored run with the
        /// same of both is taken for a run on the same problem.
        name: String,
        /// The problem.
        problem: Arc<dyn Problem + Send + Sync>,
    },
}

impl fmt::Debug for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Subject {
    /// The problem's name.
    pub fn name(&self) -> &str {
        match self {
            Self::Task { .. } => "reorientation",
            Self::Other { name, .. } => name,
        }
    }
}

impl Instance {
    /// The reorientation task.
    pub fn task(label: String, problem: Arc<Reorientation>, boxes: Boxes) -> Self {
        let subject = Subject::Task { problem, boxes };
        Self { group: label.clone(), label, subject, budget: None, targets: Vec::new() }
    }

    /// Any other problem.
    pub fn other(label: &str, name: &str, problem: Arc<dyn Problem + Send + Sync>) -> Self {
        let subject = Subject::Other { name: name.to_owned(), problem };
        let (label, group) = (label.to_owned(), label.to_owned());
        Self { label, group, subject, budget: None, targets: Vec::new() }
    }

    /// Whether this is the reorientation task.
    pub fn is_task(&self) -> bool {
        self.reorientation().is_some()
    }

    /// The reorientation task, if this is one.
    pub fn reorientation(&self) -> Option<&Reorientation> {
        match &self.subject {
            Subject::Task { problem, .. } => Some(problem),
            Subject::Other { .. } => None,
        }
    }

    /// The cost in the middle of the box: on the task, that of the motion without bumps, as fast as the limits
    /// allow. No number where the problem panics there.
    pub fn centre_cost(&self) -> f64 {
        let problem = self.problem(Formulation::TimeFree);
        let centre: Vec<f64> = problem.bounds().iter().map(|[a, b]| a + 0.5 * (b - a)).collect();
        caught(|| problem.evaluate(&centre).cost).unwrap_or(f64::NAN)
    }

    /// The number of variables, whatever the optimiser's formulation, so that formulations of one task
    /// compare: for the task that of the paper's, free coefficients and duration.
    pub fn dimension(&self) -> usize {
        match &self.subject {
            Subject::Task { problem, .. } => problem.family().dimension() + 1,
            Subject::Other { problem, .. } => problem.bounds().len(),
        }
    }

    /// The least cost known: the best motion's for the task, the least of all for a problem that tells it.
    pub fn known_cost(&self) -> Option<f64> {
        match &self.subject {
            Subject::Task { problem, .. } => BestKnown::of(problem).map(|known| known.j),
            Subject::Other { problem, .. } => problem.least_cost(),
        }
    }

    /// The problem as an optimiser with this formulation sees it.
    pub fn problem(&self, formulation: Formulation) -> Arc<dyn Problem + Send + Sync> {
        match &self.subject {
            Subject::Task { problem, boxes } => {
                Arc::new(Formulated::new(formulation, problem.clone(), boxes))
            }
            Subject::Other { problem, .. } => problem.clone(),
        }
    }

    /// The motion that a point stands for, evaluated finely: its coefficients and what is known of
    /// it. A problem that is no task has none.
    pub fn certify(&self, formulation: Formulation, x: &[f64]) -> Option<(Vec<f64>, Assessment)> {
        match &self.subject {
            Subject::Task { problem, boxes } => {
                Some(Formulated::new(formulation, problem.clone(), boxes).certify(x))
            }
            Subject::Other { .. } => None,
        }
    }
}
