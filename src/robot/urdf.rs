//! Robots as URDF, the format of ROS: links and joints in XML.

use std::ops::Range;

use roxmltree::{Attribute, Node, ParsingOptions};
use toml::Spanned;

use super::follow_table::{FollowTable, is_factor};
use super::graph::{Graph, UrdfJoint};
use super::inertia::InertiaTable;
use super::link::JointKind;
use super::links::{Kind, LinkJoint, LinkTable};
use super::xml::{Element, Reader, is_of};
use crate::input::{Document, InputError, nearest};

/// Most elements within each other.
const DEEPEST: usize = 200;

/// Most XML nodes of a file.
const MOST_NODES: u32 = 1_000_000;

/// The robot's name, and its links, the root first and each after its parent. Meshes, materials, transmissions and what else the
/// format has beside links, joints and simple shapes are left out.
pub(super) fn read(document: &Document) -> Result<(String, Vec<LinkTable>), InputError> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES };
    let text = document.text();
    // The parser goes into elements by recursion.
    if let Some(place) = too_deep(text) {
        let message = format!("found elements nested more than {DEEPEST} deep");
        return Err(document.error_at(place..place + 1, message, None));
    }
    let xml = roxmltree::Document::parse_with_options(text, options)
        .map_err(|error| syntax_error(document, &error))?;
    let reader = Reader { document };
    let robot = xml.root_element();
    reader.check_root(robot)?;
    let mut graph = Graph::default();
    for element in robot.children().filter(Node::is_element) {
        reader.check_expanded(element)?;
        if !is_of(element, robot) {
            continue;
        }
        match element.tag_name().name() {
            "link" => graph.links.push(reader.link(element)?),
            "joint" => graph.joints.push(reader.joint(element)?),
            _ => {}
        }
    }
    let name = reader.text(robot, "name")?.value().to_owned();
    Ok((name, graph.ordered(robot.range(), document)?))
}

