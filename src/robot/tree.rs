//! A free base and the tree of links that it carries.

use super::error::RobotError;
use super::follow::Follow;
use super::link::{Axis, Body, Joint, JointKind, Link, Placement, Turns};
use super::shape::Shape;

/// A rigid base that floats freely, and the links that joints tie to it.
///
/// Base axes have their origin at the base's centre of mass. Positions, rates, limits and ranges of
/// joints are listed for the joints that move only, in the order of their links.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    name: String,
    base: Body,
    pub(super) links: Vec<Link>,
    tool: Tool,
    joint_count: usize,
    /// Of every joint how it follows another one.
    pub(super) follows: Vec<Option<Follow>>,
    mount: Placement,
    sources: Vec<Source>,
    /// How many links have a child that does not follow at once.
    kept: usize,
    is_plain: bool,
    ignored: Vec<[Option<usize>; 2]>,
}

/// What a link is called that is the tool where nothing is said of it.
pub(super) const TOOL: &str = "tool";

/// The frame that tasks are done with.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    /// Index of the link that holds it; `None` for the base.
    pub link: Option<usize>,
    /// The tool's frame in the link's.
    pub placement: Placement,
}

/// A joint that moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingJoint<'a> {
    /// Its name.
    pub name: &'a str,
    /// What its positions are.
    pub kind: JointKind,
    /// Smallest and largest position \[rad or m\] (eq. 29).
    pub range: [f64; 2],
    /// Largest rate \[rad/s or m/s\], where the robot's maker states one.
    pub rate: Option<f64>,
    /// Index of the link that it carries.
    pub link: usize,
    /// How it follows another joint, if it does.
    pub follows: Option<Follow>,
}

impl MovingJoint<'_> {
    /// A position that a file states in degrees or metres, in SI units; or why the joint cannot have it.
    pub(crate) fn position(&self, stated: f64) -> Result<f64, String> {
        let [lower, upper] = self.range.map(|end| self.kind.to_file_units(end));
        // A hair's breadth for the rounding of degrees to radians and back.
        if (lower - 1e-9..=upper + 1e-9).contains(&stated) {
            return Ok(self.kind.from_file_units(stated));
        }
        let [stated, lower, upper] =
            [stated, lower, upper].map(|position| self.kind.told(position));
        Err(format!("{stated} is out of the range {lower} to {upper} of {}", self.name))
    }
}

/// Where an outward sweep finds what a link inherits from its parent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Parent {
    Base,
    /// The link before, which most links hang on.
    Previous,
    /// Among those kept for children that do not follow at once.
    Kept(usize),
}

/// What a sweep has to know of a link's neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Source {
    parent: Parent,
    /// The place to keep this link's own, where a child does not follow at once.
    keep: Option<usize>,
}

impl Robot {
    /// From links of which each comes after its parent.
    pub fn new(name: String, base: Body, links: Vec<Link>, tool: Tool) -> Result<Self, RobotError> {
        if !(base.is_sound() && base.mass > 0.0) {
            return Err(RobotError::Base);
        }
        for (i, link) in links.iter().enumerate() {
            if let Some(parent) = link.parent.filter(|parent| *parent >= i) {
                return Err(RobotError::Parent { link: link.name.clone(), parent });
            }
            let axis_is_sound = link.joint.axis().is_none_or(|axis| {
                let [low, high] = axis.range;
                axis.direction.iter().all(|entry| entry.is_finite())
                    && low.is_finite()
                    && high.is_finite()
                    && low < high
            });
            let place_is_finite = link.centre_of_mass.iter().all(|entry| entry.is_finite());
            if !(axis_is_sound
                && place_is_finite
                && link.body.is_sound()
                && link.placement.is_finite())
            {
                return Err(RobotError::Link(link.name.clone()));
            }
        }
        if let Some(link) = tool.link.filter(|link| *link >= links.len()) {
            return Err(RobotError::Tool(link));
        }
        let joint_count = links.iter().filter(|link| link.joint.axis().is_some()).count();
        if joint_count == 0 {
            return Err(RobotError::NoMovingJoint);
        }
        let mount = mount(&links);
        let (sources, kept) = sources(&links);
        let is_plain = links.iter().enumerate().all(|(i, link)| is_plain(i, link));
        let ignored = Vec::new();
        let follows = vec![None; joint_count];
        Ok(Self {
            name,
            base,
            links,
            tool,
            joint_count,
            follows,
            mount,
            sources,
            kept,
            is_plain,
            ignored,
        })
    }

