//! A folder of results, as the verbs that read it take it.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::kind::{Kind, refuse_file};
use crate::experiment::Folder;
use crate::registry::registry;

/// Where the results are.
#[derive(Debug, Args)]
pub(super) struct ResultsFolder {
    /// Folder of results
    #[arg(value_name = "DIR", default_value = "results/default")]
    folder: PathBuf,
}

impl ResultsFolder {
    /// Reads the experiment that the folder keeps. Nothing is written.
    pub(super) fn open(&self) -> Result<Folder, CliError> {
        expect_results(&self.folder)?;
        start_all_threads()?;
        Ok(Folder::open(&self.folder, &registry())?)
    }
}

/// Where the results of several experiments are.
#[derive(Debug, Args)]
pub(super) struct ResultsFolders {
    /// Folders of results; several are reported as one experiment
    #[arg(value_name = "DIR", default_value = "results/default")]
    folders: Vec<PathBuf>,
}

impl ResultsFolders {
    /// Reads the experiments that the folders keep. Nothing is written.
    pub(super) fn open(&self) -> Result<Vec<Folder>, CliError> {
        self.folders.iter().try_for_each(|folder| expect_results(folder))?;
        start_all_threads()?;
        let registry = registry();
        self.folders.iter().map(|folder| Ok(Folder::open(folder, &registry)?)).collect()
    }
}

/// Whether a path may be a folder of results.
fn expect_results(path: &Path) -> Result<(), CliError> {
    if !path.is_file() {
        return Ok(());
    }
    refuse_file(path, Kind::Results)?;
    Err(CliError::Usage {
        message: format!("{} is a file, expected a folder of results", path.display()),
        help: Some(HELP.to_owned()),
    })
}

/// Starts the threads that work on results is shared out to, those of polars among them.
pub(super) fn start_all_threads() -> Result<(), CliError> {
    super::start_worker_threads()?;
    if crate::experiment::start_polars_threads() {
        Ok(())
    } else {
        Err(CliError::Threads("the system gives no more of them".to_owned()))
    }
}

/// The error of a folder that is not what it should be.
pub(super) fn no_results(folder: &Path, found: &str) -> CliError {
    CliError::Usage {
        message: format!(
            "found {found} in {}, expected the results of an experiment",
            folder.display()
        ),
        help: Some(HELP.to_owned()),
    }
}

/// Where results come from.
pub(super) const HELP: &str = "`driftless run` puts them into results/NAME or where --out says";

/// The command that does what is missing from a folder, as one types it.
pub(super) fn command(folder: &Folder) -> String {
    let quoted = |path: &Path| shell_words::quote(&path.display().to_string()).into_owned();
    let file = folder.experiment_file();
    format!("driftless run {} --out {}", quoted(&file), quoted(folder.path()))
}
