//! `[[link]]`: a tree of links.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Rotation3, Unit, Vector3};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::follow_table::FollowTable;
use super::inertia::InertiaTable;
use super::link::{Axis, Body, Joint, Link, Placement};
use super::shape_table::{ShapeTable, shapes};
use super::tree::{Tool, outermost};
use crate::input::{
    Document, InputError, finite_array, interval, nearest, non_negative, optional_positive,
};

/// Most links of a robot.
pub(super) const MOST_LINKS: usize = 1000;

/// What files call the base.
pub(super) const BASE: &str = "base";

/// A link and the joint that carries it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct LinkTable {
    pub(super) name: Spanned<String>,
    /// A link that stands before; the base where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) parent: Option<Spanned<String>>,
    /// The joint's frame in the parent's \[m\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) position: [f64; 3],
    /// Yaw, pitch and roll of the frame \[°\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) zyx_deg: [f64; 3],
    /// None where it is fixed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) joint: Option<Spanned<LinkJoint>>,
    #[serde(default, skip_serializing_if = "is_nothing", deserialize_with = "non_negative")]
    pub(super) mass: f64,
    /// In the link's frame \[m\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    pub(super) centre_of_mass: [f64; 3],
    /// About the centre of mass, in the link's axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) inertia: Option<Spanned<InertiaTable>>,
    /// In the link's frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) shapes: Vec<ShapeTable>,
    /// How many meshes describe it to other programs, of which nothing is read.
    #[serde(skip)]
    pub(super) meshes: usize,
}

/// The joint of a link.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct LinkJoint {
    /// The link's where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(rename = "type")]
    pub(super) kind: Kind,
    #[serde(default = "along_z", deserialize_with = "finite_array")]
    pub(super) axis: [f64; 3],
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "range")]
    pub(super) range_deg: Option<[f64; 2]>,
    #[serde(default, skip_serializing_if = "Option::is_none", deserialize_with = "range")]
    pub(super) range_m: Option<[f64; 2]>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_positive"
    )]
    pub(super) rate_deg_s: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_positive"
    )]
    pub(super) rate_m_s: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_positive"
    )]
    pub(super) torque_n_m: Option<f64>,
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "optional_positive"
    )]
    pub(super) force_n: Option<f64>,
    /// What it follows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) mimic: Option<FollowTable>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Kind {
    /// It turns within a range.
    Revolute,
    /// It turns without an end. Its range is one turn either way.
    Continuous,
    /// It slides within a range.
    Prismatic,
    /// It does not move.
    Fixed,
}

/// The `[tool]` table.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ToolTable {
    link: Spanned<String>,
    /// The tool's frame in the link's \[m\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    position: [f64; 3],
    /// Yaw, pitch and roll of the frame \[°\].
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "finite_array")]
    zyx_deg: [f64; 3],
}

impl ToolTable {
    pub(super) fn span(&self) -> Range<usize> {
        self.link.span()
    }
}

fn is_zero(vector: &[f64; 3]) -> bool {
    *vector == [0.0; 3]
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_nothing(mass: &f64) -> bool {
    *mass == 0.0
}

fn along_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

fn range<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    interval(deserializer).map(Some)
}

/// A frame in another one, from its origin \[m\] and yaw, pitch and roll \[°\].
pub(super) fn placement(position: [f64; 3], zyx_deg: [f64; 3]) -> Placement {
    let [yaw, pitch, roll] = zyx_deg.map(f64::to_radians);
    Placement::new(position.into(), Rotation3::from_euler_angles(roll, pitch, yaw))
}

impl LinkTable {
    /// A frame on the base or on a link, without mass.
    pub(super) fn frame(name: Spanned<String>) -> Self {
        Self {
            name,
            parent: None,
            position: [0.0; 3],
            zyx_deg: [0.0; 3],
            joint: None,
            mass: 0.0,
            centre_of_mass: [0.0; 3],
            inertia: None,
            shapes: Vec::new(),
            meshes: 0,
        }
    }

