//! What there is to know of a subject and of a point, as columns of the table `runs`.

use serde::{Deserialize, Serialize};

/// What was found of a run's best point.
#[derive(Debug, Clone, PartialEq)]
pub struct Judgement {
    /// Its cost.
    pub cost: f64,
    /// One value for each measure of the subject.
    pub measures: Vec<Value>,
}

/// Something to know of a subject or of a point: a column of the table `runs`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// Name of its column, such as `t_f`.
    pub name: String,
    /// What its values are.
    pub kind: ValueKind,
    /// What it means, with its unit.
    #[serde(default)]
    pub meaning: String,
    /// Its column in the tables of a report, with its unit, such as `t_f [s]`; where there is none it is only
    /// stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading: Option<String>,
    /// What to call it among what there is to know of how runs were made, if it belongs there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub provenance: Option<String>,
}

impl Quantity {
    /// A quantity that is stored and not shown.
    pub fn new(name: &str, kind: ValueKind, meaning: &str) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            meaning: meaning.to_owned(),
            heading: None,
            provenance: None,
        }
    }

    /// The same, shown in tables under this heading.
    #[must_use]
    pub fn shown(self, heading: &str) -> Self {
        Self { heading: Some(heading.to_owned()), ..self }
    }

    /// The same, shown under this name where a report says how runs were made.
    #[must_use]
    pub fn telling_provenance(self, name: &str) -> Self {
        Self { provenance: Some(name.to_owned()), ..self }
    }
}

/// What the values of a quantity are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ValueKind {
    /// Texts.
    Text,
    /// Whole numbers from 0.
    Count,
    /// Numbers.
    Real,
    /// Lists of numbers.
    Reals,
}

/// A value of a quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Value {
    /// Not known, or of no meaning here.
    None,
    /// A text.
    Text(String),
    /// A whole number from 0.
    Count(u64),
    /// A number.
    Real(f64),
    /// A list of numbers.
    Reals(Vec<f64>),
}

impl Value {
    /// The number, if it is one.
    pub fn real(&self) -> Option<f64> {
        match self {
            Self::Real(value) => Some(*value),
            Self::Count(value) => Some(*value as f64),
            _ => None,
        }
    }
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Real(value)
    }
}

impl From<Option<f64>> for Value {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::None, Self::Real)
    }
}

impl From<u64> for Value {
    fn from(value: u64) -> Self {
        Self::Count(value)
    }
}

impl From<i32> for Value {
    fn from(value: i32) -> Self {
        u64::try_from(value).map_or(Self::Real(f64::from(value)), Self::Count)
    }
}

impl From<usize> for Value {
    fn from(value: usize) -> Self {
        Self::Count(value as u64)
    }
}

impl From<String> for Value {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Self {
        Self::Text(value.to_owned())
    }
}

impl From<Vec<f64>> for Value {
    fn from(value: Vec<f64>) -> Self {
        Self::Reals(value)
    }
}
