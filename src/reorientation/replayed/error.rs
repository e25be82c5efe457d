//! Trajectories that cannot be read.

use std::path::{Path, PathBuf};

use crate::output::FileError;

/// A trajectory that cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The file could not be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is not what was expected.
    #[error("{}{}: {message}", .path.display(), shown(*.line))]
    Content {
        /// The file.
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

/// Where rows stand, for what is said of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) path: &'a Path,
    /// Whether a row is a line of a text.
    pub(super) is_text: bool,
}

impl Source<'_> {
    /// The file as a whole is not what was expected.
    pub(super) fn error(&self, message: impl Into<String>) -> TrajectoryError {
        let (path, line) = (self.path.to_owned(), None);
        TrajectoryError::Content { path, line, message: message.into() }
    }

    /// A row of it is not: a line of a text, or a row of a table.
    pub(super) fn error_at(&self, row: u64, message: impl Into<String>) -> TrajectoryError {
        let (line, message) = if self.is_text {
            (Some(row), message.into())
        } else {
            (None, format!("row {row}: {}", message.into()))
        };
        TrajectoryError::Content { path: self.path.to_owned(), line, message }
    }

    pub(super) fn unreadable(&self, source: std::io::Error) -> TrajectoryError {
        FileError { action: "read", path: self.path.to_owned(), source }.into()
    }
}

/// Names between backticks.
pub(super) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    const SHOWN: usize = 20;
    let names: Vec<&str> = names.into_iter().collect();
    let shown = names.iter().take(SHOWN).map(|name| format!("`{}`", cut(name)));
    let mut shown: Vec<String> = shown.collect();
    if names.len() > SHOWN {
        shown.push(format!("and {} more", names.len() - SHOWN));
    }
    shown.join(", ")
}

/// The beginning of a text that may be of any length.
pub(super) fn cut(text: &str) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
