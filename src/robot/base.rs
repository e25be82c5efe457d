//! `[base]`: what floats.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::inertia::Inertia;
use super::link::{Body, Placement};
use super::links::placement;
use super::shape_table::{ShapeTable, shapes};
use crate::input::{Document, Finite, InputError, finite_array, positive};

/// A base that floats freely.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct BaseTable {
    #[serde(deserialize_with = "positive")]
    mass: f64,
    inertia: Inertia,
    /// Where what it carries sits \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mount: Option<[Finite; 3]>,
    /// Yaw, pitch and roll of that \[°\].
    #[serde(default, deserialize_with = "finite_array")]
    mount_zyx_deg: [f64; 3],
    /// In base axes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    shapes: Vec<ShapeTable>,
}

impl BaseTable {
    /// Whether the table says where what it carries sits.
    pub(super) fn states_mount(&self) -> bool {
        self.mount.is_some() || self.mount_zyx_deg != [0.0; 3]
    }
}

/// A base, and the document that it stands in.
pub(super) struct Mounted<'a> {
    table: &'a Spanned<BaseTable>,
    document: &'a Document,
}

impl<'a> Mounted<'a> {
    pub(super) fn of(table: &'a Spanned<BaseTable>, document: &'a Document) -> Self {
        Self { table, document }
    }

    pub(super) fn body(&self) -> Body {
        let BaseTable { mass, inertia, shapes: tables, .. } = self.table.get_ref();
        Body { shapes: shapes(tables), ..Body::new(*mass, inertia.0) }
    }

    pub(super) fn mount(&self) -> Result<Placement, InputError> {
        if self.table.get_ref().mount.is_none() {
            let message = "missing field `mount`";
            return Err(self.document.error_at(self.table.span(), message, None));
        }
        Ok(self.mount_if_any())
    }

    pub(super) fn mount_if_any(&self) -> Placement {
        let BaseTable { mount, mount_zyx_deg, .. } = self.table.get_ref();
        let position = mount.map_or([0.0; 3], |mount| mount.map(|entry| entry.0));
        placement(position, *mount_zyx_deg)
    }
}
