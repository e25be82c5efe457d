//! A folder of Parquet files: one run, one file a table, written once.
//!
//! ```text
//! results/NAME/traces/KEY.parquet   improvements of the best cost
//! results/NAME/clocks/KEY.parquet   the wall time of each of them
//! results/NAME/runs/KEY.parquet     one row; it is written last, so a run that has it is whole
//! ```

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::*;

use super::Record;
use crate::output::{FileError, create_folder, write_file};

/// The tables, in the order in which a run's are written.
const TABLES: [&str; 3] = ["traces", "clocks", "runs"];

/// The results of one experiment.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
}

/// A result that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file system said no.
    #[error(transparent)]
    File(#[from] FileError),
    /// The table could not be written or read.
    #[error("cannot {action} table {}; a run whose files are removed is done again", .path.display())]
    Table {
        /// What was tried.
        action: &'static str,
        /// With which file.
        path: PathBuf,
        /// What came of it.
        source: PolarsError,
    },
    /// A record could not be made into a table.
    #[error("cannot make a table of a run")]
    Record(#[from] PolarsError),
}

impl Store {
    /// Opens a folder, made if need be.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        for table in TABLES {
            create_folder(&folder.join(table))?;
        }
        Ok(Self { folder: folder.to_owned() })
    }

    /// Removes the stored runs of a plan.
    pub fn remove(&self, keys: impl Iterator<Item = impl AsRef<str>>) -> Result<(), StoreError> {
        for key in keys {
            // In the opposite order to writing: what is half removed counts as not there.
            for table in TABLES.iter().rev() {
                let path = self.path(table, key.as_ref());
                match fs::remove_file(&path) {
                    Err(e) if e.kind() != io::ErrorKind::NotFound => {
                        return Err(io_error("remove", &path, e));
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Whether a run is stored.
    pub fn has(&self, key: &str) -> bool {
        self.path("runs", key).exists()
    }

    /// Stores a run, whole or not at all.
    pub fn write(&self, record: &Record) -> Result<(), StoreError> {
        for (table, frame) in TABLES.iter().zip([&record.trace, &record.clock, &record.row]) {
            write_table(&self.path(table, &record.key), frame)?;
        }
        Ok(())
    }

    /// One table of the named runs, in their order; runs that are not stored are left out.
    pub fn read<'a>(
        &self,
        table: &str,
        keys: impl Iterator<Item = &'a str>,
    ) -> Result<DataFrame, StoreError> {
        let mut all = DataFrame::empty();
        for key in keys.filter(|key| self.has(key)) {
            let path = self.path(table, key);
            let file = File::open(&path).map_err(|source| io_error("open", &path, source))?;
            let frame = ParquetReader::new(file)
                .finish()
                .and_then(|frame| all.vstack_mut_owned(frame).map(drop));
            frame.map_err(|source| StoreError::Table { action: "read", path, source })?;
        }
        all.rechunk_mut();
        Ok(all)
    }

    fn path(&self, table: &str, key: &str) -> PathBuf {
        self.folder.join(table).join(format!("{key}.parquet"))
    }
}

/// Writes a table as Parquet, whole or not at all.
pub fn write_table(path: &Path, frame: &DataFrame) -> Result<(), StoreError> {
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .finish(&mut frame.clone())
        .map_err(|source| StoreError::Table { action: "write", path: path.to_owned(), source })?;
    Ok(write_file(path, &bytes)?)
}

fn io_error(action: &'static str, path: &Path, source: io::Error) -> StoreError {
    FileError { action, path: path.to_owned(), source }.into()
}
