//! What a plan has come to.

use std::sync::{Arc, OnceLock};

use serde::Serialize;

use super::walls::Walls;
use crate::reorientation::any::AnyReorientation;
use crate::reorientation::best_known::BestKnown;
use crate::reorientation::excursions::Excursions;
use crate::reorientation::family::FamilySpec;
use crate::reorientation::fitness::Assessment;
use crate::reorientation::json::{AssessmentJson, ExcursionsJson, ShapeJson};
use crate::reorientation::reach::Reach;
use crate::reorientation::robustness::{Robustness, RobustnessJson};
use crate::search::{Failure, Oracle};

/// What a search spent.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Spent {
    /// Costs that were asked for.
    pub evaluations: u64,
    /// Those of them with first derivatives.
    pub linearisations: u64,
    /// Second derivatives.
    pub curvatures: u64,
    /// Conic subproblems.
    pub conic_solves: u64,
    /// Wall time \[s\].
    pub seconds: f64,
}

impl Spent {
    pub(super) fn by(oracle: &Oracle<'_>, seconds: f64) -> Self {
        Self {
            evaluations: oracle.evaluations(),
            linearisations: oracle.linearisations(),
            curvatures: oracle.curvatures(),
            conic_solves: oracle.conic_solves(),
            seconds,
        }
    }

    pub(super) fn and(self, more: Self) -> Self {
        Self {
            evaluations: self.evaluations + more.evaluations,
            linearisations: self.linearisations + more.linearisations,
            curvatures: self.curvatures + more.curvatures,
            conic_solves: self.conic_solves + more.conic_solves,
            seconds: self.seconds + more.seconds,
        }
    }
}

/// The best motion that was found, and how it stands to its goal.
#[derive(Debug, Clone)]
pub struct Planned {
    /// The task over the family that was searched.
    pub problem: Arc<dyn AnyReorientation>,
    /// The motion's coefficients.
    pub coefficients: Vec<f64>,
    /// What is known of it.
    pub assessment: Assessment,
    /// Whether it reaches its goal.
    pub reach: Reach,
    /// Of families whose box is a choice: which walls the motion touches.
    pub walls: Option<Walls>,
    /// What that took.
    pub spent: Spent,
    /// Whether the user ended the search.
    pub interrupted: bool,
    /// Why the search ended early.
    pub failure: Option<Failure>,
    /// What the paper's family comes to, where that was searched for comparison.
    pub other: Option<OtherFamily>,
    /// What happens on the way, once that was asked for.
    pub(super) excursions: OnceLock<Excursions>,
}

/// The best motion of the paper's family.
#[derive(Debug, Clone, Serialize)]
pub struct OtherFamily {
    /// Free coefficients per joint.
    pub terms: usize,
    /// Duration \[s\].
    pub t_f: f64,
    /// How far the base ends from its goal \[°\].
    pub residual_deg: f64,
    /// Whether it reaches its goal.
    pub status: Reach,
}

/// What was asked for, for [`Planned::json`].
#[derive(Debug, Clone, Serialize)]
pub struct Asked<'a> {
    /// The task's file.
    pub task: String,
    /// Keys of the task that its file leaves out.
    pub inherited: Vec<&'static str>,
    /// The optimiser.
    pub optimiser: &'a str,
    /// The seed of the random numbers.
    pub seed: u64,
}

/// The object that `plan --json` prints.
#[derive(Debug, Serialize)]
pub struct PlannedJson<'a> {
    #[serde(flatten)]
    asked: Asked<'a>,
    #[serde(flatten)]
    family: FamilySpec,
    status: Reach,
    reached: bool,
    tolerance_deg: f64,
    within_limits: bool,
    least_time: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    on_walls: Option<Vec<String>>,
    best_known_j: Option<f64>,
    #[serde(flatten)]
    assessment: AssessmentJson,
    #[serde(flatten)]
    excursions: ExcursionsJson,
    #[serde(flatten)]
    shape: ShapeJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    uncertainty: Option<RobustnessJson>,
    sine_polynomial: Option<&'a OtherFamily>,
    interrupted: bool,
    #[serde(flatten)]
    spent: Spent,
    lanes: usize,
}

impl Planned {
    /// The better one; has spent what both have.
    pub(super) fn or(self, other: Self) -> Self {
        let spent = self.spent.and(other.spent);
        let interrupted = self.interrupted || other.interrupted;
        let failure = other.failure.clone().or(self.failure.clone());
        let found = if other.is_better_than(&self) { other } else { self };
        Self { spent, interrupted, failure, ..found }
    }

    /// What becomes of it where the robot is not quite what its file says, if the task states how far that may be.
    pub fn robustness(&self) -> Option<Robustness> {
        Robustness::of(&*self.problem, &self.coefficients, self.assessment.duration).ok().flatten()
    }

    /// Whether it reaches its goal, ends nearer to it or, where both are within its tolerance, breaks limits by less.
    pub(super) fn is_better_than(&self, other: &Self) -> bool {
        let miss = |Self { problem, assessment, .. }: &Self| {
            let residual = assessment.residual().max(problem.task().goal_tolerance);
            [residual, assessment.penalty()]
        };
        self.reach == Reach::Reached || miss(self) < miss(other)
    }

    /// As JSON.
    pub fn json<'a>(&'a self, asked: Asked<'a>) -> PlannedJson<'a> {
        let problem = &*self.problem;
        PlannedJson {
            asked,
            family: problem.spec(),
            status: self.reach,
            reached: self.reach == Reach::Reached,
            within_limits: Reach::keeps_limits(&self.assessment),
            tolerance_deg: problem.task().goal_tolerance_deg(),
            least_time: self.reach.least_time(),
            on_walls: self.walls.as_ref().map(Walls::names),
            best_known_j: BestKnown::of(problem).map(|known| known.j),
            assessment: AssessmentJson::new(&self.assessment, &problem.task().robot),
            excursions: ExcursionsJson::new(
                self.excursions(),
                problem.task(),
                &self.assessment.peaks,
            ),
            shape: ShapeJson::new(problem, &self.coefficients, self.assessment.duration),
            uncertainty: self.robustness().map(|own| RobustnessJson::new(&own, problem.task())),
            sine_polynomial: self.other.as_ref(),
            interrupted: self.interrupted,
            spent: self.spent,
            lanes: problem.width().lanes(),
        }
    }

    /// How far base and joints go on the way.
    pub fn excursions(&self) -> &Excursions {
        let duration = self.assessment.duration;
        let follow = || Excursions::on_the_way(&*self.problem, &self.coefficients, duration);
        self.excursions.get_or_init(follow)
    }

    /// Whether the goal is reached, and limits are kept, in words.
    pub fn verdict(&self) -> String {
        let task = self.problem.task();
        let is_there = self.assessment.is_within(task.goal_tolerance);
        let tolerance = task.goal_tolerance_deg();
        let goal = if is_there {
            format!("reaches the goal (within {tolerance}°)")
        } else {
            let residual = self.assessment.residual().to_degrees();
            format!("misses the goal (within {tolerance}°) by {residual:.4}°")
        };
        let limits = if Reach::keeps_limits(&self.assessment) { "keeps" } else { "does not keep" };
        format!("{goal}, {limits} all limits and ranges")
    }
}