    /// Makes its name, its joint's and its parent's begin so.
    pub(super) fn begin_names_with(&mut self, prefix: &str) {
        let begin = |name: &mut String| name.insert_str(0, prefix);
        begin(self.name.get_mut());
        if let Some(parent) = &mut self.parent {
            begin(parent.get_mut());
        }
        if let Some(joint) = self.joint.as_mut().map(Spanned::get_mut) {
            let leader = joint.mimic.as_mut().map(|mimic| &mut mimic.joint);
            joint.name.as_mut().into_iter().chain(leader).for_each(begin);
        }
    }

    /// Makes all of it stand at one place of a file: where that names another one.
    pub(super) fn place_at(&mut self, place: &Range<usize>) {
        fn placed<T: Clone>(value: &Spanned<T>, place: &Range<usize>) -> Spanned<T> {
            Spanned::new(place.clone(), value.get_ref().clone())
        }
        self.name = placed(&self.name, place);
        self.parent = self.parent.as_ref().map(|parent| placed(parent, place));
        self.joint = self.joint.as_ref().map(|joint| placed(joint, place));
        self.inertia = self.inertia.as_ref().map(|inertia| placed(inertia, place));
    }

    /// The joint, unless it is fixed.
    pub(super) fn moving_joint(&self) -> Option<&Spanned<LinkJoint>> {
        self.joint.as_ref().filter(|joint| joint.get_ref().kind != Kind::Fixed)
    }

    pub(super) fn joint_name(&self) -> Option<&str> {
        let name = self.moving_joint()?.get_ref().name.as_deref();
        Some(name.unwrap_or(self.name.get_ref()))
    }

    pub(super) fn placement(&self) -> Placement {
        placement(self.position, self.zyx_deg)
    }

    pub(super) fn body(&self, document: &Document) -> Result<Body, InputError> {
        let name = self.name.get_ref();
        let Some(inertia) = &self.inertia else {
            if self.mass > 0.0 {
                let message = format!("link `{name}` has a mass and no inertia");
                return Err(document.error_at(self.name.span(), message, None));
            }
            return Ok(Body { shapes: shapes(&self.shapes), ..Body::massless() });
        };
        let body = Body {
            shapes: shapes(&self.shapes),
            ..Body::new(self.mass, inertia.get_ref().matrix())
        };
        if body.is_sound() {
            return Ok(body);
        }
        let message = format!("the inertia of link `{name}` has a negative principal moment");
        Err(document.error_at(inertia.span(), message, None))
    }
}

impl LinkJoint {
    /// A joint about or along `z` of which nothing else is known.
    pub(super) fn of(kind: Kind) -> Self {
        Self {
            name: None,
            kind,
            axis: along_z(),
            range_deg: None,
            range_m: None,
            rate_deg_s: None,
            rate_m_s: None,
            torque_n_m: None,
            force_n: None,
            mimic: None,
        }
    }

    /// What is missing or out of place, in words.
    fn mistake(&self) -> Option<String> {
        use Kind::{Continuous, Prismatic, Revolute};
        let keys: [(&str, bool, &[Kind]); 6] = [
            ("range_deg", self.range_deg.is_some(), &[Revolute]),
            ("range_m", self.range_m.is_some(), &[Prismatic]),
            ("rate_deg_s", self.rate_deg_s.is_some(), &[Revolute, Continuous]),
            ("rate_m_s", self.rate_m_s.is_some(), &[Prismatic]),
            ("torque_n_m", self.torque_n_m.is_some(), &[Revolute, Continuous]),
            ("force_n", self.force_n.is_some(), &[Prismatic]),
        ];
        let kind = self.kind;
        for (key, is_given, kinds) in keys {
            if is_given && !kinds.contains(&kind) {
                return Some(format!("a {} joint has no `{key}`", kind.name()));
            }
        }
        let missing = match kind {
            Revolute if self.range_deg.is_none() => "range_deg",
            Prismatic if self.range_m.is_none() => "range_m",
            _ if self.has_no_direction() => return Some("the axis has no direction".to_owned()),
            _ => return None,
        };
        Some(format!("missing field `{missing}` of a {} joint", kind.name()))
    }

    /// Whether the axis is too short to tell where it points.
    pub(super) fn has_no_direction(&self) -> bool {
        Vector3::from(self.axis).amax() < 1e-9
    }

