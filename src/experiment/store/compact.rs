//! Many small files into few large ones.

use std::collections::HashSet;

use polars::prelude::*;

use super::{Stack, Store, StoreError, TABLES, batch_name, only};
use crate::output::sync_folder;

/// A merged batch is closed once it has so many runs…
const MOST_RUNS: usize = 10_000;
/// …or so many rows of traces.
const MOST_ROWS: usize = 1_000_000;

/// More batches than that are worth a compaction.
const MANY: usize = 1_000;

/// What a compaction did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Compaction {
    /// Batches before.
    pub before: usize,
    /// Batches after.
    pub after: usize,
}

/// Batches on their way into one.
#[derive(Default)]
struct Merged {
    sources: Vec<String>,
    keys: Vec<String>,
    tables: [Stack; 3],
}

impl Merged {
    fn is_full(&self) -> bool {
        let [traces, _, runs] = &self.tables;
        is_large(traces.height(), runs.height())
    }

    /// Whether a batch's tables have the columns of those that are here.
    fn fits(&self, tables: &[DataFrame; 3]) -> bool {
        let mut pairs = self.tables.iter().zip(tables);
        pairs.all(|(own, new)| own.schema().is_none_or(|schema| schema == new.schema()))
    }

    fn add(&mut self, batch: String, tables: [DataFrame; 3]) -> PolarsResult<()> {
        self.sources.push(batch);
        self.keys.extend(keys(&tables[2])?);
        self.tables.iter_mut().zip(tables).try_for_each(|(own, new)| own.push(new))
    }
}

fn is_large(traces: usize, runs: usize) -> bool {
    runs >= MOST_RUNS || traces >= MOST_ROWS
}

/// The keys of a table of runs.
fn keys(runs: &DataFrame) -> PolarsResult<Vec<String>> {
    Ok(runs.column("key")?.str()?.iter().flatten().map(str::to_owned).collect())
}

impl Store {
    /// Merges small batches into large ones. Processes that write or read meanwhile need not care.
    pub fn compact(&self) -> Result<Compaction, StoreError> {
        let before = self.batch_count()?;
        self.merge(|_| true)?;
        Ok(Compaction { before, after: self.batch_count()? })
    }

    /// Merges batches where there are so many that reading them would take long.
    pub(crate) fn tidy(&self) -> Result<(), StoreError> {
        if self.batch_count()? > MANY { self.merge(|_| true) } else { Ok(()) }
    }

    /// Removes runs.
    pub fn remove(&self, keys: &HashSet<&str>) -> Result<(), StoreError> {
        self.merge(|key| !keys.contains(key))
    }

    /// Merges small batches, and large ones that hold what is not to be kept. What is merged is removed
    /// only when it is on the disk in its new place.
    fn merge(&self, keep: impl Fn(&str) -> bool) -> Result<(), StoreError> {
        let mut kept = HashSet::new();
        let mut merged = Merged::default();
        for batch in self.batches()? {
            let Some(tables) = self.tables_of(&batch)? else { continue };
            let mine = keys(&tables[2])?;
            let stays = |key: &str| keep(key) && !kept.contains(key);
            let all_stay = mine.iter().all(|key| stays(key));
            if all_stay && is_large(tables[0].height(), mine.len()) {
                kept.extend(mine);
                continue;
            }
            let tables = if all_stay {
                tables
            } else {
                let [traces, clocks, runs] = &tables;
                [only(traces, stays)?, only(clocks, stays)?, only(runs, stays)?]
            };
            if merged.is_full() || !merged.fits(&tables) {
                self.close(std::mem::take(&mut merged))?;
            }
            merged.add(batch, tables)?;
            kept.extend(mine);
        }
        self.close(merged)
    }

    /// All tables of a batch, unless another process has just merged it.
    fn tables_of(&self, batch: &str) -> Result<Option<[DataFrame; 3]>, StoreError> {
        let read = || -> Result<[DataFrame; 3], StoreError> {
            let [traces, clocks, runs] = TABLES.map(|table| self.read_file(table, batch, None));
            Ok([traces?, clocks?, runs?])
        };
        match read() {
            Err(StoreError::File(error)) if self.has_vanished(&error, batch) => Ok(None),
            tables => tables.map(Some),
        }
    }

    /// Writes a merged batch, then removes what it was merged from.
    fn close(&self, merged: Merged) -> Result<(), StoreError> {
        let keys: Vec<&str> = merged.keys.iter().map(String::as_str).collect();
        let name = batch_name(&keys);
        if merged.sources == [name.as_str()] {
            return Ok(());
        }
        if !keys.is_empty() {
            self.write_batch(&keys, merged.tables)?;
            for table in TABLES {
                sync_folder(&self.folder.join(table))?;
            }
        }
        let mut others = merged.sources.iter().filter(|source| **source != name);
        others.try_for_each(|source| self.remove_batch(source))
    }
}
