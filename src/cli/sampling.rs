//! Options that say at which times motions are sampled.

use clap::Args;

use super::CliError;
use crate::reorientation::Sampling;

/// At which times a motion that is written is sampled.
#[derive(Debug, Args)]
pub(super) struct SamplingOptions {
    /// Seconds between samples of written motions; the last sample is always the end of the motion [default: 500 equal
    /// intervals, for splines rounded up to a multiple of their pieces; points with rates and accelerations keep their times]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, conflicts_with = "rate", value_parser = step)]
    dt: Option<Sampling>,
    /// Samples per second of written motions, instead of --dt
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, value_parser = rate)]
    rate: Option<Sampling>,
}

impl SamplingOptions {
    /// What was asked for.
    pub(super) fn choice(&self) -> Option<Sampling> {
        self.dt.or(self.rate)
    }

    /// Refuses options that have no effect, since no motion is written; `expected` says what would write one.
    pub(super) fn check_unused(&self, expected: &str) -> Result<(), CliError> {
        let option = if self.dt.is_some() { "--dt" } else { "--rate" };
        match self.choice() {
            None => Ok(()),
            Some(_) => Err(CliError::Usage {
                message: format!("{option} needs a motion to be written, expected {expected}"),
                help: None,
            }),
        }
    }
}

fn step(text: &str) -> Result<Sampling, String> {
    let found = text.parse().ok().and_then(Sampling::of_step);
    found.ok_or_else(|| "expected a number of seconds above zero".to_owned())
}

fn rate(text: &str) -> Result<Sampling, String> {
    let found = text.parse().ok().and_then(Sampling::of_rate);
    found.ok_or_else(|| "expected a number above zero".to_owned())
}
