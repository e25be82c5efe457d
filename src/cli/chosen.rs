//! Which experiment is meant, as the verbs that do it take it.

use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::kind::{Kind, read_or};
use super::trust::tell_programs;
use crate::experiment::{Experiment, Plan};
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
    /// Number of seeds, overriding the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(super) seeds: Option<u64>,
    /// Evaluations per run, overriding the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub(super) budget: Option<u64>,
    /// Repeat stored runs that failed
    #[arg(long)]
    pub(super) retry: bool,
    /// Allow starting the programs that a folder of results names, now and in future
    #[arg(long)]
    trust: bool,
}

impl Chosen {
    /// The experiment.
    pub(super) fn read(&self) -> Result<Experiment, CliError> {
        let document = read_or(self.file.as_deref(), Kind::Experiment, Experiment::embedded)?;
        let mut experiment = Experiment::read(&document, &registry())?;
        if let Some(from) = experiment.imported() {
            let message = format!("these results were imported, from {from}, and cannot be run");
            let help = Some("`driftless report` reports them, also beside others".to_owned());
            return Err(CliError::Usage { message, help });
        }
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

    /// Says which programs the experiment starts. Whether `--trust` has to be given again.
    pub(super) fn tell_programs(&self, experiment: &Experiment) -> Result<bool, CliError> {
        tell_programs(experiment, self.file.as_deref(), self.trust)
    }
}