/// Where elements begin to be nested deeper than is allowed. Mistakes in the text are for the parser to find.
fn too_deep(text: &str) -> Option<usize> {
    let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
    let (mut at, mut depth) = (0, 0_usize);
    while let Some(next) = text[at..].find('<') {
        let start = at + next;
        let rest = &text[start..];
        if let Some((begin, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at = start + begin.len() + rest[begin.len()..].find(end)? + end.len();
            continue;
        }
        // A `>` within quotes ends no tag.
        let mut quote = None;
        let end = rest.char_indices().find(|(_, c)| match (quote, c) {
            (None, '>') => true,
            (None, '"' | '\'') => {
                quote = Some(*c);
                false
            }
            (Some(open), c) if open == *c => {
                quote = None;
                false
            }
            _ => false,
        })?;
        let tag = &rest[..end.0];
        if tag.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !tag.ends_with('/') && !tag.starts_with("<!") {
            depth += 1;
        }
        if depth > DEEPEST {
            return Some(start);
        }
        at = start + end.0;
    }
    None
}

fn syntax_error(document: &Document, error: &roxmltree::Error) -> InputError {
    use roxmltree::Error;
    let place = error.pos();
    let lines = document.text().split_inclusive('\n');
    let line =
        lines.clone().take(place.row.saturating_sub(1) as usize).map(str::len).sum::<usize>();
    let here = document.text().get(line..).unwrap_or_default();
    let column =
        here.chars().take(place.col.saturating_sub(1) as usize).map(char::len_utf8).sum::<usize>();
    let rest = here.get(column..).and_then(|rest| rest.chars().next());
    let start = line + column;
    let span = start..start + rest.map_or(0, char::len_utf8);
    let (message, help) = match error {
        Error::UnknownNamespace(prefix, _) if prefix == "xacro" => return xacro(document, span),
        Error::DtdDetected => (
            "found a document type (`<!DOCTYPE`), which robots have no use for".to_owned(),
            Some("take it out, with the entities that it declares".to_owned()),
        ),
        Error::NodesLimitReached => (format!("found more than {MOST_NODES} XML nodes"), None),
        _ => {
            let message = error.to_string();
            // The place is told by its own line and column.
            let is_place = |rest: &str| rest.chars().all(|c| c.is_ascii_digit() || c == ':');
            let cut = message.rsplit_once(" at ").filter(|(_, rest)| is_place(rest));
            let message = cut.map_or(message.as_str(), |(first, _)| first);
            (format!("this is not valid XML: {message}"), None)
        }
    };
    document.error_at(span, message, help)
}

fn xacro(document: &Document, span: Range<usize>) -> InputError {
    let name =
        document.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
    let stem = name.trim_end_matches(".xacro").trim_end_matches(".urdf");
    let help = format!("expand it first: `xacro {name} > {stem}-expanded.urdf`");
    document.error_at(span, "found xacro, expected the URDF that it expands to", Some(help))
}

impl Reader<'_> {
    fn check_root(&self, root: Element<'_>) -> Result<(), InputError> {
        let found = root.tag_name().name();
        if found == "robot" {
            return Ok(());
        }
        let also = match found {
            "mujoco" => ", which is MuJoCo's format",
            "sdf" => ", which is Gazebo's format",
            _ => "",
        };
        let message = format!("found `<{found}>`{also}, expected `<robot>`");
        Err(self.error(root.range(), message))
    }

    fn check_expanded(&self, element: Element<'_>) -> Result<(), InputError> {
        let is_macro = element.tag_name().namespace().is_some_and(|name| name.contains("xacro"));
        let is_open = |attribute: Attribute<'_, '_>| {
            ["${", "$("].iter().any(|sign| attribute.value().contains(sign))
        };
        let has_robot_data = matches!(element.tag_name().name(), "link" | "joint");
        let open =
            || element.descendants().find_map(|node| node.attributes().find(|a| is_open(*a)));
        if is_macro {
            return Err(xacro(self.document, element.range()));
        }
        match open().filter(|_| has_robot_data) {
            Some(attribute) => Err(xacro(self.document, attribute.range())),
            None => Ok(()),
        }
    }

    fn link(&self, element: Element<'_>) -> Result<LinkTable, InputError> {
        let mut link = LinkTable::frame(self.name(element, "name")?);
        (link.shapes, link.meshes) = self.shapes(element)?;
        let Some(inertial) = self.child(element, "inertial")? else { return Ok(link) };
        let mass = self.text(self.needed(inertial, "mass")?, "value")?;
        link.mass = self.number(mass)?;
        if link.mass < 0.0 {
            let message = format!("found a mass of {}, expected zero or above", link.mass);
            return Err(self.error(mass.range(), message));
        }
        let entries = self.needed(inertial, "inertia")?;
        let entry = |name| self.number(self.text(entries, name)?);
        let off = |name| match entries.attribute_node(name) {
            Some(attribute) => self.number(attribute),
            None => Ok(0.0),
        };
        let table = InertiaTable {
            xx: entry("ixx")?,
            yy: entry("iyy")?,
            zz: entry("izz")?,
            xy: off("ixy")?,
            xz: off("ixz")?,
            yz: off("iyz")?,
        };
        let (centre_of_mass, zyx_deg) = self.origin(inertial)?;
        link.centre_of_mass = centre_of_mass;
        let inertia = if zyx_deg == [0.0; 3] {
            table
        } else {
            let turn = super::links::placement([0.0; 3], zyx_deg).rotation();
            let turned = turn.matrix() * table.matrix() * turn.matrix().transpose();
            (0.5 * (turned + turned.transpose())).into()
        };
        link.inertia = Some(Spanned::new(entries.range(), inertia));
        link.body(self.document)?;
        Ok(link)
    }

    fn joint(&self, element: Element<'_>) -> Result<UrdfJoint, InputError> {
        let name = self.name(element, "name")?;
        let (position, zyx_deg) = self.origin(element)?;
        let of = |end| self.name(self.needed(element, end)?, "link");
        let (parent, child) = (of("parent")?, of("child")?);
        let joint = self.moving(element, &name)?;
        Ok(UrdfJoint { name, parent, child, position, zyx_deg, joint })
    }

    /// How it moves; nothing where it is floating.
    fn moving(
        &self,
        element: Element<'_>,
        name: &Spanned<String>,
    ) -> Result<Option<LinkJoint>, InputError> {
        let kind = self.text(element, "type")?;
        let kind = match kind.value() {
            "revolute" => Kind::Revolute,
            "continuous" => Kind::Continuous,
            "prismatic" => Kind::Prismatic,
            "fixed" => return Ok(Some(LinkJoint::of(Kind::Fixed))),
            "floating" => return Ok(None),
            other => {
                let message = format!(
                    "found a joint of type `{other}`, expected `revolute`, `continuous`, `prismatic` or `fixed`"
                );
                let known = ["revolute", "continuous", "prismatic", "fixed"];
                let help = nearest(other, known).map(|known| format!("did you mean `{known}`?"));
                return Err(self.document.error_at(kind.range(), message, help));
            }
        };
        let mut joint = LinkJoint { name: Some(name.get_ref().clone()), ..LinkJoint::of(kind) };
        if let Some(axis) = self.child(element, "axis")? {
            let attribute = self.text(axis, "xyz")?;
            joint.axis = self.numbers(attribute)?;
            if joint.has_no_direction() {
                return Err(self.error(attribute.range(), "the axis has no direction"));
            }
        } else {
            joint.axis = [1.0, 0.0, 0.0];
        }
        self.limit(element, &mut joint)?;
        if let Some(mimic) = self.child(element, "mimic")? {
            joint.mimic = Some(self.mimic(mimic, kind)?);
        }
        Ok(Some(joint))
    }

    fn mimic(&self, element: Element<'_>, kind: Kind) -> Result<FollowTable, InputError> {
        let mut table = FollowTable::of(self.name(element, "joint")?.into_inner());
        if let Some(attribute) = element.attribute_node("multiplier") {
            table.multiplier = self.number(attribute)?;
            if !is_factor(table.multiplier) {
                let message = "found 0 as `multiplier`, expected a number other than zero";
                return Err(self.error(attribute.range(), message));
            }
        }
        let [offset] = self.optional(Some(element), "offset")?.unwrap_or_default();
        if offset != 0.0 {
            let kind =
                if kind == Kind::Prismatic { JointKind::Prismatic } else { JointKind::Revolute };
            table.offset = Some((kind, kind.to_file_units(offset)));
        }
        Ok(table)
    }

    fn limit(&self, element: Element<'_>, joint: &mut LinkJoint) -> Result<(), InputError> {
        let limit = self.child(element, "limit")?;
        let largest = |name: &str| -> Result<Option<f64>, InputError> {
            let Some(attribute) = limit.and_then(|limit| limit.attribute_node(name)) else {
                return Ok(None);
            };
            let value = self.number(attribute)?;
            if value < 0.0 {
                let message = format!("found {value} as `{name}`, expected zero or above");
                return Err(self.error(attribute.range(), message));
            }
            // Many files have a zero where nothing is known.
            Ok((value > 0.0).then_some(value))
        };
        let (rate, effort) = (largest("velocity")?, largest("effort")?);
        if joint.kind != Kind::Continuous {
            let ends = (self.optional(limit, "lower")?, self.optional(limit, "upper")?);
            let Some((limit, [lower], [upper])) = range(limit, ends) else {
                let kind = if joint.kind == Kind::Prismatic { "prismatic" } else { "revolute" };
                let message = format!(
                    "a {kind} joint has no `<limit>` with `lower` and `upper`, which its range stands in"
                );
                let help = "a joint that turns without an end is `continuous`".to_owned();
                let help = (joint.kind == Kind::Revolute).then_some(help);
                let place = limit.unwrap_or(element).range();
                return Err(self.document.error_at(place, message, help));
            };
            if lower >= upper {
                let message = format!(
                    "found a range from {lower} to {upper}, expected `lower` below `upper`"
                );
                let help =
                    (lower == upper).then(|| "a joint that cannot move is `fixed`".to_owned());
                return Err(self.document.error_at(limit.range(), message, help));
            }
            match joint.kind {
                Kind::Prismatic => joint.range_m = Some([lower, upper]),
                _ => joint.range_deg = Some([lower, upper].map(f64::to_degrees)),
            }
        }
        if joint.kind == Kind::Prismatic {
            (joint.rate_m_s, joint.force_n) = (rate, effort);
        } else {
            (joint.rate_deg_s, joint.torque_n_m) = (rate.map(f64::to_degrees), effort);
        }
        Ok(())
    }
}

/// The limit and its ends, where it has one at least; the other is zero, as the format has it.
fn range(
    limit: Option<Element<'_>>,
    (lower, upper): (Option<[f64; 1]>, Option<[f64; 1]>),
) -> Option<(Element<'_>, [f64; 1], [f64; 1])> {
    let limit = limit.filter(|_| lower.is_some() || upper.is_some())?;
    Some((limit, lower.unwrap_or_default(), upper.unwrap_or_default()))
}
