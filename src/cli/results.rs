//! A folder of results, as the verbs that read it take it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use crate::experiment::{ExperimentFile, Plan, Store};
use crate::input::Document;

/// Where the results are.
#[derive(Debug, Args)]
pub(super) struct ResultsFolder {
    /// Folder of results
    #[arg(value_name = "DIR", default_value = "results/default")]
    folder: PathBuf,
}

/// What a folder of results holds.
pub(super) struct Results {
    pub(super) folder: PathBuf,
    pub(super) plan: Plan,
    pub(super) store: Store,
}

impl ResultsFolder {
    /// Reads the experiment that the folder keeps. Nothing is written.
    pub(super) fn open(&self) -> Result<Results, CliError> {
        let path = self.folder.join(EXPERIMENT);
        if !path.is_file() {
            return Err(no_results(&self.folder, &format!("no {EXPERIMENT}")));
        }
        let document = Document::read(&path)?;
        let plan = Plan::new(&ExperimentFile::read(&document)?, &document)?;
        Ok(Results { plan, store: Store::existing(&self.folder), folder: self.folder.clone() })
    }
}

/// The error of a folder that is not what it should be.
pub(super) fn no_results(folder: &Path, found: &str) -> CliError {
    CliError::Usage {
        message: format!(
            "found {found} in {}, expected the results of an experiment",
            folder.display()
        ),
        help: Some("`driftless run` puts them into results/NAME or where --out says".to_owned()),
    }
}

/// What `run` keeps the experiment in.
pub(super) const EXPERIMENT: &str = "experiment.toml";

/// The command that does what is missing from a folder, as one types it.
pub(super) fn command(folder: &Path) -> String {
    let quoted = |path: &Path| shell_words::quote(&path.display().to_string()).into_owned();
    format!("driftless run {} --out {}", quoted(&folder.join(EXPERIMENT)), quoted(folder))
}
