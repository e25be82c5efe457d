//! Reading while others write, merge and remove.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs::{self, File};
use std::io;
use std::path::PathBuf;

use polars::prelude::*;

use super::stack::Stack;
use super::{SEVERAL, Store, StoreError, TABLES, damaged, io_error};
use crate::experiment::caught::caught;
use crate::experiment::schema::runs;

impl Store {
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

    /// Shows one table's `columns` of the `wanted` runs to the visitor, batch by batch; all columns where none are named.
    /// `optional` columns are null where a batch has none of the name. No run is shown
    /// twice, and none that is stored is left out, though others write and compact meanwhile.
    #[doc(hidden)]
    pub fn visit(
        &self,
        table: &str,
        columns: &[&str],
        optional: &[&str],
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
            let mut frame = self.read_columns(table, batch, columns, optional)?;
            if new.len() < count {
                frame = only(&frame, |key| new.contains(key))?;
            }
            visitor(&frame).map_err(damaged(self.path(table, batch)))?;
            seen.extend(new);
            Ok(())
        })
    }

    /// One table of the named runs, in their order; runs that are not stored are left out.
    #[doc(hidden)]
    pub fn read<'a>(
        &self,
        table: &str,
        keys: impl Iterator<Item = &'a str>,
    ) -> Result<DataFrame, StoreError> {
        let places: HashMap<&str, usize> = keys.enumerate().map(|(i, key)| (key, i)).collect();
        let mut all = Stack::default();
        let wanted = |key: &str| places.contains_key(key);
        self.visit(table, &[], &[], wanted, |frame| all.push(frame.clone()))?;
        let all = all.into_table()?;
        if all.height() == 0 {
            return Ok(all);
        }
        let place = all.column(runs::KEY)?.str()?.iter().map(|key| key.and_then(|k| places.get(k)));
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
                    Err(error) if self.has_vanished(&error, &batch) => continue 'again,
                    outcome => outcome?,
                }
            }
            return Ok(());
        }
    }

    pub(super) fn has_vanished(&self, error: &StoreError, batch: &str) -> bool {
        let is_gone = |table: &&str| fs::symlink_metadata(self.path(table, batch)).is_err();
        matches!(error, StoreError::Damaged { .. }) && TABLES.iter().any(is_gone)
    }

    /// The names of all batches. A folder that changes while it is listed may show neither what is
    /// removed nor what came in its place: a listing counts once none of its names has gone.
    pub(super) fn batches(&self) -> Result<BTreeSet<String>, StoreError> {
        let mut before = self.list()?;
        loop {
            let now = self.list()?;
            if before.is_subset(&now) {
                return Ok(now);
            }
            before = now;
        }
    }

    /// The names that are in the folders of all tables: a batch that lacks one is being written or removed,
    /// or whoever did so was killed.
    fn list(&self) -> Result<BTreeSet<String>, StoreError> {
        let mut batches = self.list_table(TABLES[0])?;
        for table in &TABLES[1..] {
            let others = self.list_table(table)?;
            batches.retain(|batch| others.contains(batch));
        }
        Ok(batches)
    }

    fn list_table(&self, table: &str) -> Result<BTreeSet<String>, StoreError> {
        let folder = self.folder.join(table);
        let name = |entry: io::Result<fs::DirEntry>| -> io::Result<Option<String>> {
            let name = entry?.file_name();
            let batch = name.to_str().and_then(|name| name.strip_suffix(".parquet"));
            Ok(batch.filter(|batch| is_batch(batch)).map(str::to_owned))
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
    pub(super) fn keys_of(&self, batch: &str) -> Result<Vec<String>, StoreError> {
        if is_key(batch) {
            return Ok(vec![batch.to_owned()]);
        }
        let frame = self.read_file("runs", batch, Some(&[runs::KEY]))?;
        Ok(frame.column(runs::KEY)?.str()?.iter().flatten().map(str::to_owned).collect())
    }

    /// Number of rows of a batch's traces.
    pub(super) fn trace_rows(&self, batch: &str) -> Result<usize, StoreError> {
        parquet(self.path("traces", batch), |file| ParquetReader::new(file).num_rows())
    }

    /// Reads some columns of a batch's file of a table; optional ones that it lacks are null.
    fn read_columns(
        &self,
        table: &str,
        batch: &str,
        columns: &[&str],
        optional: &[&str],
    ) -> Result<DataFrame, StoreError> {
        if optional.is_empty() {
            return self.read_file(table, batch, Some(columns));
        }
        let schema = parquet(self.path(table, batch), |file| ParquetReader::new(file).schema())?;
        let (has, lacks): (Vec<&str>, Vec<&str>) =
            optional.iter().partition(|name| schema.get(name).is_some());
        let mut frame = self.read_file(table, batch, Some(&[columns, &has].concat()))?;
        for name in lacks {
            let height = frame.height();
            frame.with_column(Float64Chunked::full_null(name.into(), height).into_column())?;
        }
        Ok(frame)
    }

    /// Reads a batch's file of a table: some columns, or, where none are named, all.
    pub(super) fn read_file(
        &self,
        table: &str,
        batch: &str,
        columns: Option<&[&str]>,
    ) -> Result<DataFrame, StoreError> {
        let columns = columns.filter(|columns| !columns.is_empty());
        let columns = columns.map(|names| names.iter().map(|&name| name.to_owned()).collect());
        parquet(self.path(table, batch), |file| {
            ParquetReader::new(file)
                .with_columns(columns)
                .read_parallel(ParallelStrategy::None)
                .finish()
        })
    }
}

/// Reads something of a file. Where it is damaged, polars may panic.
fn parquet<T>(path: PathBuf, read: impl FnOnce(File) -> PolarsResult<T>) -> Result<T, StoreError> {
    let file = match File::open(&path) {
        Ok(file) => file,
        Err(error) => return Err(damaged(path)(error.into())),
    };
    match caught(|| read(file)) {
        Ok(outcome) => outcome.map_err(damaged(path)),
        Err(panic) => Err(damaged(path)(polars_err!(ComputeError: "{panic}"))),
    }
}

/// Whether a batch of this name is one run.
fn is_key(batch: &str) -> bool {
    !batch.starts_with(SEVERAL)
}

/// Whether a file's name is that of a batch; others are none of ours.
pub(super) fn is_batch(name: &str) -> bool {
    let digits = name.strip_prefix(SEVERAL).unwrap_or(name);
    digits.len() == 16 && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// The rows of some runs.
pub(super) fn only(frame: &DataFrame, wanted: impl Fn(&str) -> bool) -> PolarsResult<DataFrame> {
    let keys = frame.column(runs::KEY)?.str()?;
    let mask: BooleanChunked = keys.iter().map(|key| Some(key.is_some_and(&wanted))).collect();
    frame.filter(&mask)
}
