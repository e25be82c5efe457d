//! The kinds of subjects that a program knows, and what each reads of an experiment file.

use std::fmt;
use std::sync::Arc;

use super::subject::Instance;
use crate::input::{Document, InputError};

/// A kind of subjects.
pub trait Kind: Send + Sync {
    /// Its name, the [`kind`](super::Subject::kind) of its subjects.
    fn name(&self) -> &'static str;

    /// The keys of an experiment file that are its own.
    fn keys(&self) -> &'static [&'static str];

    /// The formulations that its subjects have; none where there is but one.
    fn spaces(&self) -> &'static [&'static str] {
        &[]
    }

    /// Reads its keys of an experiment file; those of others are none of its business.
    fn read(&self, document: &Document) -> Result<Arc<dyn Source>, InputError>;
}

/// What a kind has read of an experiment file: where instances come from.
pub trait Source: fmt::Debug + Send + Sync {
    /// The instances.
    fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError>;

    /// How many instances it gives, as far as can be told without making them.
    fn count(&self) -> u64 {
        1
    }

    /// The keys as a TOML file has them, with every default filled in; or what went wrong.
    fn written(&self) -> Result<String, String>;

    /// Whether it sets budgets of its own.
    fn sets_budgets(&self) -> bool {
        false
    }

    /// The same without budgets of its own.
    fn without_budgets(&self) -> Option<Arc<dyn Source>> {
        None
    }

    /// The same as it stands in a folder of results, and the files that it needs there, by name, with their texts.
    #[expect(clippy::type_complexity, reason = "a source, and files by name")]
    fn kept(
        &self,
        document: &Document,
    ) -> Result<Option<(Arc<dyn Source>, Vec<(String, String)>)>, InputError> {
        let _ = document;
        Ok(None)
    }
}

/// The kinds of subjects that a program knows. An experiment file that has keys of none is of the first.
#[derive(Clone, Default)]
pub struct Registry {
    kinds: Vec<Arc<dyn Kind>>,
}

impl fmt::Debug for Registry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.kinds.iter().map(|kind| kind.name())).finish()
    }
}

impl Registry {
    /// Without any kind.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more kind.
    #[must_use]
    pub fn with(mut self, kind: Arc<dyn Kind>) -> Self {
        self.kinds.push(kind);
        self
    }

    /// All keys of experiment files that are some kind's.
    pub(super) fn keys(&self) -> impl Iterator<Item = &'static str> {
        self.kinds.iter().flat_map(|kind| kind.keys().iter().copied())
    }

    /// The kind whose keys a file has, or the first; keys of two kinds are an error.
    pub(super) fn kind_of(&self, document: &Document) -> Result<Option<&dyn Kind>, InputError> {
        let has = |kind: &Arc<dyn Kind>| -> Result<Option<&'static str>, InputError> {
            for key in kind.keys() {
                if document.key(key)?.is_some() {
                    return Ok(Some(*key));
                }
            }
            Ok(None)
        };
        let mut found: Option<(&Arc<dyn Kind>, &'static str)> = None;
        for kind in self.kinds.iter().rev() {
            if let Some(key) = has(kind)? {
                if let Some((_, first)) = found {
                    let place = document.key(key)?.unwrap_or(0..0);
                    let message = format!("found both `{first}` and `{key}`, expected one of them");
                    return Err(document.error_at(place, message, None));
                }
                found = Some((kind, key));
            }
        }
        let kind = found.map(|(kind, _)| kind).or_else(|| self.kinds.first());
        Ok(kind.map(|kind| &**kind))
    }
}
