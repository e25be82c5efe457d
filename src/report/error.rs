//! What can go wrong with a report.

use std::io;

use polars::prelude::PolarsError;

use crate::experiment::StoreError;
use crate::figure::FigureError;
use crate::output::FileError;

/// A report that could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A stored result could not be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// A chart could not be drawn or written.
    #[error("{0}")]
    Figure(String),
    /// These results give no chart of a name.
    #[error("no chart `{name}` of these results, expected some of {known}")]
    NoChart {
        /// The name.
        name: String,
        /// The charts that there are.
        known: String,
    },
    /// A table could not be made.
    #[error("cannot make a table: {0}")]
    Table(String),
    /// Data could not be put into the page.
    #[error("cannot put data into a page")]
    Data(#[from] io::Error),
    /// The page's template could not be filled in.
    #[error("cannot fill in a page: {0}")]
    Template(String),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

#[doc(hidden)]
impl From<FigureError> for ReportError {
    fn from(error: FigureError) -> Self {
        Self::Figure(error.to_string())
    }
}

#[doc(hidden)]
impl From<PolarsError> for ReportError {
    fn from(error: PolarsError) -> Self {
        Self::Table(error.to_string())
    }
}

#[doc(hidden)]
impl From<minijinja::Error> for ReportError {
    fn from(error: minijinja::Error) -> Self {
        Self::Template(error.to_string())
    }
}

#[doc(hidden)]
impl From<serde_json::Error> for ReportError {
    fn from(error: serde_json::Error) -> Self {
        Self::Data(error.into())
    }
}
