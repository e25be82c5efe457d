//! Files that cannot be used, and what is known of batches.

use std::collections::{BTreeMap, HashMap};
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use super::check::Contents;

/// A stored file that cannot be used. The other two files of its batch are not used either.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Damage {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it, to be read behind its name.
    pub reason: String,
    /// Whether it may be whole: the system did not let it be read.
    pub may_be_whole: bool,
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.path.display(), self.reason)
    }
}

/// Why a batch is of no use.
#[derive(Debug)]
pub(super) enum Flaw {
    /// It is there no more; its runs are in another.
    Gone,
    /// One of its files cannot be used.
    Damaged(Damage),
}

/// What is known of batches that were looked through. They are never written to again, but a batch that was set
/// aside may be done again under its name.
#[derive(Debug, Default)]
pub(super) struct Known {
    pub(super) sound: HashMap<String, Arc<Contents>>,
    pub(super) damaged: BTreeMap<String, Damage>,
}
