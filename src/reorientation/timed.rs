//! The time-free cost over families whose derivatives are linear in their coefficients, as a [`Timed`] one.

use std::f64::consts::PI;

use nalgebra::DVector;

use super::fitness::Reorientation;
use super::formulation::Formulated;
use crate::robot::Follow;
use crate::search::{
    Bend, Bent, ErrorSlopes, Failure, Fold, LinearLimit, LinearLimits, PieceId, Problem as _, Rng,
    Timed, TimedWeights,
};
use crate::task::Task;
use crate::trajectory::{Family, Site};

/// Sines that a random start is made of.
const SINES: u32 = 3;

/// The typical amplitude of the first, as a share of half a variable's box, of narrow and of wide starts: the narrow ones
/// are near a fast motion, and where the base is weakly coupled to the arm only wide ones turn it far.
const AMPLITUDES: [f64; 2] = [0.06, 0.4];

/// Sines per joint along which the error's second derivative is asked for, and the length of the differences that it is
/// made of.
const DIRECTIONS: usize = 8;
const DIFFERENCE: f64 = 1e-6;

/// Orders of derivatives that have limits or a range.
const ORDERS: usize = 4;

impl<F: Family> Reorientation<F> {
    /// What the shortest duration follows from, and by how much joints leave their ranges.
    pub(super) fn limits(&self, samples: &F::Samples) -> LinearLimits {
        let (task, family, tables) = (self.task(), self.family(), self.tables());
        let mut limits = LinearLimits::default();
        family.sites(samples, &mut |site: &Site| {
            if is_implied(task, site) {
                return;
            }
            let (middle, most) = match site.order {
                0 => {
                    let [lower, upper] = tables.ranges[site.joint];
                    (f64::midpoint(lower, upper), (upper - lower) / 2.0)
                }
                order => (0.0, task.limits.0[site.joint][order - 1]),
            };
            let track =
                |place: usize| (place * tables.ranges.len() + site.joint) * ORDERS + site.order;
            let limit = LinearLimit {
                id: site.place.map(|place| track(place) as u32),
                power: site.order as u8,
                value: (site.value - middle) / most,
                first: site.first,
                slopes: site.slopes.map(|slope| slope / most),
            };
            // Start and goal are in the range but for rounding, and no path changes them.
            if limit.slopes.iter().any(|slope| *slope != 0.0) {
                let asked = limit.asks(limit.value);
                let all = if limit.power == 0 { &mut limits.excess } else { &mut limits.time };
                *all = all.max(asked);
                limits.list.push(limit);
            }
        });
        if task.least_duration > 0.0 {
            limits.time = limits.time.max(task.least_duration);
            limits.list.push(LinearLimit {
                id: Some(u32::MAX),
                power: 1,
                value: task.least_duration,
                first: 0,
                slopes: [0.0; LinearLimit::MOST],
            });
        }
        limits
    }
}

impl<F: Family> Reorientation<F> {
    /// What is asked for on the way.
    fn bent(&self, coefficients: &[f64]) -> Bent {
        let (mut durations, mut terms, mut excess) = (Vec::new(), Vec::new(), 0.0);
        if let Some(sampled) = self.sampled(coefficients) {
            let asked = self.limits(&self.samples(coefficients)).time;
            let pieces = sampled.pieces(self.width(), asked, 0);
            durations = pieces.durations().cloned().collect();
            (terms, excess) = (pieces.terms(), pieces.excess);
        }
        terms.extend(self.robust_term(coefficients));
        Bent::new(durations, terms, excess)
    }
}

/// Whether a joint that follows another one keeps its limit where that one does; the ranges of both are always the same.
fn is_implied(task: &Task, site: &Site) -> bool {
    task.robot.follows()[site.joint].is_some_and(|Follow { leader, multiplier, .. }| {
        let limit = |joint: usize| task.limits.0[joint][site.order - 1];
        site.order == 0 || limit(site.joint) >= multiplier.abs() * limit(leader)
    })
}

/// The first sines over each joint's variables, of unit length; they are orthogonal (the discrete sine transform).
fn smooth_directions<F: Family>(family: &F) -> impl Iterator<Item = DVector<f64>> + '_ {
    family.leading().iter().flat_map(move |&joint| {
        let own = family.coefficients_of(joint);
        (1..=own.len().min(DIRECTIONS)).map(move |k| {
            let step = PI * k as f64 / (own.len() + 1) as f64;
            let scale = (2.0 / (own.len() + 1) as f64).sqrt();
            let mut direction = DVector::zeros(family.dimension());
            for (i, value) in direction.as_mut_slice()[own.clone()].iter_mut().enumerate() {
                *value = scale * (step * (i + 1) as f64).sin();
            }
            direction
        })
    })
}

impl<F: Family> Timed for Formulated<F> {
    fn limits(&self, x: &[f64]) -> Result<LinearLimits, Failure> {
        Ok(self.task().limits(&self.task().samples(x)))
    }

    fn error(&self, x: &[f64]) -> Result<ErrorSlopes, Failure> {
        Ok(self.task().error_slopes(x, &self.task().timing(x)))
    }

    fn bent(&self, x: &[f64]) -> Result<Bent, Failure> {
        Ok(self.task().bent(x))
    }

    /// Along the first sines of every joint's variables: rougher directions are held still by the limits.
    fn bends(&self, x: &[f64]) -> Result<Vec<Bend>, Failure> {
        let rough = |x: &[f64]| {
            let timing = self.task().timing(x);
            self.task().rough_error_slopes(x, &timing).slopes
        };
        let here = rough(x);
        let along = |direction: DVector<f64>| {
            let there = DVector::from_column_slice(x) + &direction * DIFFERENCE;
            let change = (rough(there.as_slice()) - &here) / DIFFERENCE;
            Bend { direction, change }
        };
        Ok(smooth_directions(self.task().family()).map(along).collect())
    }

    fn folds(&self, x: &[f64], multipliers: &[(PieceId, f64)]) -> Result<Vec<Fold>, Failure> {
        let sampled = self.task().sampled(x);
        Ok(sampled.map(|s| s.folds(self.task().width(), multipliers)).unwrap_or_default())
    }

    fn weights(&self) -> TimedWeights {
        self.task().terms().timed()
    }

    /// Every joint leaves the straight path by a few slow sines, at rest at both ends.
    fn start(&self, rng: &mut Rng, spread: f64) -> Vec<f64> {
        let (family, bounds) = (self.task().family(), self.bounds());
        let mut x: Vec<f64> = vec![0.0; family.dimension()];
        let [least, most] = AMPLITUDES;
        let typical = least * (most / least).powf(spread);
        for &joint in family.leading() {
            let amplitudes: Vec<f64> =
                (1..=SINES).map(|m| typical * rng.normal() / f64::from(m)).collect();
            let own = family.coefficients_of(joint);
            let count = own.len();
            let variables = x[own.clone()].iter_mut().zip(bounds.iter().skip(own.start));
            for (k, (value, [lower, upper])) in variables.enumerate() {
                let tau = (k + 1) as f64 / (count + 1) as f64;
                let window = 16.0 * tau * tau * (1.0 - tau) * (1.0 - tau);
                let sine = |(m, a): (u32, &f64)| a * (PI * f64::from(m) * tau).sin();
                let wave: f64 = (1..).zip(&amplitudes).map(sine).sum();
                *value = (window * wave * (upper - lower) / 2.0).clamp(lower, upper);
            }
        }
        x
    }
}
