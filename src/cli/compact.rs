//! `driftless compact`.

use clap::Args;

use super::results::ResultsFolder;
use super::warnings::warn_of_damage;
use super::{CliError, watch};
use crate::exhibit::words::plural;

/// Merge many small files of results into few, while others run or read
#[derive(Debug, Args)]
pub(super) struct Compact {
    #[command(flatten)]
    results: ResultsFolder,
}

impl Compact {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let results = self.results.open()?;
        let folder = results.path().display();
        match results.store.compact(&watch())? {
            Some(done) => {
                let after = plural(done.after, "file");
                say!("{folder}: {after} per table, {} before", done.before);
            }
            None => say!("{folder}: another process is merging files"),
        }
        warn_of_damage(&results.store);
        Ok(())
    }
}
