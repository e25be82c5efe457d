//! Reading a robot file, and the robots that come with the program.

use std::collections::HashSet;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::base::{BaseTable, Mounted};
use super::collision::CollisionTable;
use super::dh::{self, JointTable};
use super::follow_table::Follows;
use super::followers::{Stated, resolve};
use super::link::Placement;
use super::links::{self, LinkTable, MOST_LINKS, ToolTable};
use super::names::Names;
use super::outfit::{Locked, Outfit};
use super::tree::{MovingJoint, Robot};
use super::{root, urdf};
use crate::input::{Document, InputError, finite_array};

/// The robots that come with the program: name and file.
const EMBEDDED: &[(&str, &str)] = &[
    ("xiao2023", include_str!("shipped/xiao2023.toml")),
    ("ets_vii", include_str!("shipped/ets_vii.toml")),
    ("canadarm2", include_str!("shipped/canadarm2.toml")),
    ("panda", include_str!("shipped/panda.toml")),
    ("ur5e", include_str!("shipped/ur5e.toml")),
    ("iiwa", include_str!("shipped/iiwa.toml")),
    ("dual_arm", include_str!("shipped/dual_arm.toml")),
];

impl Robot {
    /// The names of the robots that come with the program.
    pub fn embedded_names() -> impl Iterator<Item = &'static str> {
        EMBEDDED.iter().map(|(name, _)| *name)
    }

    /// The file of a robot that comes with the program.
    pub fn embedded(name: &str) -> Option<Document> {
        let (name, text) = EMBEDDED.iter().find(|(known, _)| *known == name)?;
        Some(Document::embedded(&format!("{name}.toml"), text))
    }

    /// Reads a robot.
    pub fn from_document(document: &Document) -> Result<Self, InputError> {
        RobotFile::read(document)?.build(document)
    }
}

/// A robot file: what a robot is made of, whatever it was read from. Lengths in metres, masses in kilograms, inertias in kg m².
#[derive(Debug, Clone, Serialize)]
pub struct RobotFile {
    name: String,
    #[serde(skip_serializing_if = "Locked::is_empty")]
    locked: Locked,
    #[serde(skip_serializing_if = "Follows::is_empty")]
    follow: Follows,
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<Spanned<BaseTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tool: Option<ToolTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    collision: Option<CollisionTable>,
    #[serde(flatten)]
    carried: Carried,
    /// Where the description stands.
    #[serde(skip)]
    span: Range<usize>,
}

/// What a base carries.
#[derive(Debug, Clone, Serialize)]
enum Carried {
    /// A chain of Denavit–Hartenberg rows.
    #[serde(rename = "joint")]
    Chain(Vec<JointTable>),
    /// A tree; without a `[base]` its root is the base.
    #[serde(rename = "link")]
    Tree(Vec<LinkTable>),
}

/// A robot file as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct Written {
    name: Option<String>,
    #[serde(default)]
    locked: Locked,
    #[serde(default)]
    follow: Follows,
    base: Option<Spanned<BaseTable>>,
    tool: Option<ToolTable>,
    collision: Option<CollisionTable>,
    joint: Option<Spanned<Vec<JointTable>>>,
    link: Option<Spanned<Vec<LinkTable>>>,
    urdf: Option<Spanned<String>>,
    arm: Option<Spanned<Vec<ArmTable>>>,
}

/// A URDF on a base that has several.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct ArmTable {
    urdf: Spanned<String>,
    /// What the names of its links and joints begin with.
    #[serde(default)]
    prefix: String,
    #[serde(deserialize_with = "finite_array")]
    mount: [f64; 3],
    #[serde(default, deserialize_with = "finite_array")]
    mount_zyx_deg: [f64; 3],
}

impl RobotFile {
    /// Reads a robot file: TOML, or URDF.
    pub fn read(document: &Document) -> Result<Self, InputError> {
        let file = if document.is_xml() {
            let (name, links) = urdf::read(document)?;
            Self {
                name,
                locked: Locked::default(),
                follow: Follows::default(),
                base: None,
                tool: None,
                collision: None,
                carried: Carried::Tree(links),
                span: 0..0,
            }
        } else {
            document.parse::<Written>()?.file(document)?
        };
        file.check_size(document)?;
        file.check_names(document)?;
        Ok(file)
    }

