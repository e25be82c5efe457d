//! A path, looked at in many places.

use nalgebra::UnitQuaternion;

use super::heights::Heights;
use super::peaks::{Rise, climb, rises, sharpened};
use super::watched::{Place, Watched};
use super::{PathPeak, PathTables, Way};
use crate::attitude::increment;
use crate::lanes::{LaneWork, Lanes, Width};
use crate::momentum::{Arm, JointState};
use crate::task::Task;
use crate::trajectory::{Curve, Family};
use crate::vec3::Vec3;

/// How near to its place a peak is found, as a share of the way between two samples: its height is right to the square of that.
const NEAR: f64 = 1e-6;

/// How far from a peak its sides are looked at, as a share of the way between two samples.
const BESIDE: f64 = 10.0 * NEAR;

/// A path, looked at in many places.
pub(in crate::reorientation) struct Sampled<'a, F: Family> {
    pub(super) task: &'a Task,
    pub(super) family: &'a F,
    pub(super) tables: &'a PathTables<F>,
    pub(super) coefficients: &'a [f64],
    pub(super) curves: Vec<F::Curve<'a>>,
    /// At the ends of all steps, the start first.
    attitudes: Vec<UnitQuaternion<f64>>,
    pub(super) places: Vec<Place>,
    /// Of everything that is watched.
    heights: Vec<Vec<f64>>,
}

/// Clearances that exceed what is asked for by this share of the reach are of no interest.
const FAR: f64 = 0.3;

/// A local maximum along the path.
pub(super) struct LocalMaximum {
    pub(super) watched: Watched,
    pub(super) tau: f64,
    pub(super) height: f64,
}

/// The base's rotations to the ends of all steps.
struct Rotations<'a, F: Family> {
    tables: &'a PathTables<F>,
    arm: &'a Arm,
    family: &'a F,
    coefficients: &'a [f64],
}

impl<F: Family> LaneWork for Rotations<'_, F> {
    type Output = Vec<UnitQuaternion<f64>>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Vec<UnitQuaternion<f64>> {
        let (mut joints, mut rotations) = (Vec::<JointState>::new(), Vec::new());
        let Self { tables, arm, family, coefficients } = self;
        tables.rollout.rotations::<T>(arm, family, coefficients, &mut joints, &mut rotations);
        rotations
    }
}

