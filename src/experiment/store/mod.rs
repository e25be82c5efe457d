//! A folder of Parquet files, each written once and whole.
//!
//! ```text
//! results/NAME/traces/BATCH.parquet   improvements of the best cost
//! results/NAME/clocks/BATCH.parquet   the wall time of each of them
//! results/NAME/runs/BATCH.parquet     one row a run; it is written last, so a batch that has it is whole
//! ```
//!
//! A batch is one run, named by its key, or several. Processes need not know of each other: files
//! are only ever added, but for [`compact`](Store::compact), which adds what it merges before it
//! removes it. A run may therefore stand in two batches for a while; readers take the first.

mod compact;
mod stack;

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use polars::prelude::*;

pub use compact::Compaction;

use self::stack::Stack;
use super::Record;
use crate::digest::digest;
use crate::output::{FileError, create_folder, write_file};

/// The tables, in the order in which a batch's are written.
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
    #[error("cannot {action} table {}; runs whose files are removed are done again", .path.display())]
    Table {
        /// What was tried.
        action: &'static str,
        /// With which file.
        path: PathBuf,
        /// What came of it.
        source: PolarsError,
    },
    /// A record could not be made into a table, or a table not be looked through.
    #[error("cannot make a table of a run")]
    Record(#[from] PolarsError),
}

