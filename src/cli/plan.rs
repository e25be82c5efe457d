//! `driftless plan`.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use serde::Serialize;
use toml::Spanned;

use super::motion::{AssessmentJson, MotionFiles, ShapeJson, Told};
use super::progress::Bar;
use super::{CliError, read_or, shown, warn_of, watch};
use crate::input::{InputError, nearest};
use crate::optimiser::{Scp, Settings};
use crate::reorientation::{
    Accuracy, Assessment, BestKnown, FamilyName, FamilySpec, Formulated, Formulation,
    Reorientation, SearchedFamily, TaskFile, TaskProblem, TrajectoryTable,
};
use crate::search::{BoundsError, Oracle, Rng, Stop};
use crate::task::TaskTable;
use crate::trajectory::{Family, Spline};

/// Find the best motion for one task
#[derive(Debug, Args)]
pub(super) struct Plan {
    /// Task file; without one, the paper's task
    #[arg(value_name = "TASK.toml")]
    file: Option<PathBuf>,
    /// Optimiser, with its default settings; `driftless list` shows them
    #[arg(long, value_name = "NAME", default_value = "scp")]
    optimiser: String,
    /// Family of motions, instead of the file's: splines are faster than sine polynomials and reach more goals
    #[arg(long, value_name = "NAME")]
    family: Option<FamilyName>,
    /// Pieces of a spline, instead of the file's or 40
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(4..=1000))]
    pieces: Option<u16>,
    /// Degree of a spline, instead of the file's or 4: 3 has a constant jerk on each piece, 4 a continuous one, 5 a smooth one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(3..=5))]
    degree: Option<u8>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Evaluations to spend
    #[arg(long, value_name = "N", default_value_t = 150_000, value_parser = clap::value_parser!(u64).range(1..))]
    budget: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Say the motion as an entry for results/best-known.toml, too
    #[arg(long)]
    entry: bool,
    #[command(flatten)]
    files: MotionFiles,
}

/// Starts that `scp` follows over splines.
const SPLINE_STARTS: usize = 24;

/// Share of J that `scp` is content to miss there.
const SPLINE_TOLERANCE: f64 = 1e-6;

/// A residual above it is worth a warning.
const GOAL_REACHED_DEG: f64 = 0.01;

#[derive(Debug, Serialize)]
struct PlanJson<'a> {
    task: String,
    optimiser: &'a str,
    seed: u64,
    #[serde(flatten)]
    family: FamilySpec,
    best_known_j: Option<f64>,
    #[serde(flatten)]
    assessment: AssessmentJson,
    #[serde(flatten)]
    shape: ShapeJson,
    evaluations: u64,
    linearisations: u64,
    curvatures: u64,
    conic_solves: u64,
    lanes: usize,
    seconds: f64,
}

/// What the search came to.
struct Found<F: Family> {
    problem: Formulated<F>,
    coefficients: Vec<f64>,
    assessment: Assessment,
    evaluations: u64,
    linearisations: u64,
    curvatures: u64,
    conic_solves: u64,
    seconds: f64,
    interrupted: bool,
}

impl Plan {
    pub(super) fn execute(self) -> Result<(), CliError> {
        self.files.check()?;
        let settings = find_optimiser(&self.optimiser)?;
        let document = read_or(self.file.as_deref(), TaskFile::paper)?;
        let TaskFile { task, trajectory } = TaskFile::read(&document)?;
        let file = TaskFile { trajectory: self.over(trajectory), task };
        self.check_options(file.trajectory.family())?;
        let refused = |error| document.error_at(0..0, error, None);
        let (problem, boxes) = match file.problem(&document)? {
            TaskProblem::Spline(problem, _) => {
                return self.plan_spline(&settings, problem, file.task, refused);
            }
            TaskProblem::SinePolynomial(problem, boxes) => (problem, boxes),
        };
        warn_of(&problem.task().robot);
        // Default settings name no formulation.
        let formulation =
            Formulation::named(settings.formulation()).unwrap_or(Formulation::TimeFree);
        let formulated =
            Formulated::new(formulation, Arc::new(problem), &boxes).map_err(refused)?;
        let found = self.search(&settings, formulated)?;
        self.report(&found)?;
        warn_of_residual(
            &found.assessment,
            "`--family spline`, more terms, another optimiser, such as a hybrid, a larger budget or a larger",
        );
        self.say_entry(&found, file.task);
        self.finish(&found)
    }

    /// What a file says of the family, with what the command line says instead.
    fn over(&self, mut table: TrajectoryTable) -> TrajectoryTable {
        if let Some(family) = self.family {
            table = table.with_family(family);
        }
        if let Some(pieces) = self.pieces {
            table = table.with_pieces(Spanned::new(0..0, pieces.into()));
        }
        if let Some(degree) = self.degree {
            table = table.with_degree(Spanned::new(0..0, degree.into()));
        }
        table
    }

