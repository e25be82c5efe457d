//! Plans the motion of one task: what is searched, from how many starts, and once more where the goal was missed.

mod branches;
mod closing;
mod drifting;
mod mission;
mod moving;
mod planned;
mod remark;
mod walls;

use std::num::NonZeroUsize;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

pub use mission::{LegMotion, MissionJson, PlannedLeg, PlannedMission};
pub use planned::{Asked, OtherFamily, Planned, PlannedJson, Spent};
pub use remark::Remark;
use toml::Spanned;
pub use walls::Walls;

use super::accuracy::Accuracy;
use super::any::SearchedFamily;
use super::boxes::Boxes;
use super::family::FamilyName;
use super::fitness::Reorientation;
use super::formulation::{Formulated, Formulation};
use super::reach::Reach;
use super::settings::{TaskFile, TaskProblem, TrajectoryTable};
use super::spline_box::SplineBox;
use crate::input::{Document, InputError};
use crate::optimiser::{Optimiser, Scp, Settings};
use crate::search::{Failure, Oracle, Problem as _, Rng, Stop, Watch};
use crate::task::{Mission, Task};
use crate::trajectory::Spline;

/// Starts that `scp` follows over splines.
const SPLINE_STARTS: usize = 20;

/// Share of J that `scp` is content to miss there.
const SPLINE_TOLERANCE: f64 = 1e-6;

/// A share of J that peaks between the places of a search may add to it, and by how much finer it first goes on where they add more.
const PASSED_OVER: f64 = 1e-5;
const FINER: usize = 4;

/// How often more starts are followed where no motion reaches the goal, and by how much less time weighs each time.
const MORE_ROUNDS: u64 = 2;
const LESS_TIME: f64 = 100.0;

/// Starts among the paper's family, to compare.
const OTHER_STARTS: usize = 12;

/// Which motions are searched, instead of those that a file says.
#[derive(Debug, Clone, Copy, Default)]
pub struct FamilyChoice {
    /// The family.
    pub family: Option<FamilyName>,
    /// Pieces of a spline.
    pub pieces: Option<usize>,
    /// Degree of a spline.
    pub degree: Option<usize>,
}

