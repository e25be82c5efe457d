//! Clearances at one time, and at several in lanes.

use super::bodies::Bodies;
use super::mounted::{Carrier, Owner, Placed};
use super::witness::Witness;
use crate::kinematics::LinkPose;
use crate::lanes::Lanes;
use crate::robot::Joint;
use crate::so3::Quat;
use crate::vec3::Vec3;

/// The clearance of a pair at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// How far both are apart \[m\]; negative where they overlap.
    pub distance: f64,
    /// The pair, as [`Bodies::pairs`] counts.
    pub pair: usize,
    /// The links, base or solid whose shapes are the closest: parts of the pair's bodies.
    pub owners: [Owner; 2],
    /// The closest points of both, or those that a shift along the normal by the distance parts; base axes \[m\].
    pub points: [Vec3<f64>; 2],
    /// Unit vector from the first to the second, base axes.
    pub normal: Vec3<f64>,
    carriers: [Carrier; 2],
}

/// How a clearance follows what moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// By the position of every joint that moves \[m/rad or 1\], the base's attitude held.
    pub positions: Vec<f64>,
    /// By a rotation vector of the base, base axes \[m/rad\]: the attitude becomes `Q ⊗ exp(φ)`. Zero but with solids in
    /// inertial axes.
    pub rotation: Vec3<f64>,
}

/// All shapes at one time.
#[derive(Debug)]
pub struct Scene<'a> {
    bodies: &'a Bodies,
    placed: Vec<Placed<f64>>,
    links: Vec<Moved>,
    /// The system's centre of mass.
    centre: Vec3<f64>,
}

/// What of a link slopes follow from, base axes.
#[derive(Debug)]
struct Moved {
    axis: Vec3<f64>,
    origin: Vec3<f64>,
    centre_of_mass: Vec3<f64>,
}

impl Bodies {
    /// All shapes at joint positions \[rad or m\] and an attitude of the base, base axes into inertial axes. Without solids
    /// in inertial axes the attitude does not matter.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    pub fn at(&self, positions: &[f64], attitude: Quat<f64>) -> Scene<'_> {
        let mut placed = vec![Placed::nothing(); self.shapes.len()];
        let mut links = Vec::with_capacity(self.robot.links().len());
        let moved = |link: &LinkPose<'_, f64>| Moved {
            axis: link.axis,
            origin: link.frame.position,
            centre_of_mass: link.centre_of_mass,
        };
        let centre = self
            .place::<_, false>(positions, attitude, &mut placed, |link| links.push(moved(link)));
        Scene { bodies: self, placed, links, centre }
    }

    /// The least clearance; none where no pair is watched.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    pub fn least(&self, positions: &[f64], attitude: Quat<f64>) -> Option<Clearance> {
        self.at(positions, attitude).least()
    }

    /// Writes the clearance of every pair \[m\], one time per lane.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move, or fewer places than pairs.
    #[inline(always)]
    pub fn scan<T: Lanes>(&self, positions: &[T], attitude: Quat<T>, distances: &mut [T]) {
        self.scan_within(f64::INFINITY, positions, attitude, distances);
    }

    /// The same for clearances below `far` \[m\]; of a pair that is farther apart a lower bound may be written, which is not below
    /// `far` and takes less time. Neither depends on the other lanes.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move, or fewer places than pairs.
    #[inline(always)]
    pub fn scan_within<T: Lanes>(
        &self,
        far: f64,
        positions: &[T],
        attitude: Quat<T>,
        distances: &mut [T],
    ) {
        let mut placed = vec![Placed::nothing(); self.shapes.len()];
        if self.robot.is_plain() {
            self.place::<T, true>(positions, attitude, &mut placed, |_| {});
        } else {
            self.place::<T, false>(positions, attitude, &mut placed, |_| {});
        }
        let pairs = self.pairs();
        for i in 0..pairs.len() {
            let mut least = T::of(f64::INFINITY);
            for [a, b] in self.of_pair(&pairs[i]) {
                least = placed[*a].clearance(&placed[*b], far).smaller(least);
            }
            distances[i] = least;
        }
    }
}

