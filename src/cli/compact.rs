//! `driftless compact`.

use clap::Args;

use super::CliError;
use super::results::ResultsFolder;

/// Merge many small files of results into few, while others run or read
#[derive(Debug, Args)]
pub(super) struct Compact {
    #[command(flatten)]
    results: ResultsFolder,
}

impl Compact {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let results = self.results.open()?;
        let done = results.store.compact()?;
        say!("{}: {} files a table, {} before", results.folder.display(), done.after, done.before);
        Ok(())
    }
}
