//! Reading while others write, merge and remove.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::fs;
use std::io::{self, Cursor};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use polars::prelude::*;

use super::check::{Contents, check};
use super::damage::{Damage, Flaw};
use super::name::is_batch;
use super::seal::{Seal, seal_of};
use super::stack::{Stack, only};
use super::{Store, StoreError, TABLES, io_error};
use crate::experiment::caught::caught;
use crate::experiment::schema::runs;

/// Fewer batches than that are not worth a thread of their own.
const BATCHES_PER_THREAD: usize = 20;

impl Store {
    /// The keys of all stored runs.
    pub fn keys(&self) -> Result<HashSet<String>, StoreError> {
        let mut keys = HashSet::new();
        self.visit_batches(|_, contents| {
            keys.extend(contents.keys.iter().cloned());
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
    /// twice, and none that is stored in a batch without damage is left out, though others write and compact meanwhile.
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
        self.visit_batches(|batch, Contents { keys, .. }| {
            let is_new = |key: &&String| wanted(key) && !seen.contains(*key);
            let new: HashSet<&str> = keys.iter().filter(is_new).map(String::as_str).collect();
            if new.is_empty() {
                return Ok(());
            }
            let mut frame = self.read_columns(table, batch, columns, optional)?;
            let shown = if new.len() < keys.len() {
                only(&frame, |key| new.contains(key)).map(|own| frame = own)
            } else {
                Ok(())
            };
            let shown = shown.and_then(|()| visitor(&frame));
            shown.map_err(|error| self.damaged_file(table, batch, &error.to_string()))?;
            seen.extend(new.into_iter().map(str::to_owned));
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

    /// Does something with every batch that can be used. Where one vanishes meanwhile, its runs are in another: all are
    /// gone through again.
    fn visit_batches(
        &self,
        mut visitor: impl FnMut(&str, &Contents) -> Result<(), Flaw>,
    ) -> Result<(), StoreError> {
        'again: loop {
            let batches = self.batches()?;
            self.look_through(&batches);
            for batch in batches {
                match self.contents(&batch).and_then(|contents| visitor(&batch, &contents)) {
                    Ok(()) => {}
                    Err(Flaw::Damaged(damage)) => self.note(&batch, damage),
                    Err(Flaw::Gone) => {
                        self.forget(&batch);
                        continue 'again;
                    }
                }
            }
            return Ok(());
        }
    }

    /// Looks through many batches at a time; what comes of it is known from then on.
    fn look_through(&self, batches: &BTreeSet<String>) {
        let known = self.known();
        let is_new = |batch: &&String| {
            !known.sound.contains_key(*batch) && !known.damaged.contains_key(*batch)
        };
        let new: Vec<&String> = batches.iter().filter(is_new).collect();
        drop(known);
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(batch) = new.get(next.fetch_add(1, Ordering::Relaxed)) {
                if let Err(Flaw::Damaged(damage)) = self.contents(batch) {
                    self.note(batch, damage);
                }
            }
        };
        thread::scope(|scope| {
            let threads = thread::available_parallelism().map_or(1, usize::from);
            for _ in 1..threads.min(new.len() / BATCHES_PER_THREAD) {
                // Where there are no more threads, those that there are do all.
                let _ = thread::Builder::new().spawn_scoped(scope, work);
            }
            work();
        });
    }

    /// What a batch holds. The first time all of it is read and looked through.
    pub(super) fn contents(&self, batch: &str) -> Result<Arc<Contents>, Flaw> {
        let known = self.known();
        if let Some(contents) = known.sound.get(batch) {
            return Ok(contents.clone());
        }
        if let Some(damage) = known.damaged.get(batch) {
            return Err(Flaw::Damaged(damage.clone()));
        }
        drop(known);
        let [traces, clocks, runs] = TABLES.map(|table| self.read_file(table, batch));
        let tables = [traces?, clocks?, runs?];
        let contents = caught(|| check(batch, &tables, &self.lengths))
            .map_err(|panic| self.unreadable_file("runs", batch, &panic))?
            .map_err(|(table, reason)| self.damaged_file(table, batch, &reason))?;
        let contents = Arc::new(contents);
        self.known().sound.insert(batch.to_owned(), contents.clone());
        Ok(contents)
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

    /// Reads some columns of a batch's file of a table, all where none are named; optional ones that it lacks are null.
    fn read_columns(
        &self,
        table: &str,
        batch: &str,
        columns: &[&str],
        optional: &[&str],
    ) -> Result<DataFrame, Flaw> {
        let (bytes, seal) = self.bytes(table, batch)?;
        let read = || {
            let mut reader = ParquetReader::new(Cursor::new(&bytes));
            let schema = reader.schema()?;
            let (has, lacks): (Vec<&str>, Vec<&str>) =
                optional.iter().partition(|name| schema.get(name).is_some());
            let names = columns.iter().chain(&has).map(|&name| name.to_owned()).collect();
            let mut frame = reader
                .with_columns((!columns.is_empty()).then_some(names))
                .read_parallel(ParallelStrategy::None)
                .finish()?;
            for name in lacks {
                let height = frame.height();
                frame.with_column(Float64Chunked::full_null(name.into(), height).into_column())?;
            }
            Ok(frame)
        };
        let found: Result<DataFrame, String> = match caught(read) {
            Ok(outcome) => outcome.map_err(|error: PolarsError| error.to_string()),
            Err(panic) => Err(panic),
        };
        // What is as it was written is not damaged, whatever keeps polars from reading it.
        found.map_err(|error| match seal {
            Seal::Whole => self.unreadable_file(table, batch, &error),
            _ => self.damaged_file(table, batch, &format!("is no table that can be read: {error}")),
        })
    }

    /// Reads a batch's file of a table.
    pub(super) fn read_file(&self, table: &str, batch: &str) -> Result<DataFrame, Flaw> {
        self.read_columns(table, batch, &[], &[])
    }

    /// The bytes of a batch's file of a table, as far as its checksum tells as they were written.
    fn bytes(&self, table: &str, batch: &str) -> Result<(Vec<u8>, Seal), Flaw> {
        let path = self.path(table, batch);
        let damaged = |reason| Err(self.damaged_file(table, batch, reason));
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::NotFound => Flaw::Gone,
            _ => self.unreadable_file(table, batch, &error.to_string()),
        };
        let entry = fs::symlink_metadata(&path).map_err(failed)?;
        match fs::metadata(&path) {
            // What is not a file may block whoever opens it.
            Ok(found) if !found.is_file() => damaged("is not a file"),
            Ok(_) => {
                let bytes = fs::read(&path).map_err(failed)?;
                match seal_of(&bytes) {
                    Seal::Broken => damaged("does not match its checksum"),
                    seal => Ok((bytes, seal)),
                }
            }
            Err(error) if entry.is_symlink() && error.kind() != io::ErrorKind::PermissionDenied => {
                damaged("is a link that leads nowhere")
            }
            Err(error) => Err(failed(error)),
        }
    }

    fn damaged_file(&self, table: &str, batch: &str, reason: &str) -> Flaw {
        let path = self.path(table, batch);
        Flaw::Damaged(Damage { path, reason: reason.to_owned(), may_be_whole: false })
    }

    fn unreadable_file(&self, table: &str, batch: &str, error: &str) -> Flaw {
        let path = self.path(table, batch);
        Flaw::Damaged(Damage {
            path,
            reason: format!("cannot be read: {error}"),
            may_be_whole: true,
        })
    }
}