    /// Whether all options are for the family.
    fn check_options(&self, family: FamilyName) -> Result<(), CliError> {
        let options = [("--pieces", self.pieces.is_some()), ("--degree", self.degree.is_some())];
        match options.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) if family != FamilyName::Spline => Err(CliError::Usage {
                message: format!("found {option}, which is for `--family spline` alone"),
                help: None,
            }),
            _ => Ok(()),
        }
    }

    /// The same over splines.
    fn plan_spline(
        &self,
        settings: &Settings,
        problem: Reorientation<Spline>,
        task: TaskTable,
        refused: impl Fn(BoundsError) -> InputError,
    ) -> Result<(), CliError> {
        warn_of(&problem.task().robot);
        let formulated = Formulated::free_form(Arc::new(problem)).map_err(refused)?;
        // Starts end alike more often than among sine polynomials, and each takes longer.
        let settings = match settings {
            Settings::Scp(scp) => Settings::Scp(Scp {
                starts: NonZeroUsize::new(SPLINE_STARTS),
                tolerance: SPLINE_TOLERANCE,
                ..scp.clone()
            }),
            other => other.clone(),
        };
        let found = self.search(&settings, formulated)?;
        self.report(&found)?;
        warn_of_residual(&found.assessment, "another `--seed`, more `--pieces` or a larger");
        self.say_entry(&found, task);
        self.finish(&found)
    }

    /// Says what was found, as JSON or to people.
    fn report<F: SearchedFamily>(&self, found: &Found<F>) -> Result<(), CliError> {
        let known = BestKnown::of(found.problem.task());
        if self.json {
            say!("{}", self.json(found, known));
            return Ok(());
        }
        let told = Told { task: found.problem.task().task(), assessment: &found.assessment };
        say!(
            "{} by {}, seed {}",
            shown(self.file.as_ref(), "the paper's task"),
            self.optimiser,
            self.seed
        );
        say!("{told}");
        if let Some(known) = known {
            say!("  this J         {}", known.compared_with(found.assessment.cost));
        }
        say!("  {} evaluations in {:.2} s", found.evaluations, found.seconds);
        Ok(())
    }

    /// Writes the files that were asked for.
    fn finish<F: SearchedFamily>(&self, found: &Found<F>) -> Result<(), CliError> {
        self.files.write(found.problem.task(), &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        Ok(())
    }

    fn search<F: Family>(
        &self,
        settings: &Settings,
        problem: Formulated<F>,
    ) -> Result<Found<F>, CliError> {
        let watch = watch();
        let mut oracle = Oracle::new(&problem, self.budget, &watch).parallel();
        let started = Instant::now();
        let stop = {
            let _bar = Bar::new(self.budget, watch.clone());
            settings.optimiser().minimise(&mut oracle, &mut Rng::new(self.seed))
        };
        let seconds = started.elapsed().as_secs_f64();
        let interrupted = stop == Err(Stop::Interrupted);
        if let Err(Stop::Failed(failure)) = stop {
            note!("warning: the search failed: {failure}");
        }
        let Some(best) = oracle.best().cloned() else {
            return Err(if interrupted {
                CliError::Interrupted("no motion was found before".to_owned())
            } else {
                CliError::NoMotion
            });
        };
        let (coefficients, assessment) = problem.certify(&best.x);
        Ok(Found {
            coefficients,
            assessment,
            evaluations: oracle.evaluations(),
            linearisations: oracle.linearisations(),
            curvatures: oracle.curvatures(),
            conic_solves: oracle.conic_solves(),
            seconds,
            interrupted,
            problem,
        })
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

    fn json<F: SearchedFamily>(&self, found: &Found<F>, known: Option<&BestKnown>) -> String {
        let (problem, duration) = (found.problem.task(), found.assessment.duration);
        let json = PlanJson {
            task: shown(self.file.as_ref(), "xiao2023"),
            optimiser: &self.optimiser,
            seed: self.seed,
            family: problem.family().spec(),
            best_known_j: known.map(|known| known.j),
            assessment: (&found.assessment).into(),
            shape: ShapeJson::new(problem, &found.coefficients, duration),
            evaluations: found.evaluations,
            linearisations: found.linearisations,
            curvatures: found.curvatures,
            conic_solves: found.conic_solves,
            lanes: problem.width().lanes(),
            seconds: found.seconds,
        };
        serde_json::to_string_pretty(&json).unwrap_or_default()
    }
}

/// Warns where the goal is missed; `advice` comes before the weight.
fn warn_of_residual(assessment: &Assessment, advice: &str) {
    let residual = assessment.residual().to_degrees();
    if residual > GOAL_REACHED_DEG {
        note!(
            "warning: the base ends {residual:.3}° from its goal; {advice} `weights.base` may bring it there"
        );
    }
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
