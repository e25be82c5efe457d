//! What `plan` found.

use std::fmt::{self, Write as _};

use serde::Serialize;

use super::motion::{AssessmentJson, ExcursionsJson, ShapeJson, Told, excursions};
use super::walls::Walls;
use crate::reorientation::{
    Assessment, BestKnown, Block, Excursions, FamilyName, FamilySpec, Formulated, Reach,
    SearchedFamily,
};
use crate::search::Failure;
use crate::trajectory::{Family, SinePolynomial};

/// What a search spent.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Spent {
    pub(super) evaluations: u64,
    pub(super) linearisations: u64,
    pub(super) curvatures: u64,
    pub(super) conic_solves: u64,
    pub(super) seconds: f64,
}

/// What the search came to.
pub(super) struct Found<F: Family> {
    pub(super) problem: Formulated<F>,
    pub(super) coefficients: Vec<f64>,
    pub(super) assessment: Assessment,
    pub(super) reach: Reach,
    /// Of families whose box is a choice.
    pub(super) walls: Option<Walls>,
    pub(super) spent: Spent,
    pub(super) interrupted: bool,
    /// Why the search ended early.
    pub(super) failure: Option<Failure>,
}

/// The best motion of the paper's family.
#[derive(Debug, Serialize)]
pub(super) struct OtherFamily {
    terms: usize,
    t_f: f64,
    residual_deg: f64,
    status: Reach,
}

#[derive(Debug, Serialize)]
pub(super) struct PlanJson<'a> {
    task: String,
    /// Keys of the task that are the paper's.
    inherited: Vec<&'static str>,
    optimiser: &'a str,
    seed: u64,
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
    sine_polynomial: Option<OtherFamily>,
    interrupted: bool,
    #[serde(flatten)]
    spent: Spent,
    lanes: usize,
}

impl OtherFamily {
    pub(super) fn new(terms: usize, found: &Found<SinePolynomial>) -> Self {
        Self {
            terms,
            t_f: found.assessment.duration,
            residual_deg: found.assessment.residual().to_degrees(),
            status: found.reach,
        }
    }
}

impl fmt::Display for OtherFamily {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { terms, t_f, residual_deg, status } = self;
        write!(f, "sine polynomials with {terms} terms: ")?;
        match status {
            Reach::Reached => write!(f, "{t_f:.6} s"),
            _ => write!(f, "none found that reaches the goal ({residual_deg:.3}° off)"),
        }
    }
}

impl<F: SearchedFamily> Found<F> {
    /// The other one where it reaches the goal or ends nearer to it; has spent what both have.
    pub(super) fn or(self, other: Self) -> Self {
        let [own, more] = [self.spent, other.spent];
        let spent = Spent {
            evaluations: own.evaluations + more.evaluations,
            linearisations: own.linearisations + more.linearisations,
            curvatures: own.curvatures + more.curvatures,
            conic_solves: own.conic_solves + more.conic_solves,
            seconds: own.seconds + more.seconds,
        };
        let interrupted = self.interrupted || other.interrupted;
        let failure = other.failure.clone().or(self.failure.clone());
        let is_better = other.reach == Reach::Reached
            || other.assessment.residual() < self.assessment.residual();
        let found = if is_better { other } else { self };
        Self { spent, interrupted, failure, ..found }
    }

