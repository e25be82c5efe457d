//! Many small files into few large ones.

use std::collections::HashSet;
use std::fs::{File, TryLockError};

use polars::prelude::*;

use super::check::Contents;
use super::damage::Flaw;
use super::name::{is_batch, new_name};
use super::stack::{Stack, only};
use super::{Store, StoreError, TABLES, io_error};
use crate::output::{remove_old, remove_temporary, sync_folder};
use crate::search::Watch;

/// A merged batch has no more runs…
pub(super) const MOST_RUNS: usize = 10_000;
/// …and no more rows of traces than that.
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

/// Batches with the same columns on their way into one.
#[derive(Default)]
struct Merged {
    sources: Vec<String>,
    keys: Vec<String>,
    tables: [Stack; 3],
    /// Whether anything of the sources is left out.
    lacks: bool,
}

impl Merged {
    /// Whether a batch's tables have the columns of those that are here.
    fn fits(&self, tables: &[DataFrame; 3]) -> bool {
        let mut pairs = self.tables.iter().zip(tables);
        pairs.all(|(own, new)| own.schema().is_none_or(|schema| schema == new.schema()))
    }

    /// Whether a batch's tables are too many for it.
    fn overflows(&self, [traces, _, runs]: &[DataFrame; 3], most_runs: usize) -> bool {
        self.keys.len() + runs.height() > most_runs
            || self.tables[0].height() + traces.height() > MOST_ROWS
    }

    fn add(
        &mut self,
        source: String,
        keys: Vec<String>,
        tables: [DataFrame; 3],
    ) -> PolarsResult<()> {
        self.sources.push(source);
        self.keys.extend(keys);
        self.tables.iter_mut().zip(tables).try_for_each(|(own, new)| own.push(new))
    }
}

impl Store {
    /// Merges small batches into large ones. Processes that write or read meanwhile need not care. None
    /// where another process is at it.
    pub fn compact(&self, watch: &Watch) -> Result<Option<Compaction>, StoreError> {
        let before = self.batch_count()?;
        let Some(_lock) = self.lock(None)? else { return Ok(None) };
        self.merge_and_clean(watch)?;
        Ok(Some(Compaction { before, after: self.batch_count()? }))
    }

    /// Merges batches where there are so many that reading them would take long, unless another process
    /// is at it, or the file system has no locks: then many files are better than lost ones.
    pub(in crate::experiment) fn tidy(&self, watch: &Watch) -> Result<(), StoreError> {
        if self.batch_count()? > MANY
            && let Ok(Some(_lock)) = self.lock(None)
        {
            self.merge_and_clean(watch)?;
        }
        Ok(())
    }

    /// For whoever holds the lock.
    fn merge_and_clean(&self, watch: &Watch) -> Result<(), StoreError> {
        self.merge(|_| true, watch)?;
        self.remove_remains()
    }

    /// Removes runs. Where another process is merging files, `waiting` is told before it is waited for.
    pub fn remove(&self, keys: &HashSet<&str>, waiting: &dyn Fn()) -> Result<(), StoreError> {
        let _lock = self.lock(Some(waiting))?;
        self.merge(|key| !keys.contains(key), &Watch::default())
    }

    /// A lock that is held by whoever removes batches, as long as the file is open. Where another process has it:
    /// none, or, after a word to `waiting`, when that process is done.
    pub(super) fn lock(&self, waiting: Option<&dyn Fn()>) -> Result<Option<File>, StoreError> {
        let path = self.folder.join(".compacting");
        let mut options = File::options();
        options.create(true).write(true).truncate(false);
        let lock = options.open(&path).map_err(|source| io_error("open", &path, source))?;
        let error = |source| io_error("lock", &self.folder, source);
        match ((self.try_lock)(&lock), waiting) {
            (Ok(()), _) => Ok(Some(lock)),
            (Err(TryLockError::WouldBlock), None) => Ok(None),
            (Err(TryLockError::WouldBlock), Some(waiting)) => {
                waiting();
                lock.lock().map_err(error)?;
                Ok(Some(lock))
            }
            (Err(TryLockError::Error(source)), _) => Err(error(source)),
        }
    }