impl FamilyChoice {
    /// What a file says of the family, with what is chosen instead; where neither names one, splines if `is_spline`. An error names
    /// the choice that is for splines alone.
    pub fn over(
        &self,
        mut table: TrajectoryTable,
        is_spline: bool,
    ) -> Result<TrajectoryTable, &'static str> {
        if is_spline || self.pieces.is_some() || self.degree.is_some() {
            table = table.planned();
        }
        if let Some(family) = self.family {
            table = table.with_family(family);
        }
        if let Some(pieces) = self.pieces {
            table = table.with_pieces(Spanned::new(0..0, pieces));
        }
        if let Some(degree) = self.degree {
            table = table.with_degree(Spanned::new(0..0, degree));
        }
        let choices = [("pieces", self.pieces.is_some()), ("degree", self.degree.is_some())];
        match choices.into_iter().find(|(_, is_given)| *is_given) {
            Some((choice, _)) if table.family() != FamilyName::Spline => Err(choice),
            _ => Ok(table),
        }
    }
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The file cannot be used.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A choice that is for splines alone.
    #[error("found `{0}`, which is for splines alone")]
    ForSplines(&'static str),
    /// The search could not begin or go on.
    #[error("the search failed: {0}")]
    Search(#[from] Failure),
    /// The user ended the search before it had found anything.
    #[error("interrupted: no motion was found before")]
    Interrupted,
    /// Nothing came of it.
    #[error("no motion found: no evaluation gave a finite cost")]
    NoMotion,
    /// The task takes several motions.
    #[error("this is a task of several motions, expected one of a single motion")]
    Several,
}

/// A task to plan, and the optimiser that does it.
#[derive(Debug, Clone)]
pub struct Planner {
    document: Document,
    file: TaskFile,
    problem: TaskProblem,
    /// The task over the paper's family, where nobody asked for a family.
    other: Option<TaskProblem>,
    optimiser: Settings,
    /// Of a task of several motions all of them; then `problem` is that from the start to the goal.
    mission: Option<Arc<Mission>>,
    /// Whether the tool's goal moves and the file does not say when it is met.
    is_met_sometime: bool,
}

impl Planner {
    /// Reads a task. `scp` searches splines unless file or choice say otherwise; others get nowhere among hundreds of variables.
    pub fn read(
        document: &Document,
        choice: FamilyChoice,
        optimiser: Settings,
    ) -> Result<Self, PlanError> {
        let TaskFile { task, trajectory } = TaskFile::read(document)?;
        let is_named = choice.family.is_some() || trajectory.states_family();
        let is_spline = matches!(optimiser, Settings::Scp(_));
        let trajectory = choice.over(trajectory, is_spline).map_err(PlanError::ForSplines)?;
        let is_met_sometime = task.moves() && !task.states_least_duration();
        let task = if is_met_sometime { moving::reachable(task, document)? } else { task };
        let file = TaskFile { task, trajectory };
        let is_mission = file.task.is_mission();
        let mission = is_mission.then(|| file.task.mission(document)).transpose()?.map(Arc::new);
        let problem = match &mission {
            None => file.problem(document)?,
            Some(mission) => file.trajectory.build(Arc::new(mission.ends.clone()), document)?,
        };
        let other = match &problem {
            TaskProblem::Spline(problem, _) if !is_named => {
                Some(file.few_terms(problem.task().clone(), document)?)
            }
            _ => None,
        };
        Ok(Self {
            document: document.clone(),
            file,
            problem,
            other,
            optimiser,
            mission,
            is_met_sometime,
        })
    }

    /// At how many places the robot comes to rest in a task of several motions.
    pub fn stops(&self) -> usize {
        self.mission.as_ref().map_or(1, |mission| mission.stops())
    }

    /// Whether the task takes several motions.
    pub fn is_mission(&self) -> bool {
        self.mission.is_some()
    }

    /// Whether the robot's load changes on the way.
    pub fn changes_load(&self) -> bool {
        self.mission.as_ref().is_some_and(|mission| mission.load_change().is_some())
    }

    /// The task; of one of several motions from its start to its goal.
    pub fn task(&self) -> &Arc<Task> {
        self.problem.task()
    }

    /// The file, with the family that is searched.
    pub fn file(&self) -> &TaskFile {
        &self.file
    }

    /// Searches, by at most `budget` evaluations. Where the goal is the tool's, the motion ends in whichever of its branches is best
    /// by a first look, and in the next one where it does not reach that. Of a task of several motions see
    /// [`plan_mission`](Self::plan_mission).
    pub fn plan(&self, seed: u64, budget: u64, watch: &Watch) -> Result<Planned, PlanError> {
        if self.is_mission() {
            return Err(PlanError::Several);
        }
        let search = Search { seed, budget, watch };
        if self.is_met_sometime { self.meeting(search) } else { self.plan_once(search) }
    }

    /// Where the goal is the tool's, to the best of its branches.
    fn plan_once(&self, search: Search<'_>) -> Result<Planned, PlanError> {
        match &self.task().tool {
            Some(tool) if tool.branches.len() > 1 => {
                let tasks = tool.branches.iter().map(|joints| self.task().ending_with(joints));
                Ok(self.plan_one_of(tasks.collect(), search)?.1)
            }
            _ => self.waiting(self.search(search)?, search),
        }
    }

    fn search(&self, search: Search<'_>) -> Result<Planned, PlanError> {
        match &self.problem {
            TaskProblem::SinePolynomial(problem, boxes) => {
                // Default settings name no formulation.
                let formulation = Formulation::named(self.optimiser.formulation());
                let formulation = formulation.unwrap_or(Formulation::TimeFree);
                let problem = Arc::new(problem.clone());
                let formulated = Formulated::new(formulation, problem, boxes);
                let formulated = formulated.map_err(|error| self.refused(&error))?;
                search.sines(self.optimiser.optimiser(), &formulated, boxes)
            }
            TaskProblem::Spline(problem, boxes) => {
                let (found, other) = rayon::join(
                    || self.search_splines(problem, boxes, search),
                    || self.other.as_ref().and_then(|other| search.other_family(other)),
                );
                let found = found?;
                let other = other.filter(|_| !found.interrupted);
                Ok(Planned { other, ..found })
            }
        }
    }

    /// Searches splines; where none reaches the goal and one may, again from other starts and with the goal weighing more.
    fn search_splines(
        &self,
        problem: &Reorientation<Spline>,
        boxes: &SplineBox,
        search: Search<'_>,
    ) -> Result<Planned, PlanError> {
        let settings = match &self.optimiser {
            Settings::Scp(scp) => Settings::Scp(Scp {
                starts: NonZeroUsize::new(SPLINE_STARTS),
                tolerance: SPLINE_TOLERANCE,
                ..scp.clone()
            }),
            other => other.clone(),
        };
        let free_form = |task: Reorientation<Spline>| {
            Formulated::free_form(Arc::new(task)).map_err(|error| self.refused(&error))
        };
        let (optimiser, longest) = (settings.optimiser(), boxes.duration[1]);
        let own = free_form(problem.clone())?;
        let round = |search: Search<'_>, task: Reorientation<Spline>| {
            let [finer, fine] = finer(task.accuracy()).map(|a| free_form(task.with_accuracy(a)));
            let [searched, finer, fine] = [free_form(task)?, finer?, fine?];
            let mut found = search.best(optimiser, &searched, &own, longest)?;
            if let Settings::Scp(scp) = &settings {
                for [last, next] in [[&searched, &finer], [&finer, &fine]] {
                    if !is_passed_over(&found.coefficients, last, &fine)? {
                        break;
                    }
                    found = search.onward(scp, found, next, &own, longest)?;
                }
            }
            Ok::<_, PlanError>(found)
        };
        let mut found = round(search, problem.clone())?;
        // The longer motions are, the less their time may weigh if the goal is to count.
        let own_weight = 1.0 - problem.task().base_weight;
        let mut time_weight = own_weight.min(1.0 / found.assessment.duration);
        for number in 1..=MORE_ROUNDS {
            let left = search.budget.saturating_sub(found.spent.evaluations);
            if found.reach != Reach::NotFound || found.interrupted || left == 0 {
                break;
            }
            time_weight /= LESS_TIME;
            let task = Task { base_weight: 1.0 - time_weight, ..(**problem.task()).clone() };
            let (family, accuracy) = (problem.family().clone(), problem.accuracy());
            let demanding = Reorientation::over(Arc::new(task), family, accuracy);
            let seed = search.seed.wrapping_add(number);
            found = found.or(round(Search { seed, budget: left, ..search }, demanding)?);
        }
        Ok(found)
    }

    fn refused(&self, error: &dyn std::error::Error) -> InputError {
        self.document.error_at(0..0, error, None)
    }
}

