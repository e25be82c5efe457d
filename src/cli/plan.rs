//! `driftless plan`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;

use super::check::expect_task;
use super::family::FamilyOptions;
use super::found::{Found, OtherFamily, Spent};
use super::motion::MotionFiles;
use super::progress::Bar;
use super::walls::Walls;
use super::{CliError, read_or, shown, start_worker_threads, warn_of, watch};
use crate::input::{InputError, nearest};
use crate::optimiser::{Optimiser, Scp, Settings};
use crate::reorientation::{
    Accuracy, BestKnown, FamilyName, FamilySpec, Formulated, Formulation, Reach, Reorientation,
    SearchedFamily, TaskFile, TaskProblem,
};
use crate::search::{BoundsError, Failure, Oracle, Rng, Stop};
use crate::task::{Task, TaskTable};
use crate::trajectory::{Family, Spline};

/// Find the best motion for one task
#[derive(Debug, Args)]
pub(super) struct Plan {
    /// Task file; without one, the paper's task
    #[arg(value_name = "TASK.toml")]
    file: Option<PathBuf>,
    /// Optimiser, with its default settings; `driftless list` shows them. Others than `scp` search sine polynomials, of few
    /// variables, unless told otherwise
    #[arg(long, value_name = "NAME", default_value = "scp")]
    optimiser: String,
    #[command(flatten)]
    family: FamilyOptions,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Evaluations to spend
    #[arg(long, value_name = "N", default_value_t = 150_000, value_parser = clap::value_parser!(u64).range(1..))]
    budget: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// End with exit status 3 unless the motion reaches its goal and keeps all limits and ranges
    #[arg(long)]
    require: bool,
    /// Say the motion as an entry for results/best-known.toml, too
    #[arg(long)]
    entry: bool,
    #[command(flatten)]
    files: MotionFiles,
}

/// Starts that `scp` follows over splines.
const SPLINE_STARTS: usize = 20;

/// Share of J that `scp` is content to miss there.
const SPLINE_TOLERANCE: f64 = 1e-6;

/// How often more starts are followed where no motion reaches the goal, and by how much less time weighs each time.
const MORE_ROUNDS: u64 = 2;
const LESS_TIME: f64 = 100.0;

/// Starts among the paper's family, to compare.
const OTHER_STARTS: usize = 12;

/// Says what is doubtful about a task.
pub(super) fn warn_of_task(task: &Task) {
    warn_of(&task.robot);
    if task.base_weight >= 1.0 {
        note!(
            "warning: `weights.base` is 1, so time weighs nothing and the motion is as slow as it happens to be"
        );
    }
}

