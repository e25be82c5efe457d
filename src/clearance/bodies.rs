//! The bodies of a robot and which of them could meet.

use std::ops::Range;

use super::mounted::{Anchor, Carrier, Mounted, Owner, Placed, Solid};
use crate::kinematics::{LinkPose, Outward, Pose};
use crate::robot::{Link, Rigid, Robot};
use crate::scalar::Scalar;
use crate::so3::Quat;
use crate::vec3::{Mat3, Vec3};

/// How many random configurations tell which shapes always overlap.
const CONFIGURATIONS: usize = 256;

/// The bodies of a robot that have shapes, solids nearby, and the pairs of these that are watched.
#[derive(Debug, Clone)]
pub struct Bodies {
    pub(super) robot: Robot,
    solids: Vec<Solid>,
    /// In the order of their carriers: base, links, inertial axes.
    pub(super) shapes: Vec<Mounted>,
    pairs: Vec<Pair>,
    /// The pairs of shapes of all pairs, one pair after the other.
    meetings: Vec<[usize; 2]>,
    overlaps: Vec<Overlap>,
}

/// Two bodies, or a body and a solid, that must not meet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pair {
    /// Both. A body is known by its innermost link, a solid comes last.
    pub owners: [Owner; 2],
    meetings: Range<usize>,
}

/// Two shapes that overlap wherever the joints are, so that they are not watched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overlap {
    /// The link that each belongs to, or the base.
    pub owners: [Owner; 2],
    /// The place of each among the shapes of its owner.
    pub shapes: [usize; 2],
}

impl Bodies {
    /// All bodies of a robot that have shapes, and solids nearby.
    ///
    /// Watched are all pairs of bodies but those that a single joint connects, and every solid with every body; a
    /// solid that is fixed in base axes not with the base. `ignored` are pairs of owners that are not watched, links each
    /// for itself and not for the body that they are a part of. Nor are shapes of two bodies that overlap in all of 256 random
    /// configurations within the ranges of the joints: that is how the robot was modelled.
    pub fn new(robot: &Robot, solids: Vec<Solid>, ignored: &[[Owner; 2]]) -> Self {
        let frames = frames(robot);
        let shapes = shapes(robot, &frames, &solids);
        let mut bodies = Self {
            robot: robot.clone(),
            solids,
            shapes,
            pairs: Vec::new(),
            meetings: Vec::new(),
            overlaps: Vec::new(),
        };
        let mut meetings = bodies.meetings(&frames, ignored);
        let always = bodies.always_overlapping(&meetings);
        meetings.retain(|meeting| !always.contains(meeting));
        bodies.overlaps = always.iter().map(|meeting| bodies.overlap(meeting)).collect();
        bodies.group(meetings);
        bodies
    }

    /// The pairs that are watched.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Shapes that overlap wherever the joints are, and are not watched.
    pub fn overlaps(&self) -> &[Overlap] {
        &self.overlaps
    }

    /// What both of a pair are called.
    ///
    /// # Panics
    ///
    /// Panics when there are not so many pairs.
    pub fn names(&self, pair: usize) -> [&str; 2] {
        self.pairs[pair].owners.map(|owner| self.name(owner))
    }

    /// What an owner of shapes is called; the base is `base`.
    ///
    /// # Panics
    ///
    /// Panics when there is no such link or solid.
    pub fn name(&self, owner: Owner) -> &str {
        match owner {
            Owner::Base => "base",
            Owner::Link(link) => &self.robot.links()[link].name,
            Owner::Solid(solid) => &self.solids[solid].name,
        }
    }

    /// Whether clearances depend on the base's attitude: whether a solid is fixed in inertial axes.
    pub fn needs_attitude(&self) -> bool {
        self.shapes.last().is_some_and(|shape| shape.carrier == Carrier::Inertial)
    }

    /// The pairs of shapes that belong to a pair.
    #[inline(always)]
    pub(super) fn of_pair(&self, pair: &Pair) -> &[[usize; 2]] {
        &self.meetings[pair.meetings.start..pair.meetings.end]
    }