/// How finely a motion is evaluated that goes on with what a search passed over: first somewhat, then as it is judged.
fn finer(Accuracy { attitude_steps, peak_intervals }: Accuracy) -> [Accuracy; 2] {
    [Accuracy { attitude_steps: FINER * attitude_steps, peak_intervals }, Accuracy::FINE]
}

/// Whether a motion costs more the finer it is evaluated: on the way there are peaks between the places that a search looks at.
fn is_passed_over(
    coefficients: &[f64],
    searched: &Formulated<Spline>,
    fine: &Formulated<Spline>,
) -> Result<bool, Failure> {
    let [searched, fine] = [searched, fine].map(|problem| problem.evaluate(coefficients));
    Ok(fine?.cost > (1.0 + PASSED_OVER) * searched?.cost)
}

/// Follows one start.
struct Onward<'a> {
    scp: Scp,
    start: &'a [f64],
}

impl Optimiser for Onward<'_> {
    fn minimise(&self, oracle: &mut Oracle<'_>, _: &mut Rng) -> Result<(), Stop> {
        self.scp.follow(oracle, self.start).map(drop)
    }
}

/// One search for the best motion.
#[derive(Debug, Clone, Copy)]
pub struct Search<'a> {
    /// The seed of the random numbers.
    pub seed: u64,
    /// Evaluations to spend at most.
    pub budget: u64,
    /// Who watches.
    pub watch: &'a Watch,
}

