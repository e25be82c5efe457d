//! `driftless compact`.

use clap::Args;
use serde_json::json;

use super::results::ResultsFolder;
use super::warnings::warn_of_damage;
use super::{CliError, say_json, watch};
use crate::words::plural;

/// Merge many small result files into a few; other processes may run and read meanwhile
#[derive(Debug, Args)]
pub(super) struct Compact {
    #[command(flatten)]
    results: ResultsFolder,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Compact {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let results = self.results.open()?;
        let folder = results.path().display();
        let done = results.store.compact(&watch())?;
        if self.json {
            say_json(&json!({
                "folder": folder.to_string(),
                "merged": done.is_some(),
                "files_before": done.map(|done| done.before),
                "files_after": done.map(|done| done.after),
            }))?;
            warn_of_damage(&results.store);
            return Ok(());
        }
        match done {
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
