//! What can go wrong with a figure.

use plotters::drawing::DrawingAreaErrorKind;
use polars::prelude::PolarsError;

use crate::output::FileError;

/// A figure that could not be drawn or written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum FigureError {
    /// The drawing went wrong.
    #[error("cannot draw a figure: {0}")]
    Draw(String),
    /// The drawing could not be brought into a format.
    #[error("cannot make a {format}: {reason}")]
    Convert {
        /// The format.
        format: &'static str,
        /// Why not.
        reason: String,
    },
    /// The table to draw is not as it should be.
    #[error("cannot draw a table: {0}")]
    Table(String),
    /// The file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for FigureError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Draw(error.to_string())
    }
}

impl From<PolarsError> for FigureError {
    fn from(error: PolarsError) -> Self {
        Self::Table(error.to_string())
    }
}
