//! `driftless import`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::CliError;
use super::results::start_all_threads;
use crate::exhibit::words::plural;
use crate::experiment::{DataFormat, Folder};
use crate::import::read;

/// Make a folder of results of other programs' runs, to be reported beside others
#[derive(Debug, Args)]
pub(super) struct Import {
    /// Folder of data, or one of its indexes; of CSV one table, or a folder of them
    #[arg(value_name = "DATA")]
    data: PathBuf,
    /// Format to read
    #[arg(long, value_enum)]
    format: Format,
    /// Folder for the results, new or empty; the experiment is named after it
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// IOHprofiler's: an index in JSON per function, and the tables beside
    Ioh,
    /// COCO's: an index .info per function, and the tables beside
    Coco,
    /// A long table: problem, optimiser, seed, evaluation, cost
    Csv,
}

impl Import {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_all_threads()?;
        let format = match self.format {
            Format::Ioh => DataFormat::Ioh,
            Format::Coco => DataFormat::Coco,
            Format::Csv => DataFormat::Csv,
        };
        let import = read(format, &self.data)?;
        let plan = Folder::import(&self.out, &import.foreign)?;
        for note in &import.notes {
            note!("note: {note}");
        }
        say!(
            "{}: {} of {} on {}",
            self.out.display(),
            plural(plan.runs.len(), "run"),
            plural(plan.optimisers.len(), "optimiser"),
            plural(plan.instances.len(), "instance")
        );
        Ok(())
    }
}
