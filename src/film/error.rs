//! What can go wrong with a film.

use crate::output::FileError;

/// Why a film was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FilmError {
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Pictures could not be put into a format.
    #[error("cannot write {format}: {reason}")]
    Encode {
        /// The format.
        format: &'static str,
        /// What its library says.
        reason: String,
    },
    /// The program that writes videos is not there.
    #[error("{ending} is written by ffmpeg, which could not be started: {source}")]
    NoFfmpeg {
        /// The ending of the file that was to be written.
        ending: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The program that writes videos did not do it.
    #[error("ffmpeg failed: {0}")]
    Ffmpeg(String),
    /// Somebody wanted it to end.
    #[error("interrupted before the film was written")]
    Interrupted,
}

impl From<gif::EncodingError> for FilmError {
    fn from(error: gif::EncodingError) -> Self {
        Self::Encode { format: "GIF", reason: error.to_string() }
    }
}

impl From<png::EncodingError> for FilmError {
    fn from(error: png::EncodingError) -> Self {
        Self::Encode { format: "PNG", reason: error.to_string() }
    }
}
