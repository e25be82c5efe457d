//! Options that say which family of motions is searched.

use clap::Args;

use super::CliError;
use crate::reorientation::{FamilyChoice, FamilyName};

/// Which motions are searched.
#[derive(Debug, Args)]
pub(super) struct FamilyOptions {
    /// Family of motions, overriding the file's. Splines give faster motions than sine polynomials and reach more goals; `plan`
    /// searches them with `scp` unless told otherwise
    #[arg(long, value_name = "NAME")]
    family: Option<FamilyName>,
    /// Pieces of a spline, overriding the file's [default: 80, or 40 if the file says only `family = "spline"`]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(4..=1000))]
    pieces: Option<u16>,
    /// Degree of a spline, overriding the file's: 3 has constant jerk on each piece, 4 continuous jerk, 5 smooth jerk [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(3..=5))]
    degree: Option<u8>,
}

impl FamilyOptions {
    pub(super) fn choice(&self) -> FamilyChoice {
        FamilyChoice {
            family: self.family,
            pieces: self.pieces.map(usize::from),
            degree: self.degree.map(usize::from),
        }
    }

    /// The error of an option that is for splines alone.
    pub(super) fn for_splines(option: &str) -> CliError {
        CliError::Usage {
            message: format!("found --{option}, which is for `--family spline` alone"),
            help: None,
        }
    }
}
