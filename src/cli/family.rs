//! Options that say which family of motions is searched.

use clap::Args;
use toml::Spanned;

use super::CliError;
use crate::reorientation::{FamilyName, TrajectoryTable};

/// Which motions are searched.
#[derive(Debug, Args)]
pub(super) struct FamilyOptions {
    /// Family of motions, instead of the file's: splines are faster than sine polynomials and reach more goals, and are the
    /// choice of `scp` where neither says
    #[arg(long, value_name = "NAME")]
    family: Option<FamilyName>,
    /// Pieces of a spline, instead of the file's; 80 unless the file names a family
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(4..=1000))]
    pieces: Option<u16>,
    /// Degree of a spline, instead of the file's or 4: 3 has a constant jerk on each piece, 4 a continuous one, 5 a smooth one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(3..=5))]
    degree: Option<u8>,
}

impl FamilyOptions {
    /// Whether the family itself is named.
    pub(super) fn is_named(&self) -> bool {
        self.family.is_some()
    }

    /// What a file says of the family, with what the command line says instead; where neither names one, splines if
    /// `is_spline`.
    pub(super) fn over(
        &self,
        mut table: TrajectoryTable,
        is_spline: bool,
    ) -> Result<TrajectoryTable, CliError> {
        if is_spline || self.pieces.is_some() || self.degree.is_some() {
            table = table.planned();
        }
        if let Some(family) = self.family {
            table = table.with_family(family);
        }
        if let Some(pieces) = self.pieces {
            table = table.with_pieces(Spanned::new(0..0, pieces.into()));
        }
        if let Some(degree) = self.degree {
            table = table.with_degree(Spanned::new(0..0, degree.into()));
        }
        let options = [("--pieces", self.pieces.is_some()), ("--degree", self.degree.is_some())];
        match options.into_iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) if table.family() != FamilyName::Spline => Err(CliError::Usage {
                message: format!("found {option}, which is for `--family spline` alone"),
                help: None,
            }),
            _ => Ok(table),
        }
    }
}
