//! `driftless plan`.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::motion::{AssessmentJson, MotionFiles, ShapeJson, Told};
use super::progress::Bar;
use super::{CliError, read_or, shown, warn_of, watch};
use crate::input::nearest;
use crate::optimiser::Settings;
use crate::reorientation::{Accuracy, Assessment, BestKnown, Formulated, Formulation, TaskFile};
use crate::search::{Oracle, Rng, Stop};
use crate::task::TaskTable;

/// Find the best motion for one task
#[derive(Debug, Args)]
pub(super) struct Plan {
    /// Task file; without one, the paper's task
    #[arg(value_name = "TASK.toml")]
    file: Option<PathBuf>,
    /// Optimiser, with its default settings; `driftless list` shows them
    #[arg(long, value_name = "NAME", default_value = "scp")]
    optimiser: String,
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

/// A residual above it is worth a warning.
const GOAL_REACHED_DEG: f64 = 0.01;

#[derive(Debug, Serialize)]
struct PlanJson<'a> {
    task: String,
    optimiser: &'a str,
    seed: u64,
    terms: usize,
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
struct Found {
    problem: Formulated,
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
        let file = TaskFile::read(&document)?;
        let (problem, boxes) = file.build(&document)?;
        warn_of(&problem.task().robot);
        // Default settings name no formulation.
        let formulation =
            Formulation::named(settings.formulation()).unwrap_or(Formulation::TimeFree);
        let formulated = Formulated::new(formulation, Arc::new(problem), &boxes)
            .map_err(|error| document.error_at(0..0, error, None))?;
        let found = self.search(&settings, formulated)?;
        if self.json {
            say!("{}", self.json(&found));
        } else {
            let problem = found.problem.task();
            let told = Told { problem, assessment: &found.assessment };
            say!(
                "{} by {}, seed {}",
                shown(self.file.as_ref(), "the paper's task"),
                self.optimiser,
                self.seed
            );
            say!("{told}");
            if let Some(known) = BestKnown::of(problem) {
                say!("  this J         {}", known.compared_with(found.assessment.cost));
            }
            say!("  {} evaluations in {:.2} s", found.evaluations, found.seconds);
        }
        let residual = found.assessment.residual().to_degrees();
        if residual > GOAL_REACHED_DEG {
            note!(
                "warning: the base ends {residual:.3}° from its goal; more terms, another optimiser, such \
                 as a hybrid, a larger budget or a larger `weights.base` may bring it there"
            );
        }
        self.say_entry(&found, file.task);
        self.files.write(found.problem.task(), &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        Ok(())
    }

    fn search(&self, settings: &Settings, problem: Formulated) -> Result<Found, CliError> {
        let watch = watch();
        let mut oracle = Oracle::new(&problem, self.budget, &watch);
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
    fn say_entry(&self, found: &Found, task: TaskTable) {
        let (problem, cost) = (found.problem.task(), found.assessment.cost);
        let beaten = BestKnown::of(problem).filter(|known| known.is_beaten_by(cost));
        if let Some(known) = beaten {
            note!("warning: J {cost:.9} is below the best known, {}", known.j);
        }
        if self.entry || beaten.is_some() {
            let Accuracy { attitude_steps, peak_intervals } = problem.accuracy();
            let found_by = format!(
                "driftless plan --optimiser {} --seed {} --budget {}, attitude_steps = \
                 {attitude_steps}, peak_intervals = {peak_intervals}",
                self.optimiser, self.seed, self.budget
            );
            let (coefficients, assessment) = (&found.coefficients, &found.assessment);
            let entry = BestKnown::new(problem, task, coefficients, assessment, found_by);
            note!("the entry for results/best-known.toml:\n\n{entry}");
        }
    }

    fn json(&self, found: &Found) -> String {
        let Found { assessment, coefficients, .. } = found;
        let family = found.problem.task().family();
        let json = PlanJson {
            task: shown(self.file.as_ref(), "xiao2023"),
            optimiser: &self.optimiser,
            seed: self.seed,
            terms: family.terms(),
            best_known_j: BestKnown::of(found.problem.task()).map(|known| known.j),
            assessment: assessment.into(),
            shape: ShapeJson::new(family, coefficients, assessment.duration),
            evaluations: found.evaluations,
            linearisations: found.linearisations,
            curvatures: found.curvatures,
            conic_solves: found.conic_solves,
            lanes: found.problem.task().width().lanes(),
            seconds: found.seconds,
        };
        serde_json::to_string_pretty(&json).unwrap_or_default()
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