impl Store {
    /// Opens a folder, made if need be.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        for table in TABLES {
            create_folder(&folder.join(table))?;
        }
        Ok(Self::existing(folder))
    }

    /// A folder to read; where it has no tables there are no runs.
    pub fn existing(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    /// The keys of all stored runs.
    pub fn keys(&self) -> Result<HashSet<String>, StoreError> {
        let mut keys = HashSet::new();
        self.visit_batches(|batch| {
            keys.extend(self.keys_of(batch)?);
            Ok(())
        })?;
        Ok(keys)
    }

    /// Number of batches.
    pub fn batch_count(&self) -> Result<usize, StoreError> {
        Ok(self.batches()?.len())
    }

    /// Stores runs, all of them or none.
    pub fn write<'a>(&self, records: impl Iterator<Item = &'a Record>) -> Result<(), StoreError> {
        let mut keys = Vec::new();
        let mut tables: [Stack; 3] = Default::default();
        for record in records {
            keys.push(record.key.as_str());
            for (table, own) in tables.iter_mut().zip([&record.trace, &record.clock, &record.row]) {
                table.push(own.clone())?;
            }
        }
        self.write_batch(&keys, tables)
    }

    /// Shows one table's `columns` of the `wanted` runs to the visitor, batch by batch. No run is shown
    /// twice, and none that is stored is left out, though others write and compact meanwhile.
    pub fn visit(
        &self,
        table: &str,
        columns: &[&str],
        wanted: impl Fn(&str) -> bool,
        mut visitor: impl FnMut(&DataFrame) -> PolarsResult<()>,
    ) -> Result<(), StoreError> {
        let mut seen = HashSet::new();
        self.visit_batches(|batch| {
            let keys = self.keys_of(batch)?;
            let count = keys.len();
            let new: HashSet<String> =
                keys.into_iter().filter(|key| wanted(key) && !seen.contains(key)).collect();
            if new.is_empty() {
                return Ok(());
            }
            let mut frame = self.read_file(table, batch, Some(columns))?;
            if new.len() < count {
                frame = only(&frame, |key| new.contains(key))?;
            }
            visitor(&frame)?;
            seen.extend(new);
            Ok(())
        })
    }

    /// One table of the named runs, in their order; runs that are not stored are left out.
    pub fn read<'a>(
        &self,
        table: &str,
        keys: impl Iterator<Item = &'a str>,
    ) -> Result<DataFrame, StoreError> {
        let places: HashMap<&str, usize> = keys.enumerate().map(|(i, key)| (key, i)).collect();
        let mut all = Stack::default();
        self.visit(table, &[], |key| places.contains_key(key), |frame| all.push(frame.clone()))?;
        let all = all.into_table()?;
        if all.height() == 0 {
            return Ok(all);
        }
        let place = all.column("key")?.str()?.iter().map(|key| key.and_then(|k| places.get(k)));
        let place: Vec<usize> = place.map(|place| place.copied().unwrap_or(usize::MAX)).collect();
        let mut order: Vec<u32> = (0..all.height() as u32).collect();
        order.sort_by_key(|&row| place[row as usize]);
        Ok(all.take(&IdxCa::from_vec("order".into(), order))?)
    }

    /// Does something with every batch. Where one vanishes meanwhile, its runs are in another: all are gone
    /// through again.
    fn visit_batches(
        &self,
        mut visitor: impl FnMut(&str) -> Result<(), StoreError>,
    ) -> Result<(), StoreError> {
        'again: loop {
            for batch in self.batches()? {
                match visitor(&batch) {
                    Err(StoreError::File(error)) if self.has_vanished(&error, &batch) => {
                        continue 'again;
                    }
                    outcome => outcome?,
                }
            }
            return Ok(());
        }
    }

    fn has_vanished(&self, error: &FileError, batch: &str) -> bool {
        error.source.kind() == io::ErrorKind::NotFound && !self.path("runs", batch).exists()
    }

    /// The names of all batches. A folder that changes while it is listed may show neither what is
    /// removed nor what came in its place: a listing counts once none of its names has gone.
    fn batches(&self) -> Result<BTreeSet<String>, StoreError> {
        let mut before = self.list()?;
        loop {
            let now = self.list()?;
            if before.is_subset(&now) {
                return Ok(now);
            }
            before = now;
        }
    }

    fn list(&self) -> Result<BTreeSet<String>, StoreError> {
        let folder = self.folder.join("runs");
        let name = |entry: io::Result<fs::DirEntry>| -> io::Result<Option<String>> {
            let name = entry?.file_name();
            Ok(name.to_str().and_then(|name| name.strip_suffix(".parquet")).map(str::to_owned))
        };
        match fs::read_dir(&folder) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(BTreeSet::new()),
            Err(source) => Err(io_error("list", &folder, source)),
            Ok(entries) => {
                let names: io::Result<_> =
                    entries.filter_map(|entry| name(entry).transpose()).collect();
                names.map_err(|source| io_error("list", &folder, source))
            }
        }
    }

    /// The keys of a batch's runs.
    fn keys_of(&self, batch: &str) -> Result<Vec<String>, StoreError> {
        if is_key(batch) {
            return Ok(vec![batch.to_owned()]);
        }
        let frame = self.read_file("runs", batch, Some(&["key"]))?;
        Ok(frame.column("key")?.str()?.iter().flatten().map(str::to_owned).collect())
    }

    /// Reads a batch's file of a table: some columns, or, where none are named, all.
    fn read_file(
        &self,
        table: &str,
        batch: &str,
        columns: Option<&[&str]>,
    ) -> Result<DataFrame, StoreError> {
        let path = self.path(table, batch);
        let file = File::open(&path).map_err(|source| io_error("open", &path, source))?;
        let columns = columns.filter(|columns| !columns.is_empty());
        let columns = columns.map(|names| names.iter().map(|&name| name.to_owned()).collect());
        let frame = ParquetReader::new(file)
            .with_columns(columns)
            .read_parallel(ParallelStrategy::None)
            .finish();
        frame.map_err(|source| StoreError::Table { action: "read", path, source })
    }

    /// Writes a batch's tables, in the order of [`TABLES`].
    fn write_batch(&self, keys: &[&str], tables: [Stack; 3]) -> Result<(), StoreError> {
        let batch = batch_name(keys);
        for (table, stack) in TABLES.iter().zip(tables) {
            write_table(&self.path(table, &batch), stack.into_table()?)?;
        }
        Ok(())
    }

    /// Removes a batch's files, in the opposite order to writing: what is half removed counts as not there.
    fn remove_batch(&self, batch: &str) -> Result<(), StoreError> {
        for table in TABLES.iter().rev() {
            let path = self.path(table, batch);
            match fs::remove_file(&path) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => {
                    return Err(io_error("remove", &path, e));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn path(&self, table: &str, batch: &str) -> PathBuf {
        self.folder.join(table).join(format!("{batch}.parquet"))
    }
}

/// The key of the only run, or a name of its own.
fn batch_name(keys: &[&str]) -> String {
    match keys {
        [key] => (*key).to_owned(),
        _ => format!("batch-{}", digest(&keys.join(" "))),
    }
}

/// Whether a batch of this name is one run.
fn is_key(batch: &str) -> bool {
    !batch.starts_with("batch-")
}

/// The rows of some runs.
fn only(frame: &DataFrame, wanted: impl Fn(&str) -> bool) -> PolarsResult<DataFrame> {
    let keys = frame.column("key")?.str()?;
    let mask: BooleanChunked = keys.iter().map(|key| Some(key.is_some_and(&wanted))).collect();
    frame.filter(&mask)
}

/// Tables of fewer rows are not compressed: there is little to gain, and reading takes longer.
const ROWS_TO_COMPRESS: usize = 1_000;

/// Writes a table as Parquet, whole or not at all.
fn write_table(path: &Path, mut frame: DataFrame) -> Result<(), StoreError> {
    let compression = if frame.height() < ROWS_TO_COMPRESS {
        ParquetCompression::Uncompressed
    } else {
        ParquetCompression::Zstd(None)
    };
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes)
        .with_compression(compression)
        .finish(&mut frame)
        .map_err(|source| StoreError::Table { action: "write", path: path.to_owned(), source })?;
    Ok(write_file(path, &bytes)?)
}

fn io_error(action: &'static str, path: &Path, source: io::Error) -> StoreError {
    FileError { action, path: path.to_owned(), source }.into()
}
