//! `driftless replay`.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::motion::{MotionFiles, PeaksDeg, Told};
use super::{CliError, read_or, shown, warn_of};
use crate::problem::{Published, Reading, ReplayFile};

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
struct ReplayJson<'a> {
    published: PublishedJson<'a>,
    readings: Vec<ReadingJson>,
}

#[derive(Debug, Serialize)]
struct PublishedJson<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha6: Option<&'a [f64]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha7: Option<&'a [f64]>,
    coefficients: Vec<&'a [f64]>,
    t_f: f64,
    j: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ReadingJson {
    reading: Reading,
    j: f64,
    residual_deg: f64,
    penalty: f64,
    t_f: f64,
    peaks: PeaksDeg,
}

impl Replay {
    pub(super) fn execute(self) -> Result<(), CliError> {
        self.files.check()?;
        let document = read_or(self.file.as_deref(), ReplayFile::paper)?;
        let published = ReplayFile::read(&document)?.build(&document)?;
        warn_of(&published.problem.task().robot);
        if self.json {
            println!("{}", json(&published));
        } else {
            println!(
                "{}",
                shown(self.file.as_ref(), "the solution published by Xiao et al. (2023)")
            );
            if let Some(claim) = published.cost {
                println!("claimed: J {claim}, duration {} s", published.duration);
            }
            for reading in Reading::ALL {
                let assessment = published.assess(reading);
                println!("read {}:", reading.meaning());
                print!("{}", Told { problem: &published.problem, assessment: &assessment });
            }
        }
        self.files.write(&published.problem, &published.coefficients, published.duration)
    }
}

fn json(published: &Published) -> String {
    let family = published.problem.family();
    let two = family.terms() == 2;
    let alpha = family.to_alpha(&published.coefficients, published.duration);
    let mut powers = alpha.chunks_exact(family.joints());
    let readings = Reading::ALL.map(|reading| {
        let assessment = published.assess(reading);
        ReadingJson {
            reading,
            j: assessment.cost,
            residual_deg: assessment.residual().to_degrees(),
            penalty: assessment.penalty(),
            t_f: assessment.duration,
            peaks: (&assessment.peaks).into(),
        }
    });
    let json = ReplayJson {
        published: PublishedJson {
            alpha6: powers.next().filter(|_| two),
            alpha7: powers.next().filter(|_| two),
            coefficients: published.coefficients.chunks_exact(family.terms()).collect(),
            t_f: published.duration,
            j: published.cost,
        },
        readings: readings.into(),
    };
    serde_json::to_string_pretty(&json).unwrap_or_default()
}
