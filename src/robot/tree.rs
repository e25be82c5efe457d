//! A free base and the tree of links that it carries.

use super::link::{Body, Joint, Link, Placement, Turns};

/// A rigid base that floats freely, and the links that joints tie to it.
///
/// Base axes have their origin at the base's centre of mass. Positions, rates, limits and ranges of
/// joints are listed for the joints that move only, in the order of their links.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    name: String,
    base: Body,
    links: Vec<Link>,
    tool: Tool,
    joint_count: usize,
    sources: Vec<Source>,
    /// How many links have a child that does not follow at once.
    kept: usize,
    is_plain: bool,
}

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
    /// Smallest and largest position \[rad or m\] (eq. 29).
    pub range: [f64; 2],
    /// Index of the link that it carries.
    pub link: usize,
}

/// Why links make no robot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RobotError {
    /// A parent that is not among the links before.
    #[error("link {link} has the parent {parent}, which does not come before it")]
    Parent {
        /// Index of the link.
        link: usize,
        /// Index of its parent.
        parent: usize,
    },
    /// A tool on a link that does not exist.
    #[error("the tool is on link {0}, which does not exist")]
    Tool(usize),
    /// NaN, an infinite number, a negative mass, an inertia that is not symmetric or has a negative moment, or an empty
    /// range.
    #[error(
        "link {0} has a number that is not finite, a negative mass, an inertia that no body has or an empty range"
    )]
    Link(usize),
    /// A base without mass, or with NaN or an infinite number.
    #[error("the base has a number that is not finite, no mass or an inertia that no body has")]
    Base,
    /// Nothing to move.
    #[error("no joint moves")]
    NoMovingJoint,
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
                return Err(RobotError::Parent { link: i, parent });
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
                return Err(RobotError::Link(i));
            }
        }
        if let Some(link) = tool.link.filter(|link| *link >= links.len()) {
            return Err(RobotError::Tool(link));
        }
        let joint_count = links.iter().filter(|link| link.joint.axis().is_some()).count();
        if joint_count == 0 {
            return Err(RobotError::NoMovingJoint);
        }
        let (sources, kept) = sources(&links);
        let is_plain = links.iter().enumerate().all(|(i, link)| is_plain(i, link));
        Ok(Self { name, base, links, tool, joint_count, sources, kept, is_plain })
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

    /// Number of joints that move.
    pub fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// The joints that move, in the order of their positions and rates.
    pub fn joints(&self) -> impl Iterator<Item = MovingJoint<'_>> {
        self.links.iter().enumerate().filter_map(|(link, Link { name, joint, .. })| {
            joint.axis().map(|axis| MovingJoint { name, range: axis.range, link })
        })
    }

    /// Where the first link that hangs on the base sits, in base axes.
    pub fn mount(&self) -> &Placement {
        // The first link has none before it to hang on.
        &self.links[0].placement
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

    /// What is unphysical about the data but can be computed with: inertias no solid body has.
    pub fn warning(&self) -> Option<String> {
        let links = self.links.iter().map(|l| (format!("the link of {}", l.name), &l.body));
        let impossible: Vec<String> = std::iter::once(("the base".to_owned(), &self.base))
            .chain(links)
            .filter(|(_, body)| body.breaks_triangle_inequality())
            .map(|(name, _)| name)
            .collect();
        (!impossible.is_empty()).then(|| {
            format!(
                "robot `{}`: the inertia of {} breaks the triangle inequality, so no solid body \
                 has it; used as given",
                self.name,
                impossible.join(" and of ")
            )
        })
    }
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
