//! What floats nearby or stands on the base, and the robot has to keep out of.

use std::fmt;
use std::ops::Range;

use nalgebra::{Rotation3, Vector3};
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};
use serde::ser::Serializer;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::frame::Frame;
use crate::clearance::{Anchor, Solid};
use crate::robot::{ShapeTable, shapes_of};

/// The `[task.keep_out]` table: solids by name.
#[derive(Debug, Clone, Default)]
pub(super) struct KeepOut(Vec<(String, SolidTable)>);

/// What is kept out of under one name.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct SolidTable {
    #[serde(default)]
    frame: Frame,
    shapes: Spanned<Vec<ShapeTable>>,
}

impl KeepOut {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Where the file says so, if anything of it stands in inertial axes.
    pub(super) fn inertial(&self) -> Option<Range<usize>> {
        let mut tables = self.0.iter().map(|(_, table)| table);
        tables.find(|table| table.frame == Frame::Inertial).map(|table| table.shapes.span())
    }

    /// The solids, where inertial axes have their origin there from the system's centre of mass \[m\].
    pub(super) fn solids(&self, origin: Vector3<f64>) -> Vec<Solid> {
        let of_one = |(name, table): &(String, SolidTable)| {
            let (origin, anchor) = match table.frame {
                Frame::Inertial => (origin, Anchor::Inertial),
                Frame::Base => (Vector3::zeros(), Anchor::Base),
            };
            let moved = |shape: crate::robot::Shape| shape.moved(&origin, &Rotation3::identity());
            let shapes = shapes_of(table.shapes.get_ref()).into_iter().map(moved);
            shapes.map(|shape| Solid { name: name.clone(), shape, anchor }).collect::<Vec<_>>()
        };
        self.0.iter().flat_map(of_one).collect()
    }
}

impl Serialize for KeepOut {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, table)| (name, table)))
    }
}

impl<'de> Deserialize<'de> for KeepOut {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ByName;
        impl<'de> Visitor<'de> for ByName {
            type Value = KeepOut;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of solids by name, each with `shapes` and `frame`")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<KeepOut, A::Error> {
                let mut solids: Vec<(String, SolidTable)> = Vec::new();
                while let Some((name, table)) = map.next_entry::<String, SolidTable>()? {
                    if table.shapes.get_ref().is_empty() {
                        let message = format!("`{name}` has no shapes, expected at least one");
                        return Err(A::Error::custom(message));
                    }
                    solids.push((name, table));
                }
                Ok(KeepOut(solids))
            }
        }
        deserializer.deserialize_map(ByName)
    }
}
