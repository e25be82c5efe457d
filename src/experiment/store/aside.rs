//! Remembering damaged batches and moving them aside.

use std::fs;
use std::io;
use std::path::PathBuf;
use std::sync::{MutexGuard, PoisonError};

use super::damage::{Damage, Flaw, Known};
use super::{Store, StoreError, TABLES, io_error};
use crate::output::create_folder;

/// The folder of batches that were set aside; in it each has a folder of its own.
const DAMAGED: &str = "damaged";

impl Store {
    /// Where batches with a damaged file are put.
    pub fn damaged_folder(&self) -> PathBuf {
        self.folder.join(DAMAGED)
    }

    /// The files met so far that cannot be used, one per batch.
    pub fn damaged(&self) -> Vec<Damage> {
        self.known().damaged.values().cloned().collect()
    }

    pub(super) fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A batch is another from now on, or none.
    pub(super) fn forget(&self, batch: &str) {
        let mut known = self.known();
        known.sound.remove(batch);
        known.damaged.remove(batch);
    }

    /// Takes note of a batch that cannot be used.
    pub(super) fn note(&self, batch: &str, damage: Damage) {
        let mut known = self.known();
        known.sound.remove(batch);
        known.damaged.insert(batch.to_owned(), damage);
    }

    /// Moves every batch with a damaged file into a folder below `damaged/`, for its runs to be done again, and says
    /// which files are damaged. Where one may be whole and cannot be read nothing is moved, and it is an error: its runs may be
    /// there. Where another process is merging files, `waiting` is told before it is waited for.
    pub(in crate::experiment) fn set_aside(
        &self,
        waiting: &dyn Fn(),
    ) -> Result<Vec<Damage>, StoreError> {
        self.keys()?;
        let batches: Vec<String> = self.known().damaged.keys().cloned().collect();
        if batches.is_empty() {
            return Ok(Vec::new());
        }
        // Another process may have set one aside and done it again since it was looked at. Without a lock that may
        // still happen between the second look and the move, and would lose nothing: the run is done once more.
        let _lock = self.lock(Some(waiting));
        let mut damaged = Vec::new();
        for batch in batches {
            self.forget(&batch);
            match self.contents(&batch) {
                Err(Flaw::Damaged(damage)) if damage.may_be_whole => {
                    return Err(StoreError::Unreadable(damage));
                }
                Err(Flaw::Damaged(damage)) => damaged.push((batch, damage)),
                Ok(_) | Err(Flaw::Gone) => {}
            }
        }
        let moved = damaged.into_iter().map(|(batch, damage)| {
            self.move_aside(&batch)?;
            Ok(damage)
        });
        moved.collect()
    }

    /// Moves a batch's files into a new folder, in the order in which they would be removed.
    fn move_aside(&self, batch: &str) -> Result<(), StoreError> {
        let all = self.damaged_folder();
        create_folder(&all)?;
        let mut folder = all.join(batch);
        for n in 2.. {
            match fs::create_dir(&folder) {
                Ok(()) => break,
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                    folder = all.join(format!("{batch}-{n}"));
                }
                Err(e) => return Err(io_error("create", &folder, e)),
            }
        }
        for table in TABLES.iter().rev() {
            let path = self.path(table, batch);
            match fs::rename(&path, folder.join(format!("{table}.parquet"))) {
                Err(e) if e.kind() != io::ErrorKind::NotFound => {
                    return Err(io_error("move", &path, e));
                }
                _ => {}
            }
        }
        self.forget(batch);
        Ok(())
    }
}
