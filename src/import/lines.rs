//! Lines of a file, one at a time.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

use super::error::ImportError;
use super::files::open;

/// The longest line \[bytes\]: a point of a thousand variables takes some 20,000.
const LONGEST: u64 = 10_000_000;

/// Characters of a line that an error shows.
const SHOWN: usize = 40;

/// Lines of a file, one at a time, with their numbers.
#[derive(Debug)]
pub(super) struct Lines {
    path: PathBuf,
    reader: BufReader<std::fs::File>,
    buffer: Vec<u8>,
    number: u64,
}

impl Lines {
    pub(super) fn open(path: &Path) -> Result<Self, ImportError> {
        let reader = BufReader::with_capacity(1 << 16, open(path)?);
        Ok(Self { path: path.to_owned(), reader, buffer: Vec::new(), number: 0 })
    }

    /// The next line without what ends it. What is no UTF-8, as in comments of old files, is replaced.
    pub(super) fn next(&mut self) -> Result<Option<String>, ImportError> {
        self.buffer.clear();
        let mut limited = self.reader.by_ref().take(LONGEST + 1);
        let read = limited
            .read_until(b'\n', &mut self.buffer)
            .map_err(|source| ImportError::unreadable(&self.path, source))?;
        if read == 0 {
            return Ok(None);
        }
        self.number += 1;
        if self.buffer.len() as u64 > LONGEST {
            return Err(self.error(format!("found a line of more than {LONGEST} bytes")));
        }
        while self.buffer.last().is_some_and(|byte| [b'\n', b'\r'].contains(byte)) {
            self.buffer.pop();
        }
        Ok(Some(String::from_utf8_lossy(&self.buffer).into_owned()))
    }

    /// The number of the last line, counted from one.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// What is wrong with the last line.
    pub(super) fn error(&self, message: impl Into<String>) -> ImportError {
        ImportError::at(&self.path, self.number, message)
    }

    /// What is wrong with a part of the last line.
    pub(super) fn unexpected(&self, found: &str, expected: &str) -> ImportError {
        self.error(format!("found `{}`, expected {expected}", cut(found)))
    }
}

/// A text as an error shows it.
pub(super) fn cut(text: &str) -> String {
    let mut shown: String = text.chars().take(SHOWN).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}
