//! `driftless check`.

use std::path::PathBuf;
#[cfg(feature = "harness")]
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use super::{CliError, warn_of};
use crate::input::{Document, InputError};
use crate::reorientation::{ReplayFile, TaskFile};
use crate::robot::RobotFile;

/// Say what is wrong with an input file, or print it resolved
#[derive(Debug, Args)]
pub(super) struct Check {
    /// A task, robot, replay or experiment file
    #[arg(value_name = "FILE.toml")]
    file: PathBuf,
    /// Do not measure how long an experiment takes
    #[arg(long)]
    no_estimate: bool,
}

/// What a file is, told by its top-level keys.
enum Kind {
    Robot,
    Replay,
    Experiment,
    Task,
}

/// Keys that only an experiment has.
const EXPERIMENT_KEYS: [&str; 7] =
    ["name", "optimiser", "seeds", "budget", "sweep", "targets", "functions"];

impl Kind {
    fn of(document: &Document) -> Result<Self, InputError> {
        let has = |keys: &[&str]| -> Result<bool, InputError> {
            keys.iter().try_fold(false, |found, key| Ok(found || document.key(key)?.is_some()))
        };
        Ok(if has(&["joint", "base"])? {
            Self::Robot
        } else if has(&["motion"])? {
            Self::Replay
        } else if has(&EXPERIMENT_KEYS)? {
            Self::Experiment
        } else {
            Self::Task
        })
    }
}

/// Whether a file that is read as a task is one.
pub(super) fn expect_task(document: &Document, verb: &str) -> Result<(), CliError> {
    let found = match Kind::of(document)? {
        Kind::Task => return Ok(()),
        Kind::Robot => "a robot",
        Kind::Replay => "a motion to replay",
        Kind::Experiment => "an experiment",
    };
    Err(CliError::Usage {
        message: format!("{} is {found}, and `{verb}` takes a task", document.path.display()),
        help: None,
    })
}

impl Check {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let document = Document::read(&self.file)?;
        match Kind::of(&document)? {
            Kind::Robot => {
                let file = RobotFile::read(&document)?;
                print_resolved("robot", &file)?;
                warn_of(&file.build(&document)?);
            }
            Kind::Replay => {
                let file = ReplayFile::read(&document)?;
                warn_of(&file.build(&document)?.problem.task().robot);
                print_resolved("motion to replay", &file)?;
            }
            Kind::Task => {
                let file = TaskFile::read(&document)?.planned();
                let problem = file.problem(&document)?;
                warn_of(&problem.task().robot);
                print_resolved("task", &file.resolved(&problem))?;
            }
            Kind::Experiment => check_experiment(&document, !self.no_estimate)?,
        }
        Ok(())
    }
}

#[cfg(feature = "harness")]
fn check_experiment(document: &Document, estimate: bool) -> Result<(), CliError> {
    use super::run::default_jobs;
    use super::submit::WORKERS;
    use super::warnings::{warn_of_budgets, warn_of_subjects};
    use crate::exhibit::words::plural;
    use crate::experiment::{self, Experiment};
    use crate::registry::registry;
    use indicatif::HumanDuration;
    let experiment = Experiment::read(document, &registry())?;
    let plan = experiment.plan()?;
    warn_of_subjects(&plan);
    warn_of_budgets(&plan);
    for (command, _) in experiment.programs() {
        if let Err(failure) = command.check_program() {
            note!("warning: {failure}");
        }
    }
    let own = plan.optimisers.iter().map(|entrant| entrant.seeds.unwrap_or(experiment.seeds()));
    let seeds = match (own.clone().min(), own.max()) {
        (Some(fewest), Some(most)) if fewest < most => format!("{fewest} to {most}"),
        _ => experiment.seeds().to_string(),
    };
    say!("# experiment, with every default filled in");
    say!("{}", plan.experiment.to_toml().map_err(CliError::Resolved)?.trim_end());
    let (instances, optimisers) = (plan.instances.len(), plan.optimisers.len());
    say!(
        "\n# {}: {} × {} × {seeds} {}",
        plural(plan.runs.len(), "run"),
        plural(instances, "instance"),
        plural(optimisers, "optimiser"),
        if seeds == "1" { "seed" } else { "seeds" }
    );
    if estimate {
        let jobs = default_jobs();
        let estimate = experiment::estimate(&plan, jobs)?;
        let time = estimate.time(jobs).max(Duration::from_secs(1));
        let threads = if jobs == 1 { "thread" } else { "threads" };
        let rest =
            if estimate.is_partial() { ", without the runs that start programs" } else { "" };
        say!("# about {} on {jobs} {threads} (measured just now){rest}", HumanDuration(time));
        let shards = estimate.shards(WORKERS, 1);
        if shards.most > 1 {
            say!("# {}", words_for_shards(shards, WORKERS));
        }
    }
    Ok(())
}

/// How many shards make sense.
#[cfg(feature = "harness")]
fn words_for_shards(sensible: crate::experiment::Sensible, workers: usize) -> String {
    let crate::experiment::Sensible { fewest, most, idle_with_one_each, .. } = sensible;
    let idle = (100.0 * idle_with_one_each).max(0.0);
    let range = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    format!(
        "{range} shards make sense for {workers} workers of a scheduler; with one each they would be idle for {idle:.0} % \
         of the time"
    )
}

#[cfg(not(feature = "harness"))]
fn check_experiment(_: &Document, _: bool) -> Result<(), CliError> {
    let message = "this is an experiment; this build leaves experiments out".to_owned();
    Err(CliError::Usage { message, help: None })
}

fn print_resolved(kind: &str, file: &impl Serialize) -> Result<(), CliError> {
    say!("# {kind}, with every default filled in");
    say!("{}", toml::to_string(file)?.trim_end());
    Ok(())
}