impl Scene<'_> {
    /// The clearance of a pair \[m\].
    ///
    /// # Panics
    ///
    /// Panics when there are not so many pairs.
    pub fn distance(&self, pair: usize) -> f64 {
        self.closest(pair).0
    }

    /// The clearance of every pair \[m\].
    pub fn distances(&self) -> Vec<f64> {
        (0..self.bodies.pairs().len()).map(|pair| self.distance(pair)).collect()
    }

    /// The clearance of a pair, and where.
    ///
    /// # Panics
    ///
    /// Panics when there are not so many pairs.
    pub fn clearance(&self, pair: usize) -> Clearance {
        let (distance, shapes) = self.closest(pair);
        let [a, b] = shapes.map(|shape| &self.placed[shape]);
        let Witness { points, normal, .. } = Witness::of(a, b);
        let [a, b] = shapes.map(|shape| &self.bodies.shapes[shape]);
        let owners = [a.owner, b.owner];
        Clearance { distance, pair, owners, points, normal, carriers: [a.carrier, b.carrier] }
    }

    /// The least clearance; none where no pair is watched.
    pub fn least(&self) -> Option<Clearance> {
        let pairs = 0..self.bodies.pairs().len();
        let least =
            pairs.map(|pair| (self.distance(pair), pair)).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.clearance(least.1))
    }

    /// The slopes of a clearance of this scene.
    pub fn slopes(&self, clearance: &Clearance) -> Slopes {
        let Clearance { points, normal, carriers, .. } = clearance;
        let point = points[0];
        let mut slopes = Slopes {
            positions: vec![0.0; self.bodies.robot.joint_count()],
            rotation: Vec3::zero(),
        };
        for (carrier, sign) in carriers.iter().zip([-1.0, 1.0]) {
            let pull = normal.times(sign);
            match carrier {
                Carrier::Base => {}
                Carrier::Link(link) => self.add_link(*link, point, pull, &mut slopes.positions),
                Carrier::Inertial => {
                    self.add_centre(pull, &mut slopes.positions);
                    slopes.rotation += pull.cross(point - self.centre);
                }
            }
        }
        slopes
    }

    /// How a point of a link follows the joints, along `pull`.
    fn add_link(&self, link: usize, point: Vec3<f64>, pull: Vec3<f64>, to: &mut [f64]) {
        let chain = self.bodies.robot.chain_to(link);
        for (slope, joint) in to.iter_mut().zip(self.bodies.robot.joints()) {
            if chain.contains(&joint.link) {
                *slope += self.velocity(joint.link, point).dot(pull);
            }
        }
    }

    /// How the system's centre of mass follows the joints, along `pull`.
    fn add_centre(&self, pull: Vec3<f64>, to: &mut [f64]) {
        let links = self.bodies.robot.links();
        let (mut masses, mut moments) = (vec![0.0; links.len()], vec![Vec3::zero(); links.len()]);
        for (i, link) in links.iter().enumerate().rev() {
            masses[i] += link.body.mass;
            moments[i] += self.links[i].centre_of_mass.times(link.body.mass);
            if let Some(parent) = link.parent {
                let (mass, moment) = (masses[i], moments[i]);
                masses[parent] += mass;
                moments[parent] += moment;
            }
        }
        let total = self.bodies.robot.total_mass();
        for (slope, joint) in to.iter_mut().zip(self.bodies.robot.joints()) {
            let (mass, moment) = (masses[joint.link], moments[joint.link]);
            if mass > 0.0 {
                let velocity = self.velocity(joint.link, moment.times(1.0 / mass));
                *slope += velocity.dot(pull) * mass / total;
            }
        }
    }

    /// The velocity of a point that a joint moves, at unit rate.
    fn velocity(&self, link: usize, point: Vec3<f64>) -> Vec3<f64> {
        let Moved { axis, origin, .. } = &self.links[link];
        match self.bodies.robot.links()[link].joint {
            Joint::Revolute(_) => axis.cross(point - *origin),
            Joint::Prismatic(_) => *axis,
            Joint::Fixed => Vec3::zero(),
        }
    }

    /// The closest shapes of a pair, and how far they are apart.
    fn closest(&self, pair: usize) -> (f64, [usize; 2]) {
        let mut closest = (f64::INFINITY, [0; 2]);
        for [a, b] in self.bodies.of_pair(&self.bodies.pairs()[pair]) {
            let distance = self.placed[*a].clearance(&self.placed[*b], closest.0);
            if distance < closest.0 {
                closest = (distance, [*a, *b]);
            }
        }
        closest
    }
}
