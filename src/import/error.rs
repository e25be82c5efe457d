//! Data that cannot be imported.

use std::path::{Path, PathBuf};

use crate::output::FileError;

/// Data that cannot be imported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// A file or folder could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file is not what was expected.
    #[error("{}{}: {message}", .path.display(), shown(*.line))]
    Content {
        /// The file, or the folder that lacks one.
        path: PathBuf,
        /// Where in it, counted from one, if it is one line.
        line: Option<u64>,
        /// What was found and what was expected.
        message: String,
    },
}

fn shown(line: Option<u64>) -> String {
    line.map_or_else(String::new, |line| format!(":{line}"))
}

impl ImportError {
    /// A file as a whole, or a folder, is not what was expected.
    pub(super) fn of(path: &Path, message: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), line: None, message: message.into() }
    }

    /// A line of a file is not what was expected.
    pub(super) fn at(path: &Path, line: u64, message: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), line: Some(line), message: message.into() }
    }

    pub(super) fn unreadable(path: &Path, source: std::io::Error) -> Self {
        FileError { action: "read", path: path.to_owned(), source }.into()
    }
}