    /// The same with these [`ignored_pairs`](Self::ignored_pairs) instead of its own. Fails where there is no such link.
    pub fn ignoring(mut self, pairs: Vec<[Option<usize>; 2]>) -> Result<Self, RobotError> {
        let mut links = pairs.iter().flatten().flatten();
        if let Some(link) = links.find(|link| **link >= self.links.len()) {
            return Err(RobotError::Ignored(*link));
        }
        self.ignored = pairs;
        Ok(self)
    }

    /// The same with the shapes of base and links, each in its own frame, and with these pairs beside its ignored ones.
    pub(super) fn reshaped(
        &self,
        base: Vec<Shape>,
        links: Vec<Vec<Shape>>,
        ignored: Vec<[Option<usize>; 2]>,
    ) -> Self {
        let mut robot = self.clone();
        robot.base.shapes = base;
        for (link, shapes) in robot.links.iter_mut().zip(links) {
            link.body.shapes = shapes;
        }
        robot.ignored.extend(ignored);
        robot
    }

    /// The name given in its file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The base.
    pub fn base(&self) -> &Body {
        &self.base
    }

    /// The links, each after its parent.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The tool.
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// Links, `None` for the base, whose own shapes may touch each other. Links that are fixed to them are others.
    pub fn ignored_pairs(&self) -> &[[Option<usize>; 2]] {
        &self.ignored
    }

