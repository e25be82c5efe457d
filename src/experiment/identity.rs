//! What determines something, in a written form.

use serde::{Deserialize, Serialize};

use super::value::Value;

/// Everything that determines what something does, in a written form that keys of runs are hashes of: named values, in
/// their order.
///
/// ```
/// use driftless::experiment::Identity;
///
/// let identity = Identity::new().with("curvature", 100.0).with("version", 2);
/// assert_eq!(identity.to_string(), r#"{"curvature":100.0,"version":2}"#);
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Identity(serde_json::Value);

impl Identity {
    /// Of what nothing but its name determines.
    pub fn new() -> Self {
        Self(serde_json::Value::Object(serde_json::Map::new()))
    }

    /// With another value, which takes the place of one with the same name. Numbers that are infinite or NaN are written
    /// as texts.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        if let serde_json::Value::Object(map) = &mut self.0 {
            map.insert(name.to_owned(), json(&value.into()));
        }
        self
    }

    /// From what serde makes of a value written for the purpose.
    pub(crate) fn of(value: serde_json::Value) -> Self {
        Self(value)
    }

    /// From what [`Display`](std::fmt::Display) has made of one; an error says what is no JSON.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map(Self).map_err(|error| error.to_string())
    }

    /// Written values as a type of their own; an error says what they are not.
    pub(super) fn parse<T: serde::de::DeserializeOwned>(&self) -> Result<T, String> {
        T::deserialize(&self.0).map_err(|error| error.to_string())
    }

    pub(super) fn json(&self) -> &serde_json::Value {
        &self.0
    }
}

impl std::fmt::Display for Identity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

fn json(value: &Value) -> serde_json::Value {
    let number = |number: f64| {
        serde_json::Number::from_f64(number)
            .map_or_else(|| number.to_string().into(), serde_json::Value::Number)
    };
    match value {
        Value::None => serde_json::Value::Null,
        Value::Text(text) => text.as_str().into(),
        Value::Count(count) => (*count).into(),
        Value::Real(value) => number(*value),
        Value::Reals(values) => values.iter().copied().map(number).collect(),
    }
}