    /// Puts every shape to its place in base axes and returns the system's centre of mass there; `each` is told every link. Solids
    /// in inertial axes follow from the base's attitude.
    #[inline(always)]
    pub(super) fn place<T: Scalar, const PLAIN: bool>(
        &self,
        positions: &[T],
        attitude: Quat<T>,
        to: &mut [Placed<T>],
        mut each: impl FnMut(&LinkPose<'_, T>),
    ) -> Vec3<T> {
        let mut next = 0;
        while next < self.shapes.len() && self.shapes[next].carrier == Carrier::Base {
            to[next] = self.shapes[next].still();
            next += 1;
        }
        let mut moment = Vec3::zero();
        let mut outward = Outward::<T, PLAIN>::new(&self.robot, positions);
        for i in 0..self.robot.links().len() {
            // Not by `for link in outward`, which would not be inlined.
            let Some(link) = outward.next() else { break };
            moment += link.centre_of_mass.times(link.link.body.mass);
            while next < self.shapes.len() && self.shapes[next].carrier == Carrier::Link(i) {
                to[next] = self.shapes[next].at(&link.frame);
                next += 1;
            }
            each(&link);
        }
        let centre = moment.times(1.0 / self.robot.total_mass());
        let Mat3([x, y, z]) = attitude.matrix();
        let rotation =
            Mat3([Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z)]);
        let inertial = Pose { position: centre, rotation };
        while next < self.shapes.len() {
            to[next] = self.shapes[next].at(&inertial);
            next += 1;
        }
        centre
    }

    /// All pairs of shapes that could meet.
    fn meetings(&self, frames: &[(Carrier, Rigid)], ignored: &[[Owner; 2]]) -> Vec<[usize; 2]> {
        let is_joined = |inner: Carrier, outer: Carrier| match outer {
            Carrier::Link(link) => {
                let parent = self.robot.links()[link].parent;
                parent.map_or(Carrier::Base, |parent| frames[parent].0) == inner
            }
            _ => false,
        };
        let could_meet = |a: &Mounted, b: &Mounted| {
            let owners = [a.owner, b.owner];
            if ignored.iter().any(|[p, q]| owners == [*p, *q] || owners == [*q, *p]) {
                return false;
            }
            match owners {
                [Owner::Solid(_), Owner::Solid(_)] => false,
                [Owner::Solid(_), _] | [_, Owner::Solid(_)] => a.carrier != b.carrier,
                _ => {
                    a.carrier != b.carrier
                        && !is_joined(a.carrier, b.carrier)
                        && !is_joined(b.carrier, a.carrier)
                }
            }
        };
        let mut meetings = Vec::new();
        for (i, a) in self.shapes.iter().enumerate() {
            for (j, b) in self.shapes.iter().enumerate().skip(i + 1) {
                if could_meet(a, b) {
                    // Solids come last, whatever carries them.
                    let is_solid = matches!(a.owner, Owner::Solid(_));
                    meetings.push(if is_solid { [j, i] } else { [i, j] });
                }
            }
        }
        meetings
    }

    /// Those of two bodies that overlap in every one of many random configurations.
    fn always_overlapping(&self, meetings: &[[usize; 2]]) -> Vec<[usize; 2]> {
        let is_of_bodies = |[_, b]: &&[usize; 2]| !matches!(self.shapes[*b].owner, Owner::Solid(_));
        let mut left: Vec<[usize; 2]> = meetings.iter().filter(is_of_bodies).copied().collect();
        let mut placed = vec![Placed::nothing(); self.shapes.len()];
        for positions in self.robot.random_configurations().take(CONFIGURATIONS) {
            if left.is_empty() {
                break;
            }
            self.place::<_, false>(&positions, Quat::identity(), &mut placed, |_| {});
            left.retain(|[a, b]| placed[*a].clearance(&placed[*b], 0.0) < 0.0);
        }
        left
    }

