//! `driftless import`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::results::start_all_threads;
use super::{CliError, say_json};
use crate::experiment::{DataFormat, Folder};
use crate::import::read;
use crate::words::plural;

/// Import runs of other programs as a folder of results, to be reported beside others
#[derive(Debug, Args)]
pub(super) struct Import {
    /// Folder of data or one of its index files; for CSV, a table or a folder of tables
    #[arg(value_name = "DATA")]
    data: PathBuf,
    /// Format to read
    #[arg(long, value_enum)]
    format: Format,
    /// Folder for the results, new or empty; the experiment is named after it
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// IOHprofiler: a JSON index for each function, with its tables beside it
    Ioh,
    /// COCO: an .info index for each function, with its tables beside it
    Coco,
    /// A long table with the columns problem, optimiser, seed, evaluation and cost
    Csv,
}

impl Import {
    pub(super) fn execute(self) -> Result<(), CliError> {
        if self.data.join("experiment.toml").is_file() {
            let message = format!(
                "{} is a folder of results, expected data of another program",
                self.data.display()
            );
            let help = Some("`driftless export` writes such data from results".to_owned());
            return Err(CliError::Usage { message, help });
        }
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
        if self.json {
            return say_json(&json!({
                "folder": self.out.display().to_string(),
                "runs": plan.runs.len(),
                "optimisers": plan.optimisers.len(),
                "instances": plan.instances.len(),
                "notes": import.notes,
            }));
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