impl Plan {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_worker_threads()?;
        self.files.check()?;
        let settings = find_optimiser(&self.optimiser)?;
        let document = read_or(self.file.as_deref(), TaskFile::paper)?;
        expect_task(&document, "plan")?;
        let TaskFile { task, trajectory } = TaskFile::read(&document)?;
        let is_named = self.family.is_named() || trajectory.states_family();
        // Other optimisers get nowhere among hundreds of variables.
        let is_spline = matches!(settings, Settings::Scp(_));
        let file = TaskFile { trajectory: self.family.over(trajectory, is_spline)?, task };
        let refused = |error| document.error_at(0..0, error, None);
        let problem = file.problem(&document)?;
        if let Some(residual) = problem.task().already_there() {
            return self.tell_already_there(problem.task(), residual);
        }
        match problem {
            TaskProblem::SinePolynomial(problem, boxes) => {
                warn_of_task(problem.task());
                // Default settings name no formulation.
                let formulation =
                    Formulation::named(settings.formulation()).unwrap_or(Formulation::TimeFree);
                let formulated =
                    Formulated::new(formulation, Arc::new(problem), &boxes).map_err(refused)?;
                let mut found = {
                    let _bar = Bar::new(self.budget, watch());
                    let longest = boxes.duration[1];
                    search(
                        settings.optimiser(),
                        &formulated,
                        &formulated,
                        longest,
                        self.seed,
                        self.budget,
                    )?
                };
                let walls =
                    Walls::of(&found.problem, &found.coefficients, found.assessment.duration);
                found.walls = Some(walls);
                self.finish(&found, None, file.task)
            }
            TaskProblem::Spline(problem, boxes) => {
                warn_of_task(problem.task());
                let table = file.trajectory.with_family(FamilyName::SinePolynomial);
                let sine = (!is_named).then(|| table.build(problem.task().clone(), &document));
                let sine = sine.transpose()?;
                let (found, other) = {
                    let _bar = Bar::new(self.budget, watch());
                    rayon::join(
                        || self.search_splines(&settings, &problem, boxes.duration[1], refused),
                        || sine.and_then(|sine| self.search_other(sine)),
                    )
                };
                let found = found?;
                let other = other.filter(|_| !found.interrupted);
                self.finish(&found, other, file.task)
            }
        }
    }

    /// Says that there is nothing to plan.
    fn tell_already_there(&self, task: &Task, residual: f64) -> Result<(), CliError> {
        self.files.tell_unwritten();
        let (residual_deg, tolerance_deg) = (residual.to_degrees(), task.goal_tolerance_deg());
        if self.json {
            let json = serde_json::json!({
                "task": shown(self.file.as_ref(), "xiao2023"),
                "already_there": true,
                "status": Reach::Reached,
                "reached": true,
                "tolerance_deg": tolerance_deg,
                "within_limits": true,
                "t_f": 0.0,
                "residual_deg": residual_deg,
            });
            say!("{json:#}");
        } else {
            say!(
                "{}: already there: all joints stand at their goals, and the base is {residual_deg:.6}° from its goal (within \
                 {tolerance_deg}°)",
                shown(self.file.as_ref(), "the paper's task")
            );
        }
        Ok(())
    }

    /// Searches splines; where none reaches the goal and one may, again from other starts and with the goal weighing more.
    fn search_splines(
        &self,
        settings: &Settings,
        problem: &Reorientation<Spline>,
        longest: f64,
        refused: impl Fn(BoundsError) -> InputError + Send,
    ) -> Result<Found<Spline>, CliError> {
        let settings = match settings {
            Settings::Scp(scp) => Settings::Scp(Scp {
                starts: NonZeroUsize::new(SPLINE_STARTS),
                tolerance: SPLINE_TOLERANCE,
                ..scp.clone()
            }),
            other => other.clone(),
        };
        let optimiser = settings.optimiser();
        let own = Formulated::free_form(Arc::new(problem.clone())).map_err(&refused)?;
        let mut found = search(optimiser, &own, &own, longest, self.seed, self.budget)?;
        // The longer motions are, the less their time may weigh if the goal is to count.
        let own_weight = 1.0 - problem.task().base_weight;
        let mut time_weight = own_weight.min(1.0 / found.assessment.duration);
        for round in 1..=MORE_ROUNDS {
            let left = self.budget - found.spent.evaluations;
            if found.reach != Reach::NotFound || found.interrupted || left == 0 {
                break;
            }
            time_weight /= LESS_TIME;
            let task = Task { base_weight: 1.0 - time_weight, ..(**problem.task()).clone() };
            let (family, accuracy) = (problem.family().clone(), problem.accuracy());
            let demanding = Reorientation::over(Arc::new(task), family, accuracy);
            let formulated = Formulated::free_form(Arc::new(demanding)).map_err(&refused)?;
            let seed = self.seed.wrapping_add(round);
            found = found.or(search(optimiser, &formulated, &own, longest, seed, left)?);
        }
        Ok(found)
    }

    /// What the paper's family comes to, if it comes to anything.
    fn search_other(&self, problem: TaskProblem) -> Option<OtherFamily> {
        let TaskProblem::SinePolynomial(problem, boxes) = problem else { return None };
        let terms = problem.family().terms();
        let formulated = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).ok()?;
        let scp = Scp { starts: NonZeroUsize::new(OTHER_STARTS), ..Scp::default() };
        let longest = boxes.duration[1];
        let found = search(&scp, &formulated, &formulated, longest, self.seed, self.budget).ok()?;
        (!found.interrupted).then(|| OtherFamily::new(terms, &found))
    }

    /// Says what was found, as JSON or to people, and writes the files that were asked for.
    fn finish<F: SearchedFamily>(
        &self,
        found: &Found<F>,
        other: Option<OtherFamily>,
        task: TaskTable,
    ) -> Result<(), CliError> {
        let known = BestKnown::of(found.problem.task());
        let inherited = task.inherited();
        if self.json {
            let task = shown(self.file.as_ref(), "xiao2023");
            let json = found.json(task, &self.optimiser, self.seed, inherited, known, other);
            say!("{}", serde_json::to_string_pretty(&json).unwrap_or_default());
        } else {
            let file = shown(self.file.as_ref(), "the paper's task");
            say!("{file} by {}, seed {}", self.optimiser, self.seed);
            if self.file.is_some() && !inherited.is_empty() {
                say!("  not stated     {} (as in the paper's task)", inherited.join(", "));
            }
            say!("{}", found.told(known, other));
        }
        if let Some(failure) = &found.failure {
            note!("warning: the search failed: {failure}");
        }
        found.warn(self.budget);
        self.say_entry(found, task);
        self.files.write(found.problem.task(), &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        if self.require && found.reach != Reach::Reached {
            return Err(CliError::Required(found.verdict()));
        }
        Ok(())
    }

    /// Says how the motion stands in the file of the best known: where it should, or was asked to.
    fn say_entry<F: SearchedFamily>(&self, found: &Found<F>, task: TaskTable) {
        let (problem, cost) = (found.problem.task(), found.assessment.cost);
        let beaten = BestKnown::of(problem).filter(|known| known.is_beaten_by(cost));
        if let Some(known) = beaten {
            note!("warning: J {cost:.9} is below the best known, {}", known.j);
        }
        if self.entry || beaten.is_some() {
            let Accuracy { attitude_steps, peak_intervals } = problem.accuracy();
            let family = match problem.family().spec() {
                FamilySpec::SinePolynomial { .. } => String::new(),
                FamilySpec::Spline { pieces, degree } => {
                    format!(" --family spline --pieces {pieces} --degree {degree}")
                }
            };
            let found_by = format!(
                "driftless plan --optimiser {} --seed {} --budget {}{family}, attitude_steps = \
                 {attitude_steps}, peak_intervals = {peak_intervals}",
                self.optimiser, self.seed, self.budget
            );
            let (coefficients, assessment) = (&found.coefficients, &found.assessment);
            let entry = BestKnown::new(problem, task, coefficients, assessment, found_by);
            note!("the entry for results/best-known.toml:\n\n{entry}");
        }
    }
}

