//! `driftless replay`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::motion::{MotionFiles, Told};
use super::{CliError, read_or, shown, warn_of};
use crate::reorientation::{
    AssessmentJson, Excursions, ExcursionsJson, Published, Reading, ReplayFile, ShapeJson,
};

/// Evaluate a given motion; without a file, the one published by Xiao et al. (2023)
#[derive(Debug, Args)]
pub(super) struct Replay {
    /// File with a [motion] table; without one, the published motion
    #[arg(value_name = "FILE.toml")]
    file: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    files: MotionFiles,
}

#[derive(Debug, Serialize)]
struct ReplayJson {
    published: PublishedJson,
    readings: Vec<ReadingJson>,
}

#[derive(Debug, Serialize)]
struct PublishedJson {
    #[serde(flatten)]
    shape: ShapeJson,
    t_f: f64,
    j: Option<f64>,
    #[serde(flatten)]
    excursions: ExcursionsJson,
}

#[derive(Debug, Serialize)]
struct ReadingJson {
    reading: Reading,
    #[serde(flatten)]
    assessment: AssessmentJson,
}

impl Replay {
    pub(super) fn execute(self) -> Result<(), CliError> {
        self.files.check()?;
        let document = read_or(self.file.as_deref(), ReplayFile::paper)?;
        let published = ReplayFile::read(&document)?.build(&document)?;
        warn_of(&published.problem.task().robot);
        let Published { problem, coefficients, duration, .. } = &published;
        let excursions = Excursions::on_the_way(&**problem, coefficients, *duration);
        let task = problem.task();
        if self.json {
            say!("{}", json(&published, ExcursionsJson::new(&excursions, task)));
        } else {
            say!("{}", shown(self.file.as_ref(), "the solution published by Xiao et al. (2023)"));
            if let Some(claim) = published.cost {
                say!("claimed: J {claim}, duration {} s", published.duration);
            }
            for (reading, assessment) in published.readings() {
                say!("read {}:", reading.meaning());
                say!("{}", Told { task, assessment: &assessment, excursions: &excursions });
            }
        }
        self.files.write(&*published.problem, &published.coefficients, published.duration)
    }
}

fn json(published: &Published, excursions: ExcursionsJson) -> String {
    let Published { problem, coefficients, duration, cost } = published;
    let readings = published.readings().into_iter();
    let readings = readings
        .map(|(reading, assessment)| ReadingJson { reading, assessment: (&assessment).into() });
    let json = ReplayJson {
        published: PublishedJson {
            shape: ShapeJson::new(&**problem, coefficients, *duration),
            t_f: *duration,
            j: *cost,
            excursions,
        },
        readings: readings.collect(),
    };
    serde_json::to_string_pretty(&json).unwrap_or_default()
}