impl Search<'_> {
    /// Has an optimiser search once; `problem`, of which `searched` may be one with other weights, judges what it finds, and motions
    /// of up to `longest` \[s\] are those that were searched.
    pub fn best<F: SearchedFamily>(
        self,
        optimiser: &dyn Optimiser,
        searched: &Formulated<F>,
        problem: &Formulated<F>,
        longest: f64,
    ) -> Result<Planned, PlanError> {
        let mut oracle = Oracle::new(searched, self.budget, self.watch).parallel();
        let started = Instant::now();
        let stop = optimiser.minimise(&mut oracle, &mut Rng::new(self.seed));
        let seconds = started.elapsed().as_secs_f64();
        let interrupted = stop == Err(Stop::Interrupted);
        let failure = if let Err(Stop::Failed(failure)) = stop { Some(failure) } else { None };
        let Some(best) = oracle.best().cloned() else {
            return Err(match failure {
                Some(failure) => failure.into(),
                None if interrupted => PlanError::Interrupted,
                None if oracle.evaluations() == 0 => Failure::new("no cost was asked for").into(),
                None => PlanError::NoMotion,
            });
        };
        let (coefficients, assessment) = closing::closed(problem, &best.x);
        if !assessment.cost.is_finite() || !assessment.duration.is_finite() {
            return Err(PlanError::NoMotion);
        }
        Ok(Planned {
            reach: Reach::of(problem.task().task(), &assessment, longest),
            spent: Spent::by(&oracle, seconds),
            problem: Arc::new(problem.task().clone()),
            coefficients,
            assessment,
            walls: None,
            interrupted,
            failure,
            other: None,
            excursions: OnceLock::new(),
        })
    }

    /// Goes on from what was found, with the same task evaluated more finely.
    fn onward(
        self,
        scp: &Scp,
        found: Planned,
        finer: &Formulated<Spline>,
        problem: &Formulated<Spline>,
        longest: f64,
    ) -> Result<Planned, PlanError> {
        let budget = self.budget.saturating_sub(found.spent.evaluations);
        if found.interrupted || budget == 0 {
            return Ok(found);
        }
        let scp = Scp { first_weight: f64::INFINITY, tolerance: PASSED_OVER, ..scp.clone() };
        let onward = Onward { scp, start: &found.coefficients };
        match (Search { budget, ..self }).best(&onward, finer, problem, longest) {
            Err(PlanError::Interrupted) => Ok(Planned { interrupted: true, ..found }),
            more => {
                let more = more?;
                Ok(Planned { spent: found.spent.and(more.spent), ..more })
            }
        }
    }

    /// The same among sine polynomials, whose box is a choice.
    pub fn sines(
        self,
        optimiser: &dyn Optimiser,
        problem: &Formulated,
        boxes: &Boxes,
    ) -> Result<Planned, PlanError> {
        let found = self.best(optimiser, problem, problem, boxes.duration[1])?;
        let walls = Walls::of(problem, &found.coefficients, found.assessment.duration);
        Ok(Planned { walls: Some(walls), ..found })
    }

    /// The best motion of the paper's family that `scp` finds from so many starts.
    fn few_terms(self, problem: &TaskProblem, starts: usize) -> Option<Planned> {
        let TaskProblem::SinePolynomial(problem, boxes) = problem else { return None };
        let formulated =
            Formulated::new(Formulation::TimeFree, Arc::new(problem.clone()), boxes).ok()?;
        let scp = Scp { starts: NonZeroUsize::new(starts), ..Scp::default() };
        self.best(&scp, &formulated, &formulated, boxes.duration[1]).ok()
    }

    /// What the paper's family comes to, if it comes to anything.
    fn other_family(self, problem: &TaskProblem) -> Option<OtherFamily> {
        let found = self.few_terms(problem, OTHER_STARTS)?;
        (!found.interrupted).then(|| OtherFamily {
            terms: found.problem.spec().terms().unwrap_or_default(),
            t_f: found.assessment.duration,
            residual_deg: found.assessment.residual().to_degrees(),
            status: found.reach,
        })
    }
}
