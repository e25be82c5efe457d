//! `driftless plan`.

use std::num::NonZeroU64;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::motion::{MotionFiles, PeaksDeg, Told};
use super::progress::Bar;
use super::{CliError, read_or, shown, warn_of, watch};
use crate::input::nearest;
use crate::optimiser::Settings;
use crate::oracle::{Budget, Oracle, Rng, Stop};
use crate::problem::{Accuracy, Assessment, Formulated, TaskFile};

/// Find the best motion for one task
#[derive(Debug, Args)]
pub(super) struct Plan {
    /// Task file; without one, the paper's task
    #[arg(value_name = "TASK.toml")]
    file: Option<PathBuf>,
    /// Optimiser, with its default settings; `driftless list` shows them
    #[arg(long, value_name = "NAME", default_value = "pso")]
    optimiser: String,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Evaluations to spend
    #[arg(long, value_name = "N", default_value = "150000")]
    budget: NonZeroU64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    files: MotionFiles,
}

#[derive(Debug, Serialize)]
struct PlanJson<'a> {
    task: String,
    optimiser: &'a str,
    seed: u64,
    terms: usize,
    j: f64,
    t_f: f64,
    residual_deg: f64,
    penalty: f64,
    peaks: PeaksDeg,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha6: Option<&'a [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha7: Option<&'a [f64]>,
    coefficients: Vec<&'a [f64]>,
    evaluations: u64,
    linearisations: u64,
    conic_solves: u64,
    seconds: f64,
}

/// What the search came to.
struct Found {
    problem: Formulated,
    coefficients: Vec<f64>,
    assessment: Assessment,
    evaluations: u64,
    seconds: f64,
    interrupted: bool,
}

impl Plan {
    pub(super) fn execute(self) -> Result<(), CliError> {
        self.files.check()?;
        let settings = find_optimiser(&self.optimiser)?;
        let document = read_or(self.file.as_deref(), TaskFile::paper)?;
        let (problem, boxes) = TaskFile::read(&document)?.build(&document)?;
        warn_of(&problem.task().robot);
        let found = self.search(
            &settings,
            Formulated::new(settings.formulation(), Arc::new(problem), &boxes),
        )?;
        if self.json {
            println!("{}", self.json(&found));
        } else {
            let problem = found.problem.task();
            let told = Told { problem, assessment: &found.assessment };
            println!(
                "{} by {}, seed {}",
                shown(self.file.as_ref(), "the paper's task"),
                self.optimiser,
                self.seed
            );
            print!("{told}");
            println!("  {} evaluations in {:.2} s", found.evaluations, found.seconds);
        }
        self.files.write(found.problem.task(), &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        Ok(())
    }

    fn search(&self, settings: &Settings, problem: Formulated) -> Result<Found, CliError> {
        let watch = watch();
        let budget = Budget { evaluations: self.budget.get(), target: None };
        let mut oracle = Oracle::new(&problem, budget, &watch);
        let started = Instant::now();
        let stop = {
            let _bar = Bar::new(budget.evaluations, watch.clone());
            settings.optimiser().minimise(&mut oracle, &mut Rng::new(self.seed))
        };
        let seconds = started.elapsed().as_secs_f64();
        let evaluations = oracle.evaluations();
        let Some(best) = oracle.best().cloned() else {
            return Err(CliError::NoMotion);
        };
        let (coefficients, duration) = problem.decode(&best.x);
        let certified = problem.task().with_accuracy(Accuracy::FINE);
        Ok(Found {
            assessment: certified.assess(&coefficients, duration),
            coefficients,
            evaluations,
            seconds,
            interrupted: stop == Err(Stop::Interrupted),
            problem,
        })
    }

    fn json(&self, found: &Found) -> String {
        let Found { assessment, coefficients, .. } = found;
        let family = found.problem.task().family();
        let alpha = family.to_alpha(coefficients, assessment.duration);
        let mut powers = alpha.chunks_exact(family.joints());
        let two = family.terms() == 2;
        let json = PlanJson {
            task: shown(self.file.as_ref(), "xiao2023"),
            optimiser: &self.optimiser,
            seed: self.seed,
            terms: family.terms(),
            j: assessment.cost,
            t_f: assessment.duration,
            residual_deg: assessment.residual().to_degrees(),
            penalty: assessment.penalty(),
            peaks: (&assessment.peaks).into(),
            alpha6: powers.next().filter(|_| two),
            alpha7: powers.next().filter(|_| two),
            coefficients: coefficients.chunks_exact(family.terms()).collect(),
            evaluations: found.evaluations,
            linearisations: 0,
            conic_solves: 0,
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
