//! What a task makes of a robot: a base under it, joints that are locked, a payload.

use std::fmt;

use nalgebra::Vector3;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::base::BaseTable;
use super::follow_table::Follows;
use super::inertia::InertiaTable;
use super::link::{Body, Joint, Link, Placement};
use super::links;
use super::shape_table::{ShapeTable, shapes};
use super::tree::{MovingJoint, Robot};
use crate::input::{Document, Finite, InputError, finite_array, nearest, positive};

/// What a task makes of a robot, and the document that says so.
#[derive(Debug, Clone, Copy)]
pub struct Outfit<'a> {
    /// Where the tables stand.
    pub document: &'a Document,
    /// A base for a robot that has none.
    pub base: Option<&'a Spanned<BaseTable>>,
    /// Joints that do not move.
    pub locked: &'a Locked,
    /// Joints that follow others.
    pub follow: &'a Follows,
    /// A body that the robot carries.
    pub payload: Option<&'a Spanned<PayloadTable>>,
}

/// Joints that do not move: names, or names and positions \[° or m\].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Locked(Vec<(Spanned<String>, Option<f64>)>);

/// A body fixed to a link for the whole motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct PayloadTable {
    #[serde(deserialize_with = "positive")]
    mass: f64,
    /// About its centre of mass, in the axes of the link or the tool \[kg m²\]; a point without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inertia: Option<Spanned<InertiaTable>>,
    /// In the frame of the link or the tool \[m\].
    #[serde(default, deserialize_with = "finite_array")]
    centre_of_mass: [f64; 3],
    /// The link that carries it; the tool where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    link: Option<Spanned<String>>,
    /// In the frame of the link or the tool.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    shapes: Vec<ShapeTable>,
}

impl<'a> Outfit<'a> {
    /// The robot as its file has it.
    pub fn none(document: &'a Document) -> Self {
        static FREE: (Locked, Follows) = (Locked(Vec::new()), Follows::none());
        Self { document, base: None, locked: &FREE.0, follow: &FREE.1, payload: None }
    }

    /// The robot with the joints fixed that are locked.
    pub(super) fn lock(&self, robot: Robot) -> Result<Robot, InputError> {
        self.locked.apply(robot, self.document)
    }

    /// The robot with its payload.
    pub(crate) fn load(&self, robot: Robot) -> Result<Robot, InputError> {
        match self.payload {
            Some(payload) => self.carrying(&robot, payload),
            None => Ok(robot),
        }
    }

    fn carrying(
        &self,
        robot: &Robot,
        payload: &Spanned<PayloadTable>,
    ) -> Result<Robot, InputError> {
        let PayloadTable { mass, inertia, centre_of_mass, link, shapes: tables } =
            payload.get_ref();
        let (parent, placement) = match link {
            Some(name) => (links::find(name, robot.links(), self.document)?, Placement::identity()),
            None => (robot.tool().link, robot.tool().placement.clone()),
        };
        let matrix = inertia.as_ref().map(|inertia| inertia.get_ref().matrix());
        let body = Body { shapes: shapes(tables), ..Body::new(*mass, matrix.unwrap_or_default()) };
        if let Some(inertia) = inertia.as_ref().filter(|_| !body.is_sound()) {
            let message = "the inertia of the payload has a negative principal moment";
            return Err(self.document.error_at(inertia.span(), message, None));
        }
        let mut links = robot.links().to_vec();
        links.push(Link {
            name: "payload".to_owned(),
            parent,
            placement,
            joint: Joint::Fixed,
            body,
            centre_of_mass: Vector3::from(*centre_of_mass),
        });
        self.rebuilt(robot, links, payload.span())?
            .following(robot.follows().to_vec())
            .map_err(|error| self.document.error_at(payload.span(), error.to_string(), None))
    }

    fn rebuilt(
        &self,
        robot: &Robot,
        links: Vec<Link>,
        span: std::ops::Range<usize>,
    ) -> Result<Robot, InputError> {
        let (name, base) = (robot.name().to_owned(), robot.base().clone());
        Robot::new(name, base, links, robot.tool().clone())
            .and_then(|rebuilt| rebuilt.ignoring(robot.ignored_pairs().to_vec()))
            .map_err(|error| self.document.error_at(span, error.to_string(), None))
    }
}

