//! `[collision]`: which links may touch.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::link::Link;
use super::links::find;
use crate::input::{Document, InputError};

/// What is said of touching.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct CollisionTable {
    /// Pairs of links, or of a link and the base, that are never checked against each other.
    ignore: Vec<[Spanned<String>; 2]>,
}

impl CollisionTable {
    /// The pairs, `None` for the base, which `root` is another name of.
    pub(super) fn pairs(
        &self,
        links: &[Link],
        root: Option<&str>,
        document: &Document,
    ) -> Result<Vec<[Option<usize>; 2]>, InputError> {
        let place = |name: &Spanned<String>| match root {
            Some(root) if name.get_ref() == root => Ok(None),
            _ => find(name, links, document),
        };
        let pair = |[first, second]: &[Spanned<String>; 2]| {
            let pair = [place(first)?, place(second)?];
            if pair[0] == pair[1] {
                let message = format!("found `{}` twice in a pair", first.get_ref());
                return Err(document.error_at(second.span(), message, None));
            }
            Ok(pair)
        };
        self.ignore.iter().map(pair).collect()
    }
}
