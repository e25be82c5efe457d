//! Reading what users write: TOML with the place of every mistake, and checks that serde runs while
//! it still knows that place.

mod checked;

use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

pub use checked::{
    Finite, Fraction, NonNegative, Positive, count, count_from, finite, finite_array, fraction,
    interval, non_empty, non_negative, optional_count, optional_positive, positive,
    positive_interval, share,
};

/// A file that cannot be used, with the place in it where one is known.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum InputError {
    /// The file could not be read at all.
    #[error("cannot read {}", .path.display())]
    Read {
        /// The file asked for.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// The text is not what was expected.
    #[error("{}", .0.shown())]
    Content(Box<Mistake>),
}

/// Characters of the longest line that is shown whole.
const LONGEST_LINE: usize = 400;
/// Characters that are shown on either side of a mistake in a longer line.
const WINDOW: usize = 40;
/// Characters of the longest message.
const LONGEST_MESSAGE: usize = 800;

/// What is wrong with a text, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Mistake {
    /// What is wrong and what was expected.
    pub message: String,
    /// The text's file.
    pub path: PathBuf,
    /// The text.
    pub text: String,
    /// The bytes of the text that are wrong; empty where no place is known.
    pub span: Range<usize>,
    /// The nearest known name, where a name is unknown.
    pub help: Option<String>,
}

impl Mistake {
    /// In one line: file, line and column, message.
    fn shown(&self) -> String {
        let help = self.help.as_ref().map_or_else(String::new, |help| format!("; {help}"));
        format!("{}{}{help}", self.place(), self.message)
    }

    /// File, and line and column where they are known, with colons behind them.
    fn place(&self) -> String {
        let place = self.line_and_column();
        let place = place.map_or_else(String::new, |(line, column)| format!("{line}:{column}: "));
        format!("{}: {place}", self.path.display())
    }

    /// Where the mistake begins, counted from one, where that is known.
    pub fn line_and_column(&self) -> Option<(usize, usize)> {
        let before = self.text.get(..self.span.start).filter(|_| !self.span.is_empty())?;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        Some((before.matches('\n').count() + 1, column))
    }

    /// Place and message with what stands there, where the lines around are too long to be shown whole.
    pub fn in_a_window(&self) -> Option<String> {
        let (before, behind) = self.text.split_at_checked(self.span.start)?;
        let around = before.lines().rev().take(2).chain(behind.lines().take(3));
        let length: usize = around.map(|line| line.chars().count()).max()?;
        if length <= LONGEST_LINE {
            return None;
        }
        let line = before.rsplit('\n').next().unwrap_or_default();
        let skipped = line.chars().count().saturating_sub(WINDOW);
        let near: String = line.chars().skip(skipped).collect();
        let rest = behind.lines().next().unwrap_or_default();
        let there: String = rest.chars().take(WINDOW).collect();
        let cut = |is_cut: bool| if is_cut { "…" } else { "" };
        let (start, end) = (cut(skipped > 0), cut(there.len() < rest.len()));
        Some(format!("{}{}: `{start}{near}{there}{end}`", self.place(), self.message))
    }
}

/// A TOML text and the name to show for it.
#[derive(Debug, Clone)]
pub struct Document {
    /// Where relative paths in the text start; also the name shown in errors.
    pub path: PathBuf,
    text: String,
}

impl Document {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| InputError::Read { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// A text that is part of the program.
    pub fn embedded(name: &str, text: &str) -> Self {
        Self { path: name.into(), text: text.to_owned() }
    }

    /// The text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether the text is XML rather than TOML, which no `<` begins.
    pub fn is_xml(&self) -> bool {
        self.text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
    }

    /// Where a key stands at the top level, if it does.
    pub fn key(&self, key: &str) -> Result<Option<Range<usize>>, InputError> {
        Ok(self.table()?.get_ref().get_key_value(key).map(|(key, _)| key.span()))
    }

    /// The keys at the top level, and where they stand.
    pub fn keys(&self) -> Result<Vec<(String, Range<usize>)>, InputError> {
        let table = self.table()?;
        let key = |key: &Spanned<DeString<'_>>| (key.get_ref().to_string(), key.span());
        Ok(table.get_ref().keys().map(key).collect())
    }

    /// Parses the whole text as `T`.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        self.parse_over(&[])
    }

    /// Parses the text as `T`; every key that it leaves out, at any depth, is taken from the first
    /// of `defaults` that has it.
    pub fn parse_over<T: DeserializeOwned>(&self, defaults: &[&str]) -> Result<T, InputError> {
        self.parse_reshaped(defaults, |_| Ok(()))
    }

    /// Parses some keys of the text as `T`, on the terms of [`parse_over`](Self::parse_over).
    pub fn parse_keys<T: DeserializeOwned>(
        &self,
        keys: &[&str],
        defaults: &[&str],
    ) -> Result<T, InputError> {
        self.parse_reshaped(defaults, |table| {
            keep(table, keys);
            Ok(())
        })
    }