    fn build(&self, name: &str) -> Joint {
        // The length of a long axis, squared, may be no number.
        let axis = Vector3::from(self.axis);
        let direction =
            Unit::new_normalize(if axis.amax() > 1e9 { axis / axis.amax() } else { axis });
        let name = self.name.clone().unwrap_or_else(|| name.to_owned());
        let axis = |range: Option<[f64; 2]>, rate, effort| Axis {
            name,
            direction,
            range: range.unwrap_or([-TAU, TAU]),
            rate,
            effort,
        };
        match self.kind {
            Kind::Fixed => Joint::Fixed,
            Kind::Prismatic => Joint::Prismatic(axis(self.range_m, self.rate_m_s, self.force_n)),
            Kind::Revolute | Kind::Continuous => Joint::Revolute(axis(
                self.range_deg.map(|range| range.map(f64::to_radians)),
                self.rate_deg_s.map(f64::to_radians),
                self.torque_n_m,
            )),
        }
    }
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Fixed => "fixed",
        }
    }
}

/// The links that tables describe; those that hang on the base are placed in the mount's frame.
pub(super) fn tree(
    tables: &[LinkTable],
    mount: &Placement,
    document: &Document,
) -> Result<Vec<Link>, InputError> {
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut links = Vec::with_capacity(tables.len());
    for (i, table) in tables.iter().enumerate() {
        let name = table.name.get_ref();
        let parent = parent(table, &tables[..i], &places, document)?;
        let placement = match parent {
            None => mount.then(&table.placement()),
            Some(_) => table.placement(),
        };
        let joint = match &table.joint {
            None => Joint::Fixed,
            Some(joint) => {
                if let Some(mistake) = joint.get_ref().mistake() {
                    let message = format!("joint of link `{name}`: {mistake}");
                    return Err(document.error_at(joint.span(), message, None));
                }
                joint.get_ref().build(name)
            }
        };
        links.push(Link {
            name: name.clone(),
            parent,
            placement,
            joint,
            body: table.body(document)?,
            centre_of_mass: table.centre_of_mass.into(),
        });
        places.insert(name, i);
    }
    Ok(links)
}

fn parent(
    table: &LinkTable,
    earlier: &[LinkTable],
    places: &HashMap<&str, usize>,
    document: &Document,
) -> Result<Option<usize>, InputError> {
    let Some(parent) = &table.parent else { return Ok(None) };
    // A link may be called `base` where the base has another name.
    if parent.get_ref() == BASE && !places.contains_key(BASE) {
        return Ok(None);
    }
    places.get(parent.get_ref().as_str()).copied().map(Some).ok_or_else(|| {
        let message = format!(
            "link `{}` has the parent `{}`, expected `{BASE}` or an earlier link",
            table.name.get_ref(),
            parent.get_ref()
        );
        let names = earlier.iter().map(|link| link.name.get_ref().as_str());
        let help = nearest(parent.get_ref(), names).map(|name| format!("did you mean `{name}`?"));
        document.error_at(parent.span(), message, help)
    })
}

/// The tool that a table describes, or the outermost link.
pub(super) fn tool(
    table: Option<&ToolTable>,
    links: &[Link],
    document: &Document,
) -> Result<Tool, InputError> {
    let Some(table) = table else {
        return Ok(Tool { link: outermost(links), placement: Placement::identity() });
    };
    let ToolTable { link, position, zyx_deg } = table;
    let placement = placement(*position, *zyx_deg);
    Ok(Tool { link: find(link, links, document)?, placement })
}

/// The link of a name; none for the base.
pub(super) fn find(
    name: &Spanned<String>,
    links: &[Link],
    document: &Document,
) -> Result<Option<usize>, InputError> {
    let called = name.get_ref();
    let found = links.iter().position(|link| link.name == *called);
    if found.is_some() || called == BASE {
        return Ok(found);
    }
    let message = format!("no link `{called}`");
    let names = links.iter().map(|link| link.name.as_str());
    let help = nearest(called, names).map(|name| format!("did you mean `{name}`?"));
    let help = help.or_else(|| Some(format!("the base is called `{BASE}`")));
    Err(document.error_at(name.span(), message, help))
}
