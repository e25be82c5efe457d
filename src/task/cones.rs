//! Cones, as files state them.

use std::fmt;

use nalgebra::{Unit, Vector3};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::path_limits::Cone;
use crate::input::{Finite, Positive};

/// A cone that an axis of the base has to stay in, or out of.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ConeTable {
    /// In base axes.
    axis: [Finite; 3],
    /// In inertial axes.
    from: [Finite; 3],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    within_deg: Option<Positive>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    outside_deg: Option<Positive>,
}

/// One cone, or several.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(super) enum Cones {
    One(ConeTable),
    Several(Vec<ConeTable>),
}

impl<'de> Deserialize<'de> for Cones {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrSeveral;
        impl<'de> Visitor<'de> for OneOrSeveral {
            type Value = Cones;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table with `axis`, `from` and `within_deg` or `outside_deg`, or a list of such tables")
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Cones, A::Error> {
                ConeTable::deserialize(MapAccessDeserializer::new(map)).map(Cones::One)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Cones, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(Cones::Several)
            }
        }
        deserializer.deserialize_any(OneOrSeveral)
    }
}

impl Cones {
    pub(super) fn list(&self) -> &[ConeTable] {
        match self {
            Self::One(cone) => std::slice::from_ref(cone),
            Self::Several(cones) => cones,
        }
    }
}

impl ConeTable {
    pub(super) fn build(&self) -> Result<Cone, String> {
        let unit = |key: &str, axis: [Finite; 3]| {
            Unit::try_new(Vector3::from(axis.map(|value| value.0)), f64::MIN_POSITIVE)
                .ok_or_else(|| format!("`{key}` is zero, expected a direction"))
        };
        let (degrees, outside) = match (self.within_deg, self.outside_deg) {
            (Some(within), None) => (within.0, false),
            (None, Some(outside)) => (outside.0, true),
            _ => return Err("expected one of `within_deg` and `outside_deg`".to_owned()),
        };
        if degrees >= 180.0 {
            return Err(format!("found a cone of {degrees}°, expected less than 180°"));
        }
        let angle = degrees.to_radians();
        Ok(Cone { axis: unit("axis", self.axis)?, from: unit("from", self.from)?, angle, outside })
    }
}