impl Locked {
    /// Whether all joints may move.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a joint is among them.
    pub fn has(&self, joint: &str) -> bool {
        self.0.iter().any(|(name, _)| name.get_ref() == joint)
    }

    /// One joint that is locked at a position \[° or m\].
    pub(super) fn at(name: Spanned<String>, position: f64) -> Self {
        Self(vec![(name, Some(position))])
    }

    /// Where a joint is locked \[rad or m\], if it is.
    pub(super) fn place_of(
        &self,
        joint: &MovingJoint<'_>,
        document: &Document,
    ) -> Result<Option<f64>, InputError> {
        let found = self.0.iter().find(|(name, _)| name.get_ref() == joint.name);
        let Some((name, position)) = found else { return Ok(None) };
        let place = resting_place(joint, *position);
        place.map(Some).map_err(|message| document.error_at(name.span(), message, None))
    }

    /// Those that are not among others.
    pub(super) fn without(&self, others: &Self) -> Self {
        let own = self.0.iter().filter(|(name, _)| !others.has(name.get_ref()));
        Self(own.cloned().collect())
    }

    /// The robot with these joints fixed.
    pub(super) fn apply(&self, robot: Robot, document: &Document) -> Result<Robot, InputError> {
        let Some((first, _)) = self.0.first() else { return Ok(robot) };
        let mut links = robot.links().to_vec();
        for (name, _) in &self.0 {
            let joint = find_joint(&robot, name, document)?;
            let position = self.place_of(&joint, document)?.unwrap_or_default();
            let link = &mut links[joint.link];
            link.placement = link.placement.then(&moved(&link.joint, position));
            link.joint = Joint::Fixed;
        }
        Outfit { locked: self, ..Outfit::none(document) }.rebuilt(&robot, links, first.span())
    }
}

/// The joint of a name, of those that move.
pub(crate) fn find_joint<'a>(
    robot: &'a Robot,
    name: &Spanned<String>,
    document: &Document,
) -> Result<MovingJoint<'a>, InputError> {
    let called = name.get_ref();
    robot.joints().find(|joint| joint.name == called).ok_or_else(|| {
        let message = format!("robot `{}` has no joint `{called}` that moves", robot.name());
        let names = robot.joints().map(|joint| joint.name);
        let help = nearest(called, names).map(|name| format!("did you mean `{name}`?"));
        document.error_at(name.span(), message, help)
    })
}

/// Where a joint is locked \[rad or m\]: where the file says, or at zero or the end of its range nearest to that.
fn resting_place(joint: &MovingJoint<'_>, stated: Option<f64>) -> Result<f64, String> {
    let [lower, upper] = joint.range;
    stated.map_or_else(|| Ok(0.0_f64.clamp(lower, upper)), |stated| joint.position(stated))
}

/// Where a joint brings its link.
pub(super) fn moved(joint: &Joint, position: f64) -> Placement {
    let identity = nalgebra::Rotation3::identity();
    match joint {
        Joint::Revolute(axis) => Placement::new(
            Vector3::zeros(),
            nalgebra::Rotation3::from_axis_angle(&axis.direction, position),
        ),
        Joint::Prismatic(axis) => Placement::new(*axis.direction * position, identity),
        Joint::Fixed => Placement::identity(),
    }
}

impl Serialize for Locked {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.iter().all(|(_, position)| position.is_none()) {
            return serializer.collect_seq(self.0.iter().map(|(name, _)| name.get_ref()));
        }
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, position) in &self.0 {
            map.serialize_entry(name.get_ref(), &position.unwrap_or(0.0))?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Locked {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Names;
        impl<'de> Visitor<'de> for Names {
            type Value = Locked;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of joints, or a table of joints and positions")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Locked, A::Error> {
                let mut joints = Vec::new();
                while let Some(name) = list.next_element()? {
                    joints.push((name, None));
                }
                Ok(Locked(joints))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Locked, A::Error> {
                let mut joints = Vec::new();
                while let Some((name, Finite(position))) = table.next_entry()? {
                    joints.push((name, Some(position)));
                }
                Ok(Locked(joints))
            }
        }
        deserializer.deserialize_any(Names)
    }
}