    /// Like [`parse_over`](Self::parse_over); the tree of keys and values is changed by `reshape` before
    /// it is parsed.
    pub(crate) fn parse_reshaped<T: DeserializeOwned>(
        &self,
        defaults: &[&str],
        reshape: impl FnOnce(&mut DeTable<'_>) -> Result<(), InputError>,
    ) -> Result<T, InputError> {
        let mut table = self.table()?;
        for text in defaults {
            let default = DeTable::parse(text).map_err(|error| self.content_error(&error))?;
            fill(table.get_mut(), default.into_inner());
        }
        reshape(table.get_mut())?;
        T::deserialize(toml::Deserializer::from(table)).map_err(|error| self.content_error(&error))
    }

    fn table(&self) -> Result<Spanned<DeTable<'_>>, InputError> {
        DeTable::parse(&self.text).map_err(|error| self.content_error(&error))
    }

    /// An error at a place in the text; the place of a default is the text's beginning.
    pub fn error_at(
        &self,
        span: Range<usize>,
        message: impl Display,
        help: Option<String>,
    ) -> InputError {
        // A long table is pointed at by its first line only.
        let marked = self.text.get(span.clone()).unwrap_or_default();
        let first_line = marked.lines().next().map_or(0, str::len);
        InputError::Content(Box::new(Mistake {
            message: short(&message.to_string()),
            path: self.path.clone(),
            text: self.text.clone(),
            span: span.start..span.start + first_line,
            help,
        }))
    }

    /// A path that stands in this file, seen from the file's own folder.
    pub fn resolve(&self, path: &str) -> PathBuf {
        self.path.parent().map_or_else(|| path.into(), |folder| folder.join(path))
    }

    fn content_error(&self, error: &toml::de::Error) -> InputError {
        let message = error.message().trim();
        self.error_at(error.span().unwrap_or(0..0), message, nearest_known_name(message))
    }
}

/// A message without what fills more than a few lines.
fn short(message: &str) -> String {
    if message.chars().count() <= LONGEST_MESSAGE {
        return message.to_owned();
    }
    let half = LONGEST_MESSAGE / 2;
    let first: String = message.chars().take(half).collect();
    let last: Vec<char> = message.chars().rev().take(half).collect();
    format!("{first} … {}", last.into_iter().rev().collect::<String>())
}

/// Leaves some keys of a table.
pub(crate) fn keep(table: &mut DeTable<'_>, keys: &[&str]) {
    let others: Vec<_> = table.keys().map(|key| key.get_ref().clone()).collect();
    for key in others.iter().filter(|key| !keys.contains(&key.as_ref())) {
        table.remove(key.as_ref());
    }
}

/// Adds to `table` what only `default` has. What comes from a default stands nowhere in the user's
/// text, hence the empty spans.
fn fill<'a>(table: &mut DeTable<'a>, default: DeTable<'a>) {
    for (key, value) in default {
        match (table.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut), value) {
            (Some(DeValue::Table(inner)), value) => {
                if let DeValue::Table(default) = value.into_inner() {
                    fill(inner, default);
                }
            }
            (Some(_), _) => {}
            (None, value) => {
                table.insert(Spanned::new(0..0, key.into_inner()), unplaced(value));
            }
        }
    }
}

/// The value as one that stands nowhere in a text.
pub(crate) fn placeless<T: Clone>(value: &Spanned<T>) -> Spanned<T> {
    Spanned::new(0..0, value.get_ref().clone())
}

/// The same value with empty spans, at any depth.
fn unplaced(value: Spanned<DeValue<'_>>) -> Spanned<DeValue<'_>> {
    let value = match value.into_inner() {
        DeValue::Array(elements) => DeValue::Array(elements.into_iter().map(unplaced).collect()),
        DeValue::Table(default) => {
            let mut table = DeTable::new();
            fill(&mut table, default);
            DeValue::Table(table)
        }
        other => other,
    };
    Spanned::new(0..0, value)
}

/// From serde's "unknown field `mas`, expected one of `mass`, …": the closest of those expected.
fn nearest_known_name(message: &str) -> Option<String> {
    let names: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (unknown, known) = names.split_first().filter(|_| message.starts_with("unknown"))?;
    nearest(unknown, known.iter().copied()).map(|name| format!("did you mean `{name}`?"))
}

/// The name of `known` closest to `name`, unless none is close. One that `name` has a word in front of is none: the rate of a
/// base is not that of a joint.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let closeness = |k: &str| strsim::jaro_winkler(name, k);
    let is_qualified = |k: &str| name.strip_suffix(k).is_some_and(|word| word.ends_with('_'));
    known
        .into_iter()
        .filter(|k| closeness(k) > 0.75 && !is_qualified(k))
        .max_by(|a, b| closeness(a).total_cmp(&closeness(b)))
}
