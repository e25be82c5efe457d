//! Names of links and joints, which exports and tables tell them apart by.

use std::collections::HashSet;
use std::ops::Range;

use crate::input::{Document, InputError};

/// Names that are taken.
pub(super) struct Names<'a> {
    document: &'a Document,
    joints: HashSet<String>,
    links: HashSet<String>,
}

/// Characters that stand in no name and in no XML.
fn is_no_letter(c: char) -> bool {
    c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}')
}

impl<'a> Names<'a> {
    /// Before the first.
    pub(super) fn new(document: &'a Document) -> Self {
        Self { document, joints: HashSet::new(), links: HashSet::new() }
    }

    pub(super) fn check_joint(&mut self, name: &str, span: Range<usize>) -> Result<(), InputError> {
        self.check_letters(name, span.clone())?;
        self.check_new("joints", self.joints.contains(name), name, span)?;
        self.joints.insert(name.to_owned());
        Ok(())
    }

    pub(super) fn check_link(&mut self, name: &str, span: Range<usize>) -> Result<(), InputError> {
        self.check_letters(name, span.clone())?;
        self.check_new("links", self.links.contains(name), name, span)?;
        self.links.insert(name.to_owned());
        Ok(())
    }

    pub(super) fn check_letters(&self, name: &str, span: Range<usize>) -> Result<(), InputError> {
        if name.trim().is_empty() || name.chars().any(is_no_letter) {
            let message = "found a name without a letter, or with a control character";
            return Err(self.document.error_at(span, message, None));
        }
        Ok(())
    }

    fn check_new(
        &self,
        what: &str,
        is_taken: bool,
        name: &str,
        span: Range<usize>,
    ) -> Result<(), InputError> {
        if is_taken {
            let message = format!("found two {what} with the name `{name}`");
            return Err(self.document.error_at(span, message, None));
        }
        Ok(())
    }
}