    /// Number of joints that move.
    pub fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// The joints that move, in the order of their positions and rates.
    pub fn joints(&self) -> impl Iterator<Item = MovingJoint<'_>> {
        let moving =
            self.links.iter().enumerate().filter_map(|(link, Link { joint, .. })| {
                Some((link, joint.axis()?, joint.kind()?))
            });
        moving.zip(&self.follows).map(|((link, axis, kind), follows)| {
            let Axis { name, range, rate, .. } = axis;
            MovingJoint { name, kind, range: *range, rate: *rate, link, follows: *follows }
        })
    }

    /// The first joint that slides: degrees say nothing of it.
    pub fn sliding_joint(&self) -> Option<MovingJoint<'_>> {
        self.joints().find(|joint| joint.kind == JointKind::Prismatic)
    }

    /// The same with the tool where it is if nothing is said of it.
    pub(super) fn holding_its_tool_outermost(mut self) -> Self {
        self.tool = self.unstated_tool();
        self
    }

    /// The tool where nothing is said of it: the link of that name, or the outermost link.
    pub(super) fn unstated_tool(&self) -> Tool {
        let named = self.links.iter().position(|link| link.name == TOOL);
        let link = named.or_else(|| outermost(&self.links));
        Tool { link, placement: Placement::identity() }
    }

    /// Where the first joint that moves sits, in base axes.
    pub fn mount(&self) -> &Placement {
        &self.mount
    }

    /// Whether it is a chain of Denavit–Hartenberg rows with joints that turn, which sweeps go through with
    /// fewer operations.
    #[inline(always)]
    pub(crate) fn is_plain(&self) -> bool {
        self.is_plain
    }

    /// The links from the base to this one, which comes last.
    pub fn chain_to(&self, link: usize) -> Vec<usize> {
        let mut chain = vec![link];
        let mut inner = self.links[link].parent;
        while let Some(parent) = inner {
            chain.push(parent);
            inner = self.links[parent].parent;
        }
        chain.reverse();
        chain
    }

    /// The mass of base and links together \[kg\].
    pub fn total_mass(&self) -> f64 {
        self.base.mass + self.links.iter().map(|link| link.body.mass).sum::<f64>()
    }

    /// For every link, whether it or a link that it carries has mass or inertia.
    pub(super) fn moves_something(&self) -> Vec<bool> {
        let own = |link: &Link| link.body.mass > 0.0 || link.body.inertia.norm() > 0.0;
        let mut has: Vec<bool> = self.links.iter().map(own).collect();
        for i in (0..has.len()).rev() {
            if let Some(parent) = self.links[i].parent.filter(|_| has[i]) {
                has[parent] = true;
            }
        }
        has
    }

    /// The links that a joint moves and that have no mass, nor has what is fixed to them.
    fn massless(&self) -> Vec<&str> {
        // For every link the one that the nearest joint moves.
        let mut movers: Vec<Option<usize>> = Vec::with_capacity(self.links.len());
        let mut masses = vec![0.0; self.links.len()];
        for (i, link) in self.links.iter().enumerate() {
            let inner = link.parent.and_then(|parent| movers[parent]);
            let mover = if link.joint.axis().is_some() { Some(i) } else { inner };
            if let Some(mover) = mover {
                masses[mover] += link.body.mass;
            }
            movers.push(mover);
        }
        let is_massless = |i: &usize| movers[*i] == Some(*i) && masses[*i] == 0.0;
        let massless = (0..self.links.len()).filter(is_massless);
        massless.map(|i| self.links[i].name.as_str()).collect()
    }

    /// What is unlikely about the data but can be computed with: links without mass, and inertias that no solid body has.
    pub fn warning(&self) -> Option<String> {
        let called = |link: &Link| match link.joint.axis() {
            Some(axis) if axis.name == link.name => format!("the link of {}", link.name),
            _ => link.name.clone(),
        };
        let links = self.links.iter().map(|link| (called(link), &link.body));
        let impossible: Vec<String> = std::iter::once(("the base".to_owned(), &self.base))
            .chain(links)
            .filter(|(_, body)| body.breaks_triangle_inequality())
            .map(|(name, _)| name)
            .collect();
        let mut warnings = Vec::new();
        if !impossible.is_empty() {
            warnings.push(format!(
                "the inertia of {} breaks the triangle inequality, so no solid body has it; used as given",
                impossible.join(" and of ")
            ));
        }
        let massless = self.massless();
        if !massless.is_empty() {
            let verb = if massless.len() == 1 { "has" } else { "have" };
            warnings.push(format!("{} {verb} no mass; used as given", massless.join(", ")));
        }
        (!warnings.is_empty()).then(|| format!("robot `{}`: {}", self.name, warnings.join(". ")))
    }

    /// The same; none where a robot that comes with the crate has it too, since that is as published.
    pub fn unexpected_warning(&self) -> Option<String> {
        let warning = self.warning()?;
        let shipped = Self::embedded(&self.name).and_then(|file| Self::from_document(&file).ok());
        let is_known = shipped.is_some_and(|own| own.warning().as_ref() == Some(&warning));
        (!is_known).then_some(warning)
    }
}

/// Where the first joint that moves sits on the base. All links before it are fixed.
fn mount(links: &[Link]) -> Placement {
    let Some(first) = links.iter().find(|link| link.joint.axis().is_some()) else {
        return Placement::identity();
    };
    let mut placement = first.placement.clone();
    let mut inner = first.parent;
    while let Some(parent) = inner {
        placement = links[parent].placement.then(&placement);
        inner = links[parent].parent;
    }
    placement
}

