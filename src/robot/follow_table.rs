//! Joints that follow others, as files state them.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::link::JointKind;
use crate::input::Finite;

/// What a joint follows: a joint, or a table.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowTable {
    pub(super) joint: String,
    /// Of radians and metres.
    pub(super) multiplier: f64,
    /// In degrees, of a joint that turns, or in metres.
    pub(super) offset: Option<(JointKind, f64)>,
}

/// Joints that follow others.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Follows(Vec<(Spanned<String>, FollowTable)>);

impl FollowTable {
    /// The other joint's position and no more.
    pub(super) fn of(joint: String) -> Self {
        Self { joint, multiplier: 1.0, offset: None }
    }
}

impl Follows {
    /// No joint follows another one.
    pub(super) const fn none() -> Self {
        Self(Vec::new())
    }

    /// Whether no joint follows another one.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a joint follows another one.
    pub fn has(&self, joint: &str) -> bool {
        self.0.iter().any(|(name, _)| name.get_ref() == joint)
    }

    /// Joints and what they follow.
    pub(super) fn iter(&self) -> impl Iterator<Item = &(Spanned<String>, FollowTable)> {
        self.0.iter()
    }
}

/// A table, as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct Whole {
    joint: String,
    #[serde(default = "one", deserialize_with = "factor")]
    multiplier: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    offset_deg: Option<Finite>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    offset_m: Option<Finite>,
}

fn one() -> f64 {
    1.0
}

fn factor<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(deserializer)?;
    if is_factor(value) {
        return Ok(value);
    }
    Err(D::Error::custom(format!("found {value}, expected a finite number other than zero")))
}

/// Whether a joint that moves by so many times what another one does moves with it.
pub(super) fn is_factor(multiplier: f64) -> bool {
    multiplier.is_finite() && multiplier != 0.0
}

impl Serialize for FollowTable {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.multiplier == 1.0 && self.offset.is_none() {
            return self.joint.serialize(serializer);
        }
        let offset = |kind| self.offset.filter(|(own, _)| *own == kind).map(|(_, at)| Finite(at));
        let whole = Whole {
            joint: self.joint.clone(),
            multiplier: self.multiplier,
            offset_deg: offset(JointKind::Revolute),
            offset_m: offset(JointKind::Prismatic),
        };
        whole.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for FollowTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Leader;
        impl<'de> Visitor<'de> for Leader {
            type Value = FollowTable;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a joint, or a table with `joint`, `multiplier` and `offset_deg` or `offset_m`",
                )
            }

            fn visit_str<E: Error>(self, joint: &str) -> Result<FollowTable, E> {
                Ok(FollowTable::of(joint.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FollowTable, A::Error> {
                let Whole { joint, multiplier, offset_deg, offset_m } =
                    Whole::deserialize(MapAccessDeserializer::new(map))?;
                let offset = match (offset_deg, offset_m) {
                    (Some(_), Some(_)) => {
                        let message =
                            "found both `offset_deg` and `offset_m`, expected one of them";
                        return Err(A::Error::custom(message));
                    }
                    (Some(Finite(at)), None) => Some((JointKind::Revolute, at)),
                    (None, Some(Finite(at))) => Some((JointKind::Prismatic, at)),
                    (None, None) => None,
                };
                Ok(FollowTable { joint, multiplier, offset })
            }
        }
        deserializer.deserialize_any(Leader)
    }
}

impl Serialize for Follows {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, table) in &self.0 {
            map.serialize_entry(name.get_ref(), table)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Follows {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;
        impl<'de> Visitor<'de> for Table {
            type Value = Follows;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of joints and the joints that they follow")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Follows, A::Error> {
                let mut joints = Vec::new();
                while let Some(entry) = table.next_entry()? {
                    joints.push(entry);
                }
                Ok(Follows(joints))
            }
        }
        deserializer.deserialize_any(Table)
    }
}