    /// Merges small batches, and large ones that hold what is not to be kept. What is merged is removed
    /// only when it is on the disk in its new place. A second copy of a run is left out only where this very
    /// compaction has the first.
    fn merge(&self, keep: impl Fn(&str) -> bool, watch: &Watch) -> Result<(), StoreError> {
        let mut mine = HashSet::new();
        let mut open: Vec<Merged> = Vec::new();
        for batch in self.batches()? {
            // What is not written yet is not removed either.
            if watch.is_interrupted() {
                return Ok(());
            }
            let Some((keys, tables)) = self.small(&batch, &keep) else { continue };
            let stays = |key: &str| keep(key) && !mine.contains(key);
            let lacks = !keys.iter().all(|key| stays(key));
            let (keys, tables) = if lacks {
                let [traces, clocks, runs] = &tables;
                let tables = [only(traces, stays)?, only(clocks, stays)?, only(runs, stays)?];
                (keys.into_iter().filter(|key| stays(key)).collect(), tables)
            } else {
                (keys, tables)
            };
            mine.extend(keys.iter().cloned());
            let place = open.iter().position(|merged| merged.fits(&tables));
            let place = place.unwrap_or_else(|| {
                open.push(Merged::default());
                open.len() - 1
            });
            if open[place].overflows(&tables, self.most_runs) {
                self.close(std::mem::take(&mut open[place]))?;
            }
            open[place].lacks |= lacks;
            open[place].add(batch, keys, tables)?;
        }
        open.into_iter().try_for_each(|merged| self.close(merged))
    }

    /// Removes what processes that were killed have left: temporary files, and files of batches that are in
    /// some of the folders only. What is younger may still be at work.
    fn remove_remains(&self) -> Result<(), StoreError> {
        let batches = self.batches()?;
        let is_part = |batch: &str| is_batch(batch) && !batches.contains(batch);
        let is_remains = |name: &str| name.strip_suffix(".parquet").is_some_and(is_part);
        for folder in TABLES.map(|table| self.folder.join(table)) {
            remove_temporary(&folder);
            remove_old(&folder, is_remains);
        }
        Ok(())
    }

    /// Keys and tables of a batch that is small or holds what is not to be kept; none of another, nor of
    /// one that has just vanished or is damaged.
    fn small(
        &self,
        batch: &str,
        keep: impl Fn(&str) -> bool,
    ) -> Option<(Vec<String>, [DataFrame; 3])> {
        let read = || {
            let Contents { keys, trace_rows } = &*self.contents(batch)?;
            let is_large = keys.len() >= self.most_runs || *trace_rows >= MOST_ROWS;
            if is_large && keys.iter().all(|key| keep(key)) {
                return Ok(None);
            }
            let [traces, clocks, runs] = TABLES.map(|table| self.read_file(table, batch));
            Ok(Some((keys.clone(), [traces?, clocks?, runs?])))
        };
        match read() {
            Ok(small) => small,
            Err(Flaw::Damaged(damage)) => {
                self.note(batch, damage);
                None
            }
            Err(Flaw::Gone) => None,
        }
    }