    fn check_size(&self, document: &Document) -> Result<(), InputError> {
        let found = match &self.carried {
            Carried::Chain(rows) => rows.len(),
            Carried::Tree(links) => links.len(),
        };
        if (1..=MOST_LINKS).contains(&found) {
            return Ok(());
        }
        let message = match (&self.carried, found) {
            (Carried::Chain(_), 0) => "found no joint, expected at least one".to_owned(),
            (Carried::Tree(_), 0) => "found no link, expected at least one".to_owned(),
            _ => format!("found {found} links, expected at most {MOST_LINKS}"),
        };
        Err(document.error_at(self.span.clone(), message, None))
    }

    /// Whether links, and joints that move, can be told apart by their names, which exports and tables have.
    fn check_names(&self, document: &Document) -> Result<(), InputError> {
        let mut names = Names::new(document);
        names.check_letters(&self.name, 0..0)?;
        match &self.carried {
            Carried::Chain(rows) => {
                for (i, row) in rows.iter().enumerate() {
                    let span = row.given_name().map_or_else(|| self.span.clone(), Spanned::span);
                    names.check_joint(&row.name(i), span)?;
                }
            }
            Carried::Tree(links) => {
                for link in links {
                    names.check_link(link.name.get_ref(), link.name.span())?;
                    if let (Some(name), Some(joint)) = (link.joint_name(), &link.joint) {
                        names.check_joint(name, joint.span())?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The robot.
    pub fn build(&self, document: &Document) -> Result<Robot, InputError> {
        self.build_for(document, &Outfit::none(document))
    }

    /// The robot as a task has it.
    pub fn build_for(&self, document: &Document, outfit: &Outfit<'_>) -> Result<Robot, InputError> {
        let base = match (&self.base, outfit.base) {
            (None, None) => None,
            (Some(own), None) => Some(Mounted::of(own, document)),
            (None, Some(given)) => Some(Mounted::of(given, outfit.document)),
            (Some(_), Some(given)) => {
                let message =
                    format!("found a base for robot `{}`, which has one of its own", self.name);
                return Err(outfit.document.error_at(given.span(), message, None));
            }
        };
        let root = self.root().filter(|_| base.is_none());
        let (base, links, tool) = match &self.carried {
            Carried::Chain(rows) => {
                let Some(base) = base else {
                    let message = "missing field `base`";
                    return Err(document.error_at(self.span.clone(), message, None));
                };
                if let Some(tool) = &self.tool {
                    let message = "found a tool, which the last row of a chain leads to";
                    return Err(document.error_at(tool.span(), message, None));
                }
                let (links, tool) = dh::chain(rows, base.mount()?);
                (base.body(), links, tool)
            }
            Carried::Tree(tables) => {
                let mount = match &base {
                    // Where a URDF sits nobody can guess.
                    Some(base) if outfit.base.is_some() => base.mount()?,
                    Some(base) => base.mount_if_any(),
                    None => Placement::identity(),
                };
                let links = links::tree(tables, &mount, document)?;
                let tool = links::tool(self.tool.as_ref(), &links, document)?;
                match base {
                    Some(base) => (base.body(), links, tool),
                    None => root::as_base(links, tool, |root| {
                        let place = tables.get(root).map_or(0..0, |table| table.name.span());
                        (document, place)
                    })?,
                }
            }
        };
        let ignored = match &self.collision {
            Some(collision) => collision.pairs(&links, root, document)?,
            None => Vec::new(),
        };
        let robot = Robot::new(self.name.clone(), base, links, tool)
            .and_then(|robot| robot.ignoring(ignored))
            .map_err(|error| document.error_at(self.span.clone(), error.to_string(), None))?;
        // Where a task locks a joint that the file locks, too, it is where the task says.
        let stated = self.followers(document, outfit);
        let follow = resolve(&stated, &robot, |joint| {
            let by_task = outfit.locked.place_of(joint, outfit.document)?;
            by_task.map_or_else(|| self.locked.place_of(joint, document), |at| Ok(Some(at)))
        })?;
        let robot = self.locked.without(outfit.locked).apply(robot, document)?;
        let robot = follow.lock(outfit.lock(robot)?)?;
        let robot = match (&self.carried, &self.tool) {
            (Carried::Tree(_), None) => robot.holding_its_tool_outermost(),
            _ => robot,
        };
        let robot = follow.follow(outfit.load(robot)?)?;
        self.check_carried(&robot, document)?;
        Ok(robot)
    }

    /// Whether every joint moves something, itself or by what follows it: else no motion follows from it.
    fn check_carried(&self, robot: &Robot, document: &Document) -> Result<(), InputError> {
        let Carried::Tree(tables) = &self.carried else { return Ok(()) };
        let moves_something = robot.moves_something();
        let leader =
            |(own, joint): (usize, &MovingJoint<'_>)| joint.follows.map_or(own, |f| f.leader);
        let joints: Vec<MovingJoint<'_>> = robot.joints().collect();
        let moving = joints.iter().enumerate().filter(|(_, joint)| moves_something[joint.link]);
        let led: HashSet<usize> = moving.map(leader).collect();
        let Some(idle) = robot.leading().find(|joint| !led.contains(joint)) else { return Ok(()) };
        let idle = joints[idle];
        let table = tables.iter().find(|table| table.joint_name() == Some(idle.name));
        let place = table.and_then(LinkTable::moving_joint).map_or(0..0, Spanned::span);
        let message = format!("joint `{}` moves nothing that has mass", idle.name);
        let help = format!("give its link a mass, or lock it: `locked = [{:?}]`", idle.name);
        Err(document.error_at(place, message, Some(help)))
    }

    /// The names of all joints that move.
    pub fn joint_names(&self) -> Vec<String> {
        match &self.carried {
            Carried::Chain(rows) => rows.iter().enumerate().map(|(i, row)| row.name(i)).collect(),
            Carried::Tree(links) => {
                links.iter().filter_map(|link| link.joint_name().map(str::to_owned)).collect()
            }
        }
    }

    /// The link that the others hang on, which is the base where nothing else is.
    fn root(&self) -> Option<&str> {
        let Carried::Tree(links) = &self.carried else { return None };
        links.first().map(|root| root.name.get_ref().as_str())
    }

    /// How many links have meshes for their shape and none that can be read, and how many links there are.
    pub fn links_with_meshes_alone(&self) -> (usize, usize) {
        let Carried::Tree(links) = &self.carried else { return (0, self.joint_names().len()) };
        let is_one = |link: &&LinkTable| link.meshes > 0 && link.shapes.is_empty();
        (links.iter().filter(is_one).count(), links.len())
    }

    /// The link without mass that the robot stands on, where a task has to give it a base.
    pub fn root_without_mass(&self) -> Option<&str> {
        let Carried::Tree(links) = &self.carried else { return None };
        let root = self.root().filter(|_| self.base.is_none())?;
        let (mut fixed, mut mass) = (HashSet::new(), 0.0);
        for link in links {
            let is_held = link.parent.as_ref().is_none_or(|p| fixed.contains(p.get_ref().as_str()));
            if is_held && link.moving_joint().is_none() {
                fixed.insert(link.name.get_ref().as_str());
                mass += link.mass;
            }
        }
        (mass == 0.0).then_some(root)
    }

    /// All joints that follow others, those of the task last. What a task locks follows no longer, and what is locked otherwise is
    /// where its file says, whatever its `mimic`.
    fn followers<'a>(&'a self, document: &'a Document, outfit: &Outfit<'a>) -> Vec<Stated<'a>> {
        let tables = match &self.carried {
            Carried::Chain(_) => &[][..],
            Carried::Tree(tables) => tables,
        };
        let mimics = tables.iter().filter_map(|link| {
            let (joint, place) = (link.joint_name()?, link.moving_joint()?);
            let table = place.get_ref().mimic.as_ref()?;
            Some(Stated { joint, table, document, place: place.span(), yields: true })
        });
        let own = Stated::all(&self.follow, document, Some(outfit.locked));
        mimics.chain(own).chain(Stated::all(outfit.follow, outfit.document, None)).collect()
    }
}

impl Written {
    fn file(self, document: &Document) -> Result<RobotFile, InputError> {
        let Self { name, locked, follow, base, tool, collision, joint, link, urdf, arm } = self;
        let given: Vec<(&str, Range<usize>)> = [
            ("joint", joint.as_ref().map(Spanned::span)),
            ("link", link.as_ref().map(Spanned::span)),
            ("urdf", urdf.as_ref().map(Spanned::span)),
            ("arm", arm.as_ref().map(Spanned::span)),
        ]
        .into_iter()
        .filter_map(|(key, span)| Some((key, span?)))
        .collect();
        let span = match &given[..] {
            [] => {
                let message = "missing field `joint`, `link`, `urdf` or `arm`, one of which says what the base carries";
                return Err(document.error_at(0..0, message, None));
            }
            [(_, span)] => span.clone(),
            [(first, _), (second, span), ..] => {
                let message = format!("found both `{first}` and `{second}`, expected one of them");
                return Err(document.error_at(span.clone(), message, None));
            }
        };
        let mut own_name = None;
        let carried = if let Some(rows) = joint {
            Carried::Chain(rows.into_inner())
        } else if let Some(urdf) = urdf {
            let (name, links) = read_urdf(&urdf, document)?;
            if let Some(base) = &base {
                Mounted::of(base, document).mount()?;
            }
            own_name = Some(name);
            Carried::Tree(links)
        } else if let Some(arms) = arm {
            Carried::Tree(mounted(arms, base.as_ref(), document)?)
        } else {
            Carried::Tree(link.map(Spanned::into_inner).unwrap_or_default())
        };
        let Some(name) = name.or(own_name) else {
            return Err(document.error_at(0..0, "missing field `name`", None));
        };
        Ok(RobotFile { name, locked, follow, base, tool, collision, carried, span })
    }
}

/// The arms' links, those of each with its prefix.
fn mounted(
    arms: Spanned<Vec<ArmTable>>,
    base: Option<&Spanned<BaseTable>>,
    document: &Document,
) -> Result<Vec<LinkTable>, InputError> {
    let Some(base) = base else {
        let message = "missing field `base`, which arms are mounted on";
        return Err(document.error_at(arms.span(), message, None));
    };
    if base.get_ref().states_mount() {
        let message = "found a mount of the base, and each arm has one of its own";
        return Err(document.error_at(base.span(), message, None));
    }
    let mut all = Vec::new();
    for arm in arms.into_inner() {
        let (_, links) = read_urdf(&arm.urdf, document)?;
        for mut link in links {
            link.begin_names_with(&arm.prefix);
            if link.parent.is_none() {
                (link.position, link.zyx_deg) = (arm.mount, arm.mount_zyx_deg);
            }
            all.push(link);
        }
    }
    Ok(all)
}

fn read_urdf(
    file: &Spanned<String>,
    document: &Document,
) -> Result<(String, Vec<LinkTable>), InputError> {
    let path = document.resolve(file.get_ref());
    if !path.is_file() {
        let message = format!("no URDF file at {}", path.display());
        return Err(document.error_at(file.span(), message, None));
    }
    let (name, mut links) = urdf::read(&Document::read(&path)?)?;
    // Places in the URDF are none in the file that names it.
    for link in &mut links {
        link.place_at(&file.span());
    }
    Ok((name, links))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn paper() -> Robot {
        Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap()
    }

    /// Table 2's `a_i + b_i` reproduces Table 1's rows; link 4 is the telling one.
    #[test]
    fn the_step_between_joints_is_a_plus_b() {
        let robot = paper();
        let step = robot.links()[4].placement.translation();
        assert!((step - Vector3::new(0.0, -0.425 - 0.45, 0.13 + 0.11)).norm() < 1e-15);
    }

    #[test]
    fn warns_of_links_three_and_four() {
        let warning = paper().warning().unwrap();
        assert!(warning.contains("joint3 and of the link of joint4 breaks"), "{warning}");
    }
}