    /// How far the bodies of each pair are apart \[m\] in that of 256 random configurations in which it is most; with a solid it is
    /// infinite.
    pub fn farthest(&self) -> Vec<f64> {
        let of_solid = |pair: &Pair| matches!(pair.owners[1], Owner::Solid(_));
        let mut farthest: Vec<f64> = (self.pairs.iter().map(of_solid))
            .map(|of_solid| if of_solid { f64::INFINITY } else { f64::NEG_INFINITY })
            .collect();
        for positions in self.robot.random_configurations().take(CONFIGURATIONS) {
            let scene = self.at(&positions, Quat::identity());
            for (pair, farthest) in farthest.iter_mut().enumerate() {
                if *farthest < f64::INFINITY {
                    *farthest = farthest.max(scene.distance(pair));
                }
            }
        }
        farthest
    }

    fn overlap(&self, meeting: &[usize; 2]) -> Overlap {
        let [a, b] = meeting.map(|shape| &self.shapes[shape]);
        Overlap { owners: [a.owner, b.owner], shapes: [a.index, b.index] }
    }

    /// Makes pairs of bodies from pairs of shapes.
    fn group(&mut self, mut meetings: Vec<[usize; 2]>) {
        let owners = |[a, b]: &[usize; 2]| [self.body(*a), self.body(*b)];
        meetings.sort_by_key(|meeting| (owners(meeting), *meeting));
        let mut pairs = Vec::new();
        let mut start = 0;
        for together in meetings.chunk_by(|a, b| owners(a) == owners(b)) {
            let meetings = start..start + together.len();
            start = meetings.end;
            pairs.push(Pair { owners: owners(&together[0]), meetings });
        }
        self.pairs = pairs;
        self.meetings = meetings;
    }

    /// The body that a shape is part of, by its innermost link; or the solid.
    fn body(&self, shape: usize) -> Owner {
        let Mounted { owner, carrier, .. } = &self.shapes[shape];
        match (owner, carrier) {
            (Owner::Solid(_), _) => *owner,
            (_, Carrier::Link(link)) => Owner::Link(*link),
            _ => Owner::Base,
        }
    }
}

/// For every link what carries it, and its frame in that of the carrier.
fn frames(robot: &Robot) -> Vec<(Carrier, Rigid)> {
    let mut frames: Vec<(Carrier, Rigid)> = Vec::with_capacity(robot.links().len());
    for (i, link) in robot.links().iter().enumerate() {
        let base = (Carrier::Base, Rigid::identity());
        let frame = if link.joint.axis().is_some() {
            (Carrier::Link(i), Rigid::identity())
        } else {
            let (carrier, frame) = link.parent.map_or(base, |parent| frames[parent]);
            (carrier, frame.then(&Rigid::of(&link.placement)))
        };
        frames.push(frame);
    }
    frames
}

/// All shapes, in the order of their carriers.
fn shapes(robot: &Robot, frames: &[(Carrier, Rigid)], solids: &[Solid]) -> Vec<Mounted> {
    let identity = Rigid::identity();
    let base = robot.base().shapes.iter().enumerate();
    let base =
        base.map(|(i, shape)| Mounted::new((Owner::Base, i), Carrier::Base, &identity, shape));
    let links = robot.links().iter().zip(frames).enumerate();
    let links = links.flat_map(|(link, (Link { body, .. }, (carrier, frame)))| {
        let shapes = body.shapes.iter().enumerate();
        shapes.map(move |(i, shape)| Mounted::new((Owner::Link(link), i), *carrier, frame, shape))
    });
    let solids = solids.iter().enumerate().map(|(i, Solid { shape, anchor, .. })| {
        let carrier = match anchor {
            Anchor::Base => Carrier::Base,
            Anchor::Inertial => Carrier::Inertial,
        };
        Mounted::new((Owner::Solid(i), 0), carrier, &identity, shape)
    });
    let mut shapes: Vec<Mounted> = base.chain(links).chain(solids).collect();
    shapes.sort_by_key(|shape| shape.carrier);
    shapes
}
