//! A folder of Parquet files, each written once and whole.
//!
//! ```text
//! results/NAME/traces/BATCH.parquet   improvements of the best cost
//! results/NAME/clocks/BATCH.parquet   the wall time of each of them
//! results/NAME/runs/BATCH.parquet     one row per run; it is written last, so a batch that has it is whole
//! ```
//!
//! A batch is one run, named by its key, or several; it is there once it is in all three folders.
//! Processes need not know of each other: batches are only added, but for
//! [`compact`](Store::compact), which adds what it merges before it removes it. A run may therefore
//! stand in two batches; readers take the first. A batch of which a file is damaged is left out.

mod aside;
mod check;
mod compact;
mod damage;
mod listed;
mod name;
mod read;
mod seal;
mod stack;

use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use polars::prelude::*;

pub use compact::Compaction;
pub use damage::Damage;

use self::check::Lengths;
use self::damage::Known;
use self::name::batch_name;
use self::seal::sealed;
use self::stack::Stack;
use super::caught::caught;
use super::foreign::{Foreign, ForeignRun};
use super::plan::Plan;
use super::record::Record;
use super::specs::RunSpec;
use crate::output::{FileError, create_folder, write_file};

/// The tables, in the order in which a batch's are written.
const TABLES: [&str; 3] = ["traces", "clocks", "runs"];

/// How long the lists of a run should be, by their columns.
type OfLists = Arc<[(String, usize)]>;

/// The results of one experiment.
#[derive(Debug, Clone)]
pub struct Store {
    folder: PathBuf,
    /// A merged batch has no more runs than that.
    most_runs: usize,
    /// Locks a file against other processes.
    try_lock: fn(&File) -> Result<(), TryLockError>,
    /// How long lists of runs should be.
    lengths: Arc<Lengths>,
    /// What is known of batches.
    known: Arc<Mutex<Known>>,
}

/// A result that could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file system said no.
    #[error(transparent)]
    File(#[from] FileError),
    /// A table may be whole and cannot be read.
    #[error("{0}; until it can be, it is not known which runs are missing")]
    Unreadable(Damage),
    /// A run that a plan of imported runs has is not among those that were read.
    #[error(
        "found no run of `{optimiser}` on `{instance}` with seed {seed} in the data, expected one as planned"
    )]
    NotRead {
        /// The label of its instance.
        instance: String,
        /// The label of its optimiser.
        optimiser: String,
        /// Its seed.
        seed: u64,
    },
    /// A record could not be made into a table, or a table not be looked through.
    #[error("cannot make a table of a run")]
    Record(#[source] Cause),
}

/// An error of the library that reads and writes tables.
type Cause = Box<dyn std::error::Error + Send + Sync>;

#[doc(hidden)]
impl From<PolarsError> for StoreError {
    fn from(error: PolarsError) -> Self {
        Self::Record(error.into())
    }
}

impl Store {
    /// Opens a folder, made if need be.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        for table in TABLES {
            create_folder(&folder.join(table))?;
        }
        Ok(Self::existing(folder))
    }

    /// Whether a folder has tables.
    pub(in crate::experiment) fn is_in(folder: &Path) -> bool {
        TABLES.iter().any(|table| folder.join(table).is_dir())
    }

    /// A folder to read; where it has no tables there are no runs.
    pub fn existing(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
            most_runs: compact::MOST_RUNS,
            try_lock: File::try_lock,
            lengths: Arc::default(),
            known: Arc::default(),
        }
    }

    /// The same, knowing how long the lists of a plan's runs should be.
    #[must_use]
    pub(in crate::experiment) fn knowing_lengths_of(self, plan: &Plan) -> Self {
        let mut lengths = HashMap::new();
        let mut of_space: HashMap<(usize, String), OfLists> = HashMap::new();
        for run in &plan.runs {
            let instance = &plan.instances[run.instance];
            let space = plan.optimisers[run.optimiser].space(instance);
            let own = of_space.entry((run.instance, space));
            let own = own.or_insert_with_key(|(_, space)| instance.subject.lengths(space).into());
            lengths.insert(run.key.clone(), own.clone());
        }
        Self { lengths: Arc::new(lengths), ..self }
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
        self.write_batch(&batch_name(&keys), tables)
    }

    /// Stores the imported runs of a plan.
    pub(in crate::experiment) fn write_imported(
        &self,
        plan: &Plan,
        foreign: &Foreign,
    ) -> Result<(), StoreError> {
        let missing = |spec: &RunSpec| StoreError::NotRead {
            instance: plan.instances[spec.instance].label.clone(),
            optimiser: plan.optimisers[spec.optimiser].label.clone(),
            seed: spec.seed,
        };
        let runs = foreign.paired(plan).map_err(missing)?;
        let mut rows = 0;
        let batches = runs.chunk_by(|_, (_, next)| {
            // Counted from the first run of a batch on.
            rows += next.trace.len() + ROWS_PER_RUN;
            let is_full = rows > ROWS_PER_BATCH;
            rows = if is_full { 0 } else { rows };
            !is_full
        });
        for batch in batches {
            let record = |(spec, run): &(&RunSpec, &ForeignRun)| Record::imported(plan, spec, run);
            let records = batch.iter().map(record).collect::<PolarsResult<Vec<_>>>()?;
            self.write(records.iter())?;
        }
        Ok(())
    }

    /// Writes a batch's tables, in the order of [`TABLES`].
    fn write_batch(&self, batch: &str, tables: [Stack; 3]) -> Result<(), StoreError> {
        self.forget(batch);
        for (table, stack) in TABLES.iter().zip(tables) {
            write_table(&self.path(table, batch), stack.into_table()?)?;
        }
        Ok(())
    }

    /// Removes a batch's files, in the opposite order to writing: what is half removed counts as not there.
    fn remove_batch(&self, batch: &str) -> Result<(), StoreError> {
        self.forget(batch);
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

/// Has polars start its threads, if it has not, and says whether it could: elsewhere it would panic.
pub(crate) fn start_polars_threads() -> bool {
    let sorted = caught(|| Series::new("".into(), [1, 0]).sort(SortOptions::default()));
    matches!(sorted, Ok(Ok(_)))
}

/// An imported batch is written once it has so many rows, and each of its runs counts as some more.
const ROWS_PER_BATCH: usize = 1_000_000;
const ROWS_PER_RUN: usize = 100;

/// Tables of fewer rows are not compressed: there is little to gain, and reading takes longer.
const ROWS_TO_COMPRESS: usize = 1_000;

/// Writes a table as Parquet with a checksum, whole or not at all.
fn write_table(path: &Path, mut frame: DataFrame) -> Result<(), StoreError> {
    let compression = if frame.height() < ROWS_TO_COMPRESS {
        ParquetCompression::Uncompressed
    } else {
        ParquetCompression::Zstd(None)
    };
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).with_compression(compression).finish(&mut frame)?;
    Ok(write_file(path, &sealed(bytes))?)
}

fn io_error(action: &'static str, path: &Path, source: io::Error) -> StoreError {
    FileError { action, path: path.to_owned(), source }.into()
}
