//! Reading what users write: TOML with the place of every mistake, and checks that serde runs while
//! it still knows that place.

use std::fmt::{self, Display};
use std::num::NonZeroU64;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};
use serde::de::{DeserializeOwned, Deserializer, Error as _, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use thiserror::Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file that cannot be used, with the place in it where one is known.
#[derive(Debug, Error, Diagnostic)]
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
    #[error("{message}")]
    Content {
        /// What is wrong and what was expected.
        message: String,
        /// The file's name and text.
        #[source_code]
        text: Arc<NamedSource<String>>,
        /// Where.
        #[label("here")]
        span: SourceSpan,
        /// The nearest known name, where a name is unknown.
        #[help]
        help: Option<String>,
    },
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

    /// Where a key stands at the top level, if it does.
    pub fn key(&self, key: &str) -> Result<Option<Range<usize>>, InputError> {
        Ok(self.table()?.get_ref().get_key_value(key).map(|(key, _)| key.span()))
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

    /// Like [`parse_over`](Self::parse_over); the tree of keys and values is changed by `reshape` before
    /// it is parsed.
    pub fn parse_reshaped<T: DeserializeOwned>(
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
        let name = self.path.display().to_string();
        InputError::Content {
            message: message.to_string(),
            text: Arc::new(NamedSource::new(name, self.text.clone()).with_language("TOML")),
            span: (span.start, first_line).into(),
            help,
        }
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

/// The name of `known` closest to `name`, unless none is close.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let closeness = |k: &str| strsim::jaro_winkler(name, k);
    known
        .into_iter()
        .filter(|k| closeness(k) > 0.75)
        .max_by(|a, b| closeness(a).total_cmp(&closeness(b)))
}

/// A number that is neither infinite nor NaN.
pub fn finite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite(), "a finite number")
}

/// A finite number above zero.
pub fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite() && value > 0.0, "a finite number above zero")
}

/// A finite number, zero or above.
pub fn non_negative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value.is_finite() && value >= 0.0, "a finite number, zero or above")
}

/// A whole number from 1 to `MOST`.
pub fn count<'de, const MOST: u64, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    count_from::<1, MOST, D, T>(deserializer)
}

/// A whole number from `LEAST` to `MOST`, where there may be none.
pub fn optional_count<'de, const LEAST: u64, const MOST: u64, D, T>(
    deserializer: D,
) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    count_from::<LEAST, MOST, D, T>(deserializer).map(Some)
}

/// A whole number from `LEAST` to `MOST`.
pub fn count_from<'de, const LEAST: u64, const MOST: u64, D, T>(
    deserializer: D,
) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: TryFrom<NonZeroU64>,
{
    let value = i64::deserialize(deserializer)?;
    let within = u64::try_from(value).ok().filter(|n| (LEAST..=MOST).contains(n));
    let count = within.and_then(NonZeroU64::new);
    count.and_then(|count| T::try_from(count).ok()).ok_or_else(|| {
        D::Error::custom(format!("found {value}, expected a whole number from {LEAST} to {MOST}"))
    })
}

/// A number from 0 to 1.
pub fn fraction<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, (0.0..=1.0).contains(&value), "a number from 0 to 1")
}

/// A number above 0, 1 at most.
pub fn share<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    check(value, value > 0.0 && value <= 1.0, "a number above 0, 1 at most")
}

/// A fixed number of finite numbers.
pub fn finite_array<'de, const N: usize, D>(deserializer: D) -> Result<[f64; N], D::Error>
where
    D: Deserializer<'de>,
    [Finite; N]: Deserialize<'de>,
{
    Ok(<[Finite; N]>::deserialize(deserializer)?.map(|f| f.0))
}

/// A finite number, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Finite(#[serde(deserialize_with = "finite")] pub f64);

/// A finite number above zero, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Positive(#[serde(deserialize_with = "positive")] pub f64);

/// A number from 0 to 1, checked where it stands in a list.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Fraction(#[serde(deserialize_with = "fraction")] pub f64);

/// One positive number for all joints, or one each.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerJoint {
    /// The same for all.
    All(f64),
    /// From the base outward.
    Each(Vec<f64>),
}

impl<'de> Deserialize<'de> for PerJoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMany;
        impl<'de> Visitor<'de> for OneOrMany {
            type Value = PerJoint;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a positive number, or a list of one for each joint")
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<PerJoint, E> {
                positive(value.into_deserializer()).map(PerJoint::All)
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<PerJoint, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<PerJoint, A::Error> {
                let mut values = Vec::new();
                while let Some(Positive(value)) = list.next_element()? {
                    values.push(value);
                }
                Ok(PerJoint::Each(values))
            }
        }
        deserializer.deserialize_any(OneOrMany)
    }
}

/// A two-element `[lower, upper]` with `lower < upper`.
pub fn interval<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    let [lower, upper] = finite_array::<2, D>(deserializer)?;
    if lower < upper {
        Ok([lower, upper])
    } else {
        Err(D::Error::custom(format!("empty range {lower} to {upper}, expected [lower, upper]")))
    }
}

/// A two-element `[lower, upper]` with `0 < lower < upper`.
pub fn positive_interval<'de, D: Deserializer<'de>>(d: D) -> Result<[f64; 2], D::Error> {
    let [lower, upper] = interval(d)?;
    check(lower, lower > 0.0, "a range above zero").map(|lower| [lower, upper])
}

fn check<E: serde::de::Error>(value: f64, good: bool, expected: &str) -> Result<f64, E> {
    if good { Ok(value) } else { Err(E::custom(format!("found {value}, expected {expected}"))) }
}
