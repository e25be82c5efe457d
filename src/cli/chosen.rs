//! Which experiment is meant, as the verbs that do it take it.

use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{CliError, read_or};
use crate::experiment::{Experiment, Folder, Plan};
use crate::output::folder_of;
use crate::registry::registry;

/// An experiment, and where its results go.
#[derive(Debug, Args)]
pub(super) struct Chosen {
    /// Experiment file; without one, a small experiment on the paper's task
    #[arg(value_name = "EXPERIMENT.toml")]
    pub(super) file: Option<PathBuf>,
    /// Folder for the results [default: results/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of seeds, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(super) seeds: Option<u64>,
    /// Evaluations per run, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub(super) budget: Option<u64>,
    /// Start the programs that a file of results names
    #[arg(long)]
    trust: bool,
}

impl Chosen {
    pub(super) fn read(&self) -> Result<Experiment, CliError> {
        let document = read_or(self.file.as_deref(), Experiment::embedded)?;
        let mut experiment = Experiment::read(&document, &registry())?;
        if let Some(seeds) = self.seeds.and_then(NonZeroU64::new) {
            experiment = experiment.with_seeds(seeds);
        }
        if let Some(evaluations) = self.budget.and_then(NonZeroU64::new) {
            experiment = experiment.with_budget(evaluations);
        }
        Ok(experiment)
    }

    /// Where the results go.
    pub(super) fn folder(&self, plan: &Plan) -> PathBuf {
        self.out.clone().unwrap_or_else(|| Path::new("results").join(&plan.name))
    }

    /// Says which programs the experiment starts. Those that a file of results names may come from anybody, and are started only
    /// where the user says so. Whether there are any.
    pub(super) fn tell_programs(&self, experiment: &Experiment) -> Result<bool, CliError> {
        let mut told = Vec::new();
        // A file need not say where it comes from.
        let folder = self.file.as_deref().map(folder_of);
        let mut is_from_results = folder.is_some_and(Folder::has_runs);
        for (command, is_kept) in experiment.programs() {
            is_from_results |= is_kept;
            let program = format!("`{command}` in {}", command.folder().display());
            if !told.contains(&program) {
                told.push(program);
            }
        }
        for program in &told {
            note!("note: this experiment starts {program}");
        }
        if told.is_empty() || !is_from_results || self.trust {
            return Ok(!told.is_empty());
        }
        if confirmed("Start what these results name? [y/N] ") {
            return Ok(true);
        }
        Err(CliError::Usage {
            message: "these programs are named by a file of results, which may come from anybody"
                .to_owned(),
            help: Some("look at them, and pass --trust to start them".to_owned()),
        })
    }
}

/// Asks the user, where there is one.
fn confirmed(question: &str) -> bool {
    use std::io::{IsTerminal as _, Write as _};
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return false;
    }
    let mut line = String::new();
    let mut errors = std::io::stderr();
    let asked = errors.write_all(question.as_bytes()).and_then(|()| errors.flush());
    asked.and_then(|()| std::io::stdin().read_line(&mut line)).is_ok()
        && ["y", "yes"].contains(&line.trim().to_lowercase().as_str())
}
