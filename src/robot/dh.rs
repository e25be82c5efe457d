//! `[[joint]]`: a chain of Denavit–Hartenberg rows.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::inertia::Inertia;
use super::link::{Axis, Body, Joint, Link, Placement};
use super::shape_table::{ShapeTable, shapes};
use super::tree::Tool;
use crate::input::{finite, finite_array, interval, positive};

/// A joint and the link that it carries.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct JointTable {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<Spanned<String>>,
    dh: DhTable,
    #[serde(deserialize_with = "interval")]
    range_deg: [f64; 2],
    #[serde(deserialize_with = "positive")]
    mass: f64,
    #[serde(deserialize_with = "finite_array")]
    centre_of_mass: [f64; 3],
    inertia: Inertia,
    /// In the frame of the centre of mass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    shapes: Vec<ShapeTable>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct DhTable {
    #[serde(default, deserialize_with = "finite")]
    offset_deg: f64,
    #[serde(deserialize_with = "finite")]
    d: f64,
    #[serde(deserialize_with = "finite")]
    a: f64,
    #[serde(deserialize_with = "finite")]
    alpha_deg: f64,
}

/// The chain that rows describe. A row's step leads from its own link to the next joint, the last row's to the tool.
pub(super) fn chain(rows: &[JointTable], mount: Placement) -> (Vec<Link>, Tool) {
    let mut placement = mount;
    let mut links = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        links.push(row.link(i, std::mem::replace(&mut placement, row.dh.placement())));
    }
    let tool = Tool { link: links.len().checked_sub(1), placement };
    (links, tool)
}

impl DhTable {
    fn placement(&self) -> Placement {
        let [offset, twist] = [self.offset_deg, self.alpha_deg].map(f64::to_radians);
        Placement::dh(offset, self.d, self.a, twist)
    }
}

impl JointTable {
    pub(super) fn given_name(&self) -> Option<&Spanned<String>> {
        self.name.as_ref()
    }

    /// The name given in the file, or one that says which joint it is.
    pub(super) fn name(&self, index: usize) -> String {
        let given = self.name.as_ref().map(|name| name.get_ref().clone());
        given.unwrap_or_else(|| format!("joint{}", index + 1))
    }

    fn link(&self, index: usize, placement: Placement) -> Link {
        let name = self.name(index);
        let range = self.range_deg.map(f64::to_radians);
        Link {
            joint: Joint::Revolute(Axis::new(name.clone(), Vector3::z_axis(), range)),
            name,
            parent: index.checked_sub(1),
            placement,
            body: Body { shapes: shapes(&self.shapes), ..Body::new(self.mass, self.inertia.0) },
            centre_of_mass: Vector3::from(self.centre_of_mass),
        }
    }
}