/// The first of the links with most joints that move between them and the base, and from there outward as long as one link is fixed to
/// the other and no second one.
pub(super) fn outermost(links: &[Link]) -> Option<usize> {
    let mut depths: Vec<usize> = Vec::with_capacity(links.len());
    let mut carried: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    for (i, link) in links.iter().enumerate() {
        let inner = link.parent.map_or(0, |parent| depths[parent]);
        depths.push(inner + usize::from(link.joint.axis().is_some()));
        if let Some(parent) = link.parent {
            carried[parent].push(i);
        }
    }
    let deepest = depths.iter().copied().max()?;
    let mut outermost = depths.iter().position(|depth| *depth == deepest)?;
    while let [only] = carried[outermost][..] {
        outermost = only;
    }
    Some(outermost)
}

fn is_plain(index: usize, link: &Link) -> bool {
    let has_row = index == 0 || matches!(link.placement.turns(), Turns::Dh { .. });
    let turns_about_z = matches!(&link.joint, Joint::Revolute(axis) if axis.is_z());
    link.parent == index.checked_sub(1) && has_row && turns_about_z
}

fn sources(links: &[Link]) -> (Vec<Source>, usize) {
    let mut keep = vec![None; links.len()];
    let mut kept = 0;
    let mut parents = Vec::with_capacity(links.len());
    for (i, link) in links.iter().enumerate() {
        parents.push(match link.parent {
            None => Parent::Base,
            Some(parent) if parent + 1 == i => Parent::Previous,
            Some(parent) => Parent::Kept(*keep[parent].get_or_insert_with(|| {
                kept += 1;
                kept - 1
            })),
        });
    }
    let sources = parents.into_iter().zip(keep).map(|(parent, keep)| Source { parent, keep });
    (sources.collect(), kept)
}

/// What an outward sweep hands from each link to its children. A chain's stays in one place.
#[derive(Debug)]
pub(crate) struct Inherited<V> {
    /// That of the link the sweep has come to, once it is worked out.
    pub(crate) current: V,
    base: V,
    kept: Vec<V>,
}

impl<V: Copy> Inherited<V> {
    /// Before the first link; children of the base inherit `base`.
    #[inline(always)]
    pub(crate) fn new(robot: &Robot, base: V) -> Self {
        Self { current: base, base, kept: room(robot, base) }
    }

    /// Makes what the next link inherits the current one.
    #[inline(always)]
    pub(crate) fn enter(&mut self, robot: &Robot, link: usize) {
        match robot.sources[link].parent {
            Parent::Previous => {}
            Parent::Base => self.current = self.base,
            Parent::Kept(place) => self.current = self.kept[place],
        }
    }

    /// Keeps the current one if another than the next link inherits it.
    #[inline(always)]
    pub(crate) fn leave(&mut self, robot: &Robot, link: usize) {
        if let Some(place) = robot.sources[link].keep {
            self.kept[place] = self.current;
        }
    }
}

#[inline(always)]
fn room<V: Copy>(robot: &Robot, value: V) -> Vec<V> {
    if robot.kept == 0 { Vec::new() } else { vec![value; robot.kept] }
}

/// What an inward sweep gathers of all that is outward of each link.
#[derive(Debug)]
pub(crate) struct Gathered<V> {
    /// All that is outward of the link the sweep has come to, and in the end the link itself.
    pub(crate) current: V,
    nothing: V,
    kept: Vec<V>,
}

impl<V: Copy + std::ops::AddAssign> Gathered<V> {
    /// Before the last link.
    #[inline(always)]
    pub(crate) fn new(robot: &Robot, nothing: V) -> Self {
        Self { current: nothing, nothing, kept: room(robot, nothing) }
    }

    /// Adds what the link's children that do not follow at once have left.
    #[inline(always)]
    pub(crate) fn enter(&mut self, robot: &Robot, link: usize) {
        if let Some(place) = robot.sources[link].keep {
            self.current += self.kept[place];
        }
    }

    /// Leaves the current one to the link's parent.
    #[inline(always)]
    pub(crate) fn leave(&mut self, robot: &Robot, link: usize) {
        match robot.sources[link].parent {
            Parent::Previous => {}
            Parent::Base => self.current = self.nothing,
            Parent::Kept(place) => {
                self.kept[place] += self.current;
                self.current = self.nothing;
            }
        }
    }
}
