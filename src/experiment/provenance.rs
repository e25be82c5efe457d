//! What determines imported instances.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::value::Value;

/// The kind of imported subjects.
pub(super) const IMPORTED_KIND: &str = "imported";

/// The name of the suite in exported files.
pub const EXPORTED_SUITE: &str = "driftless";

/// The numbers of exported functions and instances that are worked out; readers count in 16 bits.
pub(super) const WORKED_OUT: RangeInclusive<u32> = 10_001..=65_535;

/// What determines an imported instance, and tells it from all others.
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The suite; empty where the data name none.
    pub suite: String,
    /// The function's number in the suite; none where functions have none.
    pub function: Option<u32>,
    /// The function's name; empty where the data name none.
    pub name: String,
    /// The number of variables, if it is known.
    pub dimension: Option<u64>,
    /// The instance's number, if it has one.
    pub instance: Option<u32>,
    /// What tells the exported instance from all others, where the data are an export of this program that has it: numbers that are
    /// worked out may be the same for several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
}

impl Provenance {
    /// Whether an export of this program has made the data.
    pub fn is_exported(&self) -> bool {
        self.suite == EXPORTED_SUITE && self.function.is_some()
    }

    /// Whether the least cost that is known of it is the least that there is. Of a task it is the best that anybody has found.
    pub(super) fn has_least_cost(&self) -> bool {
        !self.function.is_some_and(|number| self.is_exported() && WORKED_OUT.contains(&number))
    }

    /// The function with its suite, as tables have it.
    pub(super) fn subject(&self) -> String {
        let number = self.function.map(|number| format!("f{number}"));
        let parts = match number {
            Some(number) if self.is_exported() && self.name.is_empty() => vec![number],
            Some(number) if !self.is_exported() => {
                vec![self.suite.clone(), number, self.name.clone()]
            }
            _ => vec![self.name.clone()],
        };
        parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// What tells the instance from others in tables, but for those of the same number.
    pub(super) fn label(&self) -> String {
        with(self.group(), "instance", self.instance.map(u64::from))
    }

    /// The group of those that differ in their number alone.
    pub(super) fn group(&self) -> String {
        with(self.subject(), "dimension", self.dimension)
    }

    /// The function alone.
    pub(super) fn function_identity(&self) -> Identity {
        let number = self.function.map_or(Value::None, |number| u64::from(number).into());
        Identity::new()
            .with("suite", self.suite.as_str())
            .with("function", number)
            .with("name", self.name.as_str())
    }

    /// All of it.
    pub(super) fn identity(&self) -> Identity {
        Identity::of(serde_json::to_value(self).unwrap_or_default())
    }
}

/// A text and, behind it, a value with its name, if there is one.
fn with(text: String, name: &str, value: Option<u64>) -> String {
    match value {
        Some(value) if text.is_empty() => format!("{name}={value}"),
        Some(value) => format!("{text} {name}={value}"),
        None => text,
    }
}