/// Runs an optimiser once; `problem`, of which `searched` may be one with other weights, judges what it finds.
pub(super) fn search<F: Family>(
    optimiser: &dyn Optimiser,
    searched: &Formulated<F>,
    problem: &Formulated<F>,
    longest: f64,
    seed: u64,
    budget: u64,
) -> Result<Found<F>, CliError> {
    let watch = watch();
    let mut oracle = Oracle::new(searched, budget, &watch).parallel();
    let started = Instant::now();
    let stop = optimiser.minimise(&mut oracle, &mut Rng::new(seed));
    let seconds = started.elapsed().as_secs_f64();
    let interrupted = stop == Err(Stop::Interrupted);
    let failure = if let Err(Stop::Failed(failure)) = stop { Some(failure) } else { None };
    let Some(best) = oracle.best().cloned() else {
        return Err(match failure {
            Some(failure) => CliError::Search(failure),
            None if oracle.evaluations() == 0 && !interrupted => {
                CliError::Search(Failure::new("no cost was asked for"))
            }
            None if interrupted => CliError::Interrupted("no motion was found before".to_owned()),
            None => CliError::NoMotion,
        });
    };
    let (coefficients, assessment) = problem.certify(&best.x);
    if !assessment.cost.is_finite() || !assessment.duration.is_finite() {
        return Err(CliError::NoMotion);
    }
    let spent = Spent {
        evaluations: oracle.evaluations(),
        linearisations: oracle.linearisations(),
        curvatures: oracle.curvatures(),
        conic_solves: oracle.conic_solves(),
        seconds,
    };
    let reach = Reach::of(problem.task().task(), &assessment, longest);
    let problem = problem.clone();
    Ok(Found { problem, coefficients, assessment, reach, walls: None, spent, interrupted, failure })
}

fn find_optimiser(name: &str) -> Result<Settings, CliError> {
    Settings::by_name(name).ok_or_else(|| {
        let all = Settings::all();
        let known: Vec<&str> = all.iter().map(Settings::name).collect();
        CliError::Usage {
            message: format!("no optimiser `{name}`, expected one of {}", known.join(", ")),
            help: nearest(name, known).map(|n| format!("did you mean `{n}`?")),
        }
    })
}