impl<'a, F: Family> Sampled<'a, F> {
    pub(in crate::reorientation) fn new(
        task: &'a Task,
        family: &'a F,
        tables: &'a PathTables<F>,
        arm: &Arm,
        width: Width,
        coefficients: &'a [f64],
    ) -> Self {
        let attitudes = width.run(Rotations { tables, arm, family, coefficients });
        let attitudes = attitudes.into_iter().map(|rotation| task.start.base * rotation);
        let attitudes: Vec<_> = std::iter::once(task.start.base).chain(attitudes).collect();
        let curve = |joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]);
        let curves: Vec<_> = (0..family.joints()).map(curve).collect();
        let steps = (attitudes.len() - 1) as f64;
        let looked_at = attitudes.iter().enumerate().step_by(tables.stride);
        let orders = tables.watched.iter().map(|watched| watched.orders()).max().unwrap_or(1);
        let places =
            looked_at.map(|(k, attitude)| place(&curves, k as f64 / steps, *attitude, orders));
        let places: Vec<Place> = places.collect();
        let clearance = task.path.clearance.as_ref();
        let heights = Heights {
            task,
            bodies: clearance.map(|limit| &*limit.bodies),
            far: clearance.map_or(0.0, |limit| limit.least + FAR * limit.reach),
            watched: &tables.watched,
            places: &places,
        };
        let heights = width.run(heights);
        Self { task, family, tables, coefficients, curves, attitudes, places, heights }
    }

    /// The place of what is watched among all.
    pub(super) fn index(&self, watched: Watched) -> usize {
        self.tables.watched.iter().position(|own| *own == watched).unwrap_or_default()
    }

    /// The same with an attitude that is none, and with derivatives of so many orders from zero on.
    fn still_at(&self, tau: f64, orders: usize) -> Place {
        place(&self.curves, tau, UnitQuaternion::identity(), orders)
    }

    /// What follows from the path at any time of it.
    pub(super) fn at(&self, tau: f64) -> Place {
        let steps = self.attitudes.len() - 1;
        let step = ((tau * steps as f64) as usize).min(steps);
        let (before, attitude) = (step as f64 / steps as f64, self.attitudes[step]);
        let write = |tau: f64, positions: &mut [f64], rates: &mut [f64]| {
            for ((position, rate), curve) in positions.iter_mut().zip(rates).zip(&self.curves) {
                [*position, *rate] = curve.derivatives(tau);
            }
        };
        let turn = increment(&self.task.robot, [before, tau], write);
        place(&self.curves, tau, attitude * turn, ORDERS)
    }

    /// The local maximum at a rise: where it is, and its height.
    fn climb(&self, index: usize, rise: Rise) -> (f64, f64) {
        let watched = self.tables.watched[index];
        let last = self.places.len() - 1;
        let ends = [rise.at.saturating_sub(1), (rise.at + 1).min(last)];
        let begin = (self.places[rise.at].tau, self.heights[index][rise.at]);
        let turns = watched.follows_attitude(self.task);
        let height = |tau: f64| {
            let place = if turns { self.at(tau) } else { self.still_at(tau, watched.orders()) };
            watched.height(self.task, &place)
        };
        let tolerance = NEAR / last as f64;
        let found = climb(ends.map(|end| self.places[end].tau), begin, tolerance, height);
        // Where bodies overlap, the shortest way apart may be another one before and after a peak, which then is sharp.
        let overlaps = matches!(watched, Watched::Clearance(_)) && found.1 > 0.0;
        if overlaps { sharpened(found, self.beside(), height) } else { found }
    }

    /// How far from a peak its sides are looked at.
    pub(super) fn beside(&self) -> f64 {
        BESIDE / (self.places.len() - 1) as f64
    }

    /// The rises of something that is watched, with the most that each may come to.
    fn rises(&self, index: usize) -> impl Iterator<Item = (Rise, f64)> {
        let heights = &self.heights[index];
        let is_sharp = matches!(self.tables.watched[index], Watched::Clearance(_));
        let most = move |rise: &Rise| {
            let here = heights[rise.at];
            let fall = |k: usize| heights.get(k).map_or(0.0, |beside| here - beside);
            // What bends towards its peak lies below the lines through samples on either side of it, sharp or not.
            let steep = f64::max(fall(rise.at.wrapping_sub(1)), fall(rise.at + 1));
            here + f64::max(DOUBT * rise.above, if is_sharp { steep } else { 0.0 })
        };
        rises(heights).into_iter().map(move |rise| (rise, most(&rise)))
    }

    /// What the limits ask for at the places alone, which is no more than they ask for.
    pub(super) fn way_of_places(&self) -> Way {
        let mut way = Way::default();
        for (watched, heights) in self.tables.watched.iter().zip(&self.heights) {
            let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if let Some([demand, _]) = watched.demand(self.task, highest) {
                way.raise(watched.kind(), demand);
            }
        }
        way
    }

    /// What the cost follows from. Rises that the cost cannot follow from are not climbed.
    pub(in crate::reorientation) fn way(&self) -> Way {
        let (mut way, task) = (Way::default(), self.task);
        let is_weighed = task.path.turn_weights != [0.0; 2];
        for (index, &watched) in self.tables.watched.iter().enumerate() {
            let kind = watched.kind();
            let is_turn_weighed = watched == Watched::BaseTurn && is_weighed;
            if is_turn_weighed {
                way.turns = [0.0, self.mean(index)];
            }
            for (rise, most) in self.rises(index) {
                let demand =
                    |height| watched.demand(task, height).map_or(0.0, |[demand, _]| demand);
                let known = way.demands[kind as usize];
                if demand(most) > known || (is_turn_weighed && most > way.turns[0]) {
                    let height = self.climb(index, rise).1;
                    way.raise(kind, demand(height));
                    if is_turn_weighed {
                        way.turns[0] = way.turns[0].max(height);
                    }
                }
            }
        }
        way
    }

    /// The largest of every kind that is watched, joint by joint and cone by cone, in a motion that lasts so long \[s\].
    pub(in crate::reorientation) fn peaks(&self, duration: f64) -> Vec<PathPeak> {
        let mut peaks: Vec<(PathPeak, f64)> = Vec::new();
        for (index, &watched) in self.tables.watched.iter().enumerate() {
            // Of all pairs the nearest is enough.
            let is_same = |known: &Watched| {
                matches!((known, watched), (Watched::Clearance(_), Watched::Clearance(_)))
            };
            for (rise, most) in self.rises(index) {
                let place = peaks
                    .iter()
                    .position(|(known, _)| known.watched == watched || is_same(&known.watched));
                if place.is_some_and(|place| peaks[place].1 >= most) {
                    continue;
                }
                let (tau, height) = self.climb(index, rise);
                let power = watched.kind().power().unwrap_or_default();
                let value = watched.value(self.task, height) / duration.powi(power);
                let found = (PathPeak { watched, value, tau }, height);
                match place {
                    Some(place) if peaks[place].1 >= height => {}
                    Some(place) => peaks[place] = found,
                    None => peaks.push(found),
                }
            }
        }
        peaks.into_iter().map(|(peak, _)| peak).collect()
    }

    /// All local maxima whose heights are `wanted`.
    pub(super) fn local_peaks(&self, wanted: impl Fn(Watched, f64) -> bool) -> Vec<LocalMaximum> {
        let mut all = Vec::new();
        for (index, &watched) in self.tables.watched.iter().enumerate() {
            for (rise, _) in self.rises(index).filter(|(_, most)| wanted(watched, *most)) {
                let (tau, height) = self.climb(index, rise);
                all.push(LocalMaximum { watched, tau, height });
            }
        }
        all
    }

    /// The mean over the path, by the trapezoidal rule: at both ends a motion is at rest, so its error falls with the fourth
    /// power of the step.
    pub(super) fn mean(&self, index: usize) -> f64 {
        let heights = &self.heights[index];
        let ends = f64::midpoint(heights[0], heights[heights.len() - 1]);
        let inner: f64 = heights[1..heights.len() - 1].iter().sum();
        (ends + inner) / (heights.len() - 1) as f64
    }
}

/// By how many times what a parabola makes of a rise the peak may be higher.
const DOUBT: f64 = 3.0;

/// Orders of derivatives that something follows, from zero on.
const ORDERS: usize = 3;

/// A place with derivatives of so many orders, and zeros for others.
fn place<C: Curve>(curves: &[C], tau: f64, attitude: UnitQuaternion<f64>, orders: usize) -> Place {
    let mut derivatives = [0, 1, 2].map(|_| Vec::with_capacity(curves.len()));
    for curve in curves {
        let [mut rate, mut acceleration] = [0.0; 2];
        let position;
        match orders {
            1 => [position] = curve.derivatives(tau),
            2 => [position, rate] = curve.derivatives(tau),
            _ => [position, rate, acceleration] = curve.derivatives(tau),
        }
        let all = derivatives.iter_mut().zip([position, rate, acceleration]);
        all.for_each(|(all, own)| all.push(own));
    }
    let [positions, rates, accelerations] = derivatives;
    // Nothing that follows the momentum is limited where there is any.
    Place { tau, positions, rates, accelerations, attitude, momentum: Vec3::zero() }
}