    /// Writes a merged batch, then removes what it was merged from.
    fn close(&self, merged: Merged) -> Result<(), StoreError> {
        if merged.sources.len() == 1 && !merged.lacks {
            return Ok(());
        }
        if !merged.keys.is_empty() {
            self.write_batch(&new_name(&merged.keys), merged.tables)?;
            for table in TABLES {
                sync_folder(&self.folder.join(table))?;
            }
        }
        merged.sources.iter().try_for_each(|source| self.remove_batch(source))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::fs;

    use super::*;
    use crate::experiment::schema::FORMAT;
    use crate::experiment::store::name::batch_name;
    use crate::search::Rng;

    fn key(i: usize) -> String {
        format!("{i:016x}")
    }

    /// Stores runs of one row a table, in a format of which only the keys are looked at.
    fn write(store: &Store, runs: &[usize]) {
        let keys: Vec<String> = runs.iter().map(|&run| key(run)).collect();
        let names: Vec<&str> = keys.iter().map(String::as_str).collect();
        let tables = [0, 1, 2].map(|_| {
            let mut stack = Stack::default();
            let format = vec![FORMAT + 1; runs.len()];
            stack.push(df!("key" => &keys, "format" => format).unwrap()).unwrap();
            stack
        });
        store.write_batch(&batch_name(&names), tables).unwrap();
    }

    fn check(store: &Store, expected: &HashSet<usize>) {
        let keys: HashSet<String> = expected.iter().map(|&run| key(run)).collect();
        assert_eq!(store.keys().unwrap(), keys);
        for table in TABLES {
            let frame = store.read(table, keys.iter().map(String::as_str)).unwrap();
            assert_eq!(frame.height(), keys.len(), "{table}");
        }
    }

    /// Without locks nothing is removed: many batches stay many, and runs that should go are an error.
    #[test]
    fn without_locks_nothing_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let none = |_: &File| {
            // What Linux says where a file system has none.
            let error = std::io::Error::from(std::io::ErrorKind::Unsupported);
            Err(TryLockError::Error(error))
        };
        let store = Store { try_lock: none, ..Store::open(folder.path()).unwrap() };
        (0..=MANY).for_each(|run| write(&store, &[run]));
        store.tidy(&Watch::default()).unwrap();
        assert_eq!(store.batch_count().unwrap(), MANY + 1);
        let error = store.remove(&HashSet::from([&*key(0)]), &|| {}).unwrap_err();
        assert!(error.to_string().starts_with("cannot lock"), "{error}");
        assert!(store.compact(&Watch::default()).is_err());
        check(&store, &(0..=MANY).collect());
        // A batch with a damaged file is set aside all the same: that loses nothing.
        fs::write(store.path("clocks", &key(7)), "").unwrap();
        let store = Store { try_lock: none, ..Store::existing(folder.path()) };
        assert_eq!(store.set_aside(&|| {}).unwrap().len(), 1);
        check(&store, &(0..=MANY).filter(|run| *run != 7).collect());
    }

    /// Whoever removes runs says that it waits for another, and then does.
    #[test]
    fn waiting_for_a_lock_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path()).unwrap();
        write(&store, &[1]);
        let lock = RefCell::new(store.lock(None).unwrap());
        assert!(lock.borrow().is_some() && store.compact(&Watch::default()).unwrap().is_none());
        let waiting = || drop(lock.take());
        store.remove(&HashSet::from([&*key(1)]), &waiting).unwrap();
        assert!(lock.borrow().is_none());
        check(&store, &HashSet::new());
    }

    /// Batches of all sizes, many with runs that others have too, as compactions that were killed
    /// leave them: whatever is merged and removed, every other run is there, once.
    #[test]
    fn no_run_is_lost_and_none_is_there_twice() {
        let mut rng = Rng::new(40);
        for _ in 0..40 {
            let folder = tempfile::tempdir().unwrap();
            let store = Store { most_runs: 5, ..Store::open(folder.path()).unwrap() };
            let mut expected = HashSet::new();
            for _ in 0..6 {
                for _ in 0..=rng.index(4) {
                    let (first, count) = (rng.index(25), 1 + rng.index(7));
                    let runs: Vec<usize> = (first..first + count).collect();
                    write(&store, &runs);
                    expected.extend(runs);
                }
                check(&store, &expected);
                if rng.index(3) == 0 {
                    let gone: Vec<usize> = (0..3).map(|_| rng.index(30)).collect();
                    let keys: Vec<String> = gone.iter().map(|&run| key(run)).collect();
                    store.remove(&keys.iter().map(String::as_str).collect(), &|| {}).unwrap();
                    expected.retain(|run| !gone.contains(run));
                } else {
                    store.compact(&Watch::default()).unwrap().unwrap();
                }
                check(&store, &expected);
            }
        }
    }
}