    pub(super) fn json<'a>(
        &self,
        task: String,
        optimiser: &'a str,
        seed: u64,
        inherited: Vec<&'static str>,
        known: Option<&BestKnown>,
        other: Option<OtherFamily>,
    ) -> PlanJson<'a> {
        let problem = self.problem.task();
        PlanJson {
            task,
            inherited,
            optimiser,
            seed,
            family: problem.family().spec(),
            status: self.reach,
            reached: self.reach == Reach::Reached,
            within_limits: Reach::keeps_limits(&self.assessment),
            tolerance_deg: problem.task().goal_tolerance_deg(),
            least_time: self.reach.least_time(),
            on_walls: self.walls.as_ref().map(Walls::names),
            best_known_j: known.map(|known| known.j),
            assessment: (&self.assessment).into(),
            excursions: ExcursionsJson::new(&self.excursions(), problem.task()),
            shape: ShapeJson::new(problem, &self.coefficients, self.assessment.duration),
            sine_polynomial: other,
            interrupted: self.interrupted,
            spent: self.spent,
            lanes: problem.width().lanes(),
        }
    }

    /// For people.
    pub(super) fn told(&self, known: Option<&BestKnown>, other: Option<OtherFamily>) -> String {
        let task = self.problem.task().task();
        let mut text = match self.problem.task().family().spec() {
            FamilySpec::SinePolynomial { terms } => {
                format!("  family         sine polynomials with {terms} terms\n")
            }
            FamilySpec::Spline { pieces, degree } => {
                format!("  family         splines of degree {degree} with {pieces} pieces\n")
            }
        };
        let excursions = self.excursions();
        let told = Told { task, assessment: &self.assessment, excursions: &excursions };
        let _ = writeln!(text, "{told}");
        let _ = writeln!(text, "  verdict        {}", self.verdict());
        let _ =
            writeln!(text, "  not checked    collisions, torques, flexible parts; see the README");
        if let Some(known) = known {
            let _ =
                writeln!(text, "  this J         {}", known.compared_with(self.assessment.cost));
        }
        if let Some(other) = other {
            let _ = writeln!(text, "  in comparison  {other}");
        }
        let Spent { evaluations, seconds, .. } = self.spent;
        let s = if evaluations == 1 { "" } else { "s" };
        let _ = write!(text, "  {evaluations} evaluation{s} in {seconds:.2} s");
        text
    }

    fn excursions(&self) -> Excursions {
        excursions(self.problem.task(), &self.coefficients, self.assessment.duration)
    }

    /// Whether the goal is reached, and limits are kept.
    pub(super) fn verdict(&self) -> String {
        let task = self.problem.task().task();
        let is_there = self.assessment.is_within(task.goal_tolerance);
        let goal = if is_there { "reaches" } else { "misses" };
        let limits = if Reach::keeps_limits(&self.assessment) { "keeps" } else { "does not keep" };
        format!(
            "{goal} the goal (within {}°), {limits} all limits and ranges",
            task.goal_tolerance_deg()
        )
    }

    /// Warns where the goal is missed; says which variables are on walls of the box, where that may matter.
    pub(super) fn warn(&self, budget: u64) {
        let task = self.problem.task();
        let residual = self.assessment.residual().to_degrees();
        if matches!(self.reach, Reach::Reached | Reach::NotFound) {
            let missed_by = (self.reach != Reach::Reached).then_some(residual);
            if let Some(told) = self.walls.as_ref().and_then(|walls| walls.told(missed_by)) {
                note!("{told}");
                return;
            }
        }
        let why = match self.reach {
            Reach::Reached => return,
            Reach::Blocked(Block::NoTurn) => {
                "and no motion brings it nearer: the joints do not turn the base".to_owned()
            }
            Reach::Blocked(Block::Holonomic) => {
                "and no motion brings it nearer: where the base ends follows from where the joints end, however they go there"
                    .to_owned()
            }
            Reach::Blocked(Block::OneAxis) => {
                "and no motion reaches it: all joints turn the base about the same axis, and the goal is a turn about another"
                    .to_owned()
            }
            Reach::TooSlow(seconds) => format!(
                "which needs about {seconds:.0} s or more, longer than motions that are searched: joints at their largest rates do \
                 not turn the base faster"
            ),
            Reach::NotFound if self.interrupted => return,
            // Of a search that was cut off it is not known where it would have ended.
            Reach::NotFound
                if task.family().spec().name() == FamilyName::SinePolynomial
                    && self.spent.evaluations < budget
                    && task.is_held_by_time(&self.coefficients) =>
            {
                format!(
                    "because reaching it costs more time than its weight is worth. Raise `weights.base` above {}, or use \
                     `--family spline`, which always asks for the goal",
                    task.task().base_weight
                )
            }
            Reach::NotFound => {
                let advice = match task.family().spec().name() {
                    _ if self.spent.evaluations >= budget => "a larger `--budget` may find one",
                    FamilyName::Spline => "another `--seed` or more `--pieces` may find one",
                    FamilyName::SinePolynomial => {
                        "`--family spline`, more terms or another optimiser, such as a hybrid, may find one"
                    }
                };
                let missed = if self.assessment.residual_error.is_none_or(f64::is_infinite) {
                    "as far as can be told: the motion swings too often to be evaluated reliably, and no other was found"
                } else if !self.assessment.is_within(task.task().goal_tolerance) {
                    "and no motion was found that reaches it"
                } else {
                    "but beyond limits or ranges, and no motion was found that keeps them"
                };
                format!("{missed}; {advice}")
            }
        };
        let digits =
            if residual < 1e-3 { format!("{residual:.1e}") } else { format!("{residual:.6}") };
        note!("warning: the base ends {digits}° from its goal, {why}");
    }
}
