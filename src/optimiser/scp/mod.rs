//! Sequential convex programming on a cost `J = Σ_k w_k φ_k(v_k(x))` of norms, maxima and hinges of
//! smooth pieces.
//!
//! Each step linearises the pieces and leaves the terms' shapes as they are: a conic subproblem, solved
//! by Clarabel, within a trust region (Fletcher 1982, doi:10.1007/BFb0120959), with a second-order
//! correction (Fletcher 1982, doi:10.1007/BFb0093151). The Lagrangian's second derivative within the
//! space where the active pieces stay level, with what is negative taken out so that the subproblem
//! stays convex, makes the last steps few.
//!
//! A norm `w ‖r‖` is an exact penalty: as soon as `w` exceeds the multiplier of `r = 0` the minimum no
//! longer depends on it. A weight many times that makes a search hug `r = 0`, slow and soon in a poor
//! valley; so the search starts with smaller weights of the norms and raises them only as it must.
//! Where `r = 0` is out of reach, though, no weight is exact, and a small one leads every start to
//! the same few points, whatever their `r`; so a start that ends there is followed once more, with
//! the problem's own weights throughout.
//!
//! Where a problem has a [coarser](crate::search::Problem::coarser) one, random starts are followed on the coarsest, and the
//! best of their ends on finer ones, fewer on each (successive halving, Jamieson & Talwalkar 2016, arXiv:1502.07943).
//!
//! On a [`Timed`](crate::search::Timed) cost the steps are others, for many variables: see `timed.rs`. Where such a problem
//! has a [relaxed](crate::search::Problem::relaxed) one, random starts are followed there first.
//!
//! A start has been followed to its end when, with the problem's own weights, a step promises next to
//! nothing and the Lagrangian is level, the first-order condition of a minimum.

mod banded;
mod bends;
mod cone;
mod interior_point;
mod iterate;
mod subproblem;
mod timed;
mod timed_subproblem;

use std::num::NonZeroUsize;

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use crate::input::{count, optional_count, positive, share};
use crate::search::{Best, Bounds, Oracle, Problem, Rng, Stop};
use iterate::Iterate;
use subproblem::{Region, Step};

/// Settings of sequential convex programming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Scp {
    /// starts, each followed to its local optimum; without it 100 random ones, or after another
    /// optimiser the best point it found and no more
    #[serde(deserialize_with = "optional_count::<1, 1_000_000_000, _, _>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub starts: Option<NonZeroUsize>,
    /// most steps from one start
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub steps: NonZeroUsize,
    /// first radius of the trust region, as a fraction of the box's half-width
    #[serde(deserialize_with = "share")]
    pub radius: f64,
    /// first weight of the cost's norms, such as the base's error, in costs of the start's other terms; it grows
    /// to the problem's own
    #[serde(deserialize_with = "positive")]
    pub first_weight: f64,
    /// a start ends when a step promises to lower J by less than this share of it, provided that the
    /// Lagrangian is level
    #[serde(deserialize_with = "share")]
    pub tolerance: f64,
    /// the Lagrangian is level when over half the box's width it changes by less than this share of J
    #[serde(deserialize_with = "share")]
    pub stationarity: f64,
}

impl Default for Scp {
    fn default() -> Self {
        let steps = NonZeroUsize::MIN.saturating_add(199);
        Self {
            starts: None,
            steps,
            radius: 0.1,
            first_weight: 4.0,
            tolerance: 1e-9,
            stationarity: 1e-5,
        }
    }
}

/// Why following one start came to an end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// A step promises next to nothing, and the Lagrangian is level.
    Optimal,
    /// The trust region shrank to nothing where the Lagrangian is not level.
    Stalled,
    /// Every step was made.
    StepsSpent,
}

impl Optimiser for Scp {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        self.minimise_from(None, oracle, rng)
    }

    fn needs_derivatives(&self) -> bool {
        true
    }

    fn lacks(&self, problem: &dyn Problem) -> Option<&'static str> {
        let tells = problem.composite().is_some() || problem.timed().is_some();
        (!tells).then_some("derivatives of the cost's terms")
    }

    fn parts(&self) -> Option<(Box<dyn Optimiser>, usize)> {
        let one = Self { starts: Some(NonZeroUsize::MIN), ..self.clone() };
        Some((Box::new(one), self.random_starts()))
    }
}

impl Scp {
    /// Minimises with `first` as the first start, where there is one.
    pub(super) fn minimise_from(
        &self,
        first: Option<&[f64]>,
        oracle: &mut Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<(), Stop> {
        let mut random = self.random_starts();
        if let Some(first) = first {
            self.follow(oracle, first)?;
            random = self.starts.map_or(0, |starts| starts.get() - 1);
        }
        self.follow_random(random, oracle, rng).map(|_| ())
    }

    /// Follows so many random starts a short way, on the coarsest problem, and on each finer one the best ends of the one
    /// before. Its own best ends, each once.
    fn follow_random(
        &self,
        starts: usize,
        oracle: &mut Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<Vec<Best>, Stop> {
        let is_timed = oracle.timed_weights().is_some();
        let (loose, few) = if is_timed { (LOOSE, FEW) } else { (STRICT, self.steps) };
        let short = Self {
            tolerance: self.tolerance.max(loose),
            steps: self.steps.min(few),
            ..self.clone()
        };
        let mut ends = oracle.on_coarser(|oracle| short.follow_random(starts, oracle, rng))?;
        if ends.is_none() && is_timed && self.tolerance < LOOSE {
            ends = Some(short.follow_random(starts, oracle, rng)?);
        }
        // Smaller weights than the problem's own would lead away from where an end has brought the norms.
        let onward = Self { first_weight: f64::INFINITY, ..self.clone() };
        let (settings, points): (_, Vec<Vec<f64>>) = match ends {
            Some(ends) => (&onward, ends.into_iter().map(|end| end.x).collect()),
            None => (self, self.first_points(starts, oracle, rng)?),
        };
        let mut ends =
            oracle.from_each(&points, |oracle, x| settings.follow(oracle, x).map(drop))?;
        ends.sort_by(|a, b| a.evaluation.cost.total_cmp(&b.evaluation.cost));
        let same = SAME.max(3.0 * self.tolerance);
        ends.dedup_by(|b, a| {
            b.evaluation.cost - a.evaluation.cost <= same * a.evaluation.cost.abs()
        });
        ends.truncate(points.len().div_ceil(REDUCTION));
        Ok(ends)
    }

    /// So many random starts. Where a problem can be relaxed, these are followed there, and the best ends are starts beside a few
    /// random ones.
    fn first_points(
        &self,
        starts: usize,
        oracle: &mut Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<Vec<Vec<f64>>, Stop> {
        if starts < REDUCTION || oracle.timed_weights().is_none() || !oracle.is_relaxable() {
            return Ok((0..starts).map(|k| Self::random_start(oracle, rng, k)).collect());
        }
        // One without, so that there is something to show for it if the search ends early.
        let first = [Self::random_start(oracle, rng, 0)];
        let first = oracle.from_each(&first, |oracle, x| self.follow(oracle, x).map(drop))?;
        let mut points: Vec<Vec<f64>> = first.into_iter().map(|end| end.x).collect();
        points.extend(oracle.on_relaxed(|oracle| self.follow_random(starts, oracle, rng))?);
        let fresh = (2 * starts).div_ceil(REDUCTION).saturating_sub(points.len());
        points.extend((0..fresh).map(|k| Self::random_start(oracle, rng, k + 1)));
        Ok(points)
    }

    /// Starts of a run that follows no other optimiser.
    pub fn random_starts(&self) -> usize {
        self.starts.map_or(100, NonZeroUsize::get)
    }

    /// Draws the start after `drawn` others: the problem's own, where it is timed, the first the narrowest.
    pub(super) fn random_start(oracle: &Oracle<'_>, rng: &mut Rng, drawn: usize) -> Vec<f64> {
        let spread = (drawn as f64 * GOLDEN).fract();
        let own = oracle.timed_start(rng, spread);
        own.unwrap_or_else(|| Self::start(oracle.bounds(), rng))
    }

    /// Draws a start uniformly from the box shrunk about its middle, by the square of a number drawn
    /// uniformly from the unit interval. Of twelve tasks with random poses nine were solved most often
    /// from near the middle, three only or mostly from far out.
    pub fn start(bounds: &Bounds, rng: &mut Rng) -> Vec<f64> {
        let shrink = rng.unit().powi(2);
        let draw = |[lower, upper]: [f64; 2]| {
            let middle = f64::midpoint(lower, upper);
            middle + shrink * (rng.uniform(lower, upper) - middle)
        };
        bounds.iter().map(draw).collect()
    }

    /// Follows one start to a local optimum.
    pub fn follow(&self, oracle: &mut Oracle<'_>, start: &[f64]) -> Result<Ending, Stop> {
        if let Some(weights) = oracle.timed_weights() {
            let mut search = timed::Search::new(self, oracle, weights, start)?;
            self.repeat(|| search.step())
        } else {
            let mut search = Search::new(self, oracle, start)?;
            self.repeat(|| search.step())
        }
    }

    /// Makes steps until one ends the search, or all are made.
    fn repeat(
        &self,
        mut step: impl FnMut() -> Result<Option<Ending>, Stop>,
    ) -> Result<Ending, Stop> {
        for _ in 0..self.steps.get() {
            if let Some(ending) = step()? {
                return Ok(ending);
            }
        }
        Ok(Ending::StepsSpent)
    }
}

/// The trust region's smallest radius.
const SMALLEST: f64 = 1e-9;

/// Share of the promised gain that a step has to keep to be taken, not to narrow the region, and to
/// widen it.
const TAKE: f64 = 0.05;
const NARROW: f64 = 0.3;
const WIDEN: f64 = 0.7;

/// The trust region's radius after a step that kept such a share of the promised gain and went so far towards the region's
/// wall.
fn next_radius(radius: f64, kept: f64, reach: f64) -> f64 {
    match kept {
        kept if kept >= WIDEN && reach > 0.9 => (2.0 * radius).min(1.0),
        kept if kept >= NARROW => radius,
        kept if kept >= TAKE => radius / 2.0,
        // Also where the cost is NaN.
        _ => 0.35 * radius * reach.min(1.0),
    }
}

/// By how much the weights of norms grow at a time.
const GROWTH: f64 = 10.0;

/// Of the starts on one level, one in so many goes on to the next finer one.
const REDUCTION: usize = 3;

/// Tolerance and most steps where ends are starts only. Where steps are few and each takes long, a rough end tells enough.
const STRICT: f64 = 1e-5;
const LOOSE: f64 = 3e-3;
const FEW: NonZeroUsize = NonZeroUsize::new(40).unwrap();

/// Ends whose costs differ by less than this share are one.
const SAME: f64 = 1e-5;

/// Multiples of the golden ratio, without their whole part, lie evenly in the unit interval, however many there are.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Share of the start's cost below which a cost is as good as none.
const NOTHING: f64 = 1e-6;

/// One start on its way.
struct Search<'a, 'b> {
    settings: &'a Scp,
    oracle: &'a mut Oracle<'b>,
    here: Iterate,
    /// Where to begin once more with the problem's own weights.
    start: Option<Iterate>,
    curvature: DMatrix<f64>,
    radius: f64,
    start_cost: f64,
}

impl<'a, 'b> Search<'a, 'b> {
    fn new(settings: &'a Scp, oracle: &'a mut Oracle<'b>, start: &[f64]) -> Result<Self, Stop> {
        let mut here = Iterate::at(oracle, DVector::from_column_slice(start), f64::INFINITY)?;
        let start_cost = here.cost();
        here.cap = 0.0;
        let first_weight = settings.first_weight * here.cost();
        // Without other terms that are positive there is nothing to compare the norms with.
        here.cap = if first_weight > 0.0 { first_weight } else { f64::INFINITY };
        Ok(Self {
            settings,
            oracle,
            start: here.is_capped().then(|| here.clone()),
            here,
            curvature: DMatrix::zeros(start.len(), start.len()),
            radius: settings.radius,
            start_cost,
        })
    }

    /// What shares of the cost are taken of.
    fn scale(&self) -> f64 {
        self.here.cost().abs() + NOTHING * self.start_cost.abs()
    }

    /// Solves one subproblem and makes its step, or not.
    fn step(&mut self) -> Result<Option<Ending>, Stop> {
        if self.radius < SMALLEST {
            return Ok(self.finish(Ending::Stalled, false));
        }
        let region = Region::around(self.oracle.bounds(), &self.here.x, self.radius);
        let weights = self.here.weights();
        let model = self.here.model(&weights, &self.curvature, &region);
        let Some(step) = model.minimise(self.oracle, &self.here.values())? else {
            self.radius /= 4.0;
            return Ok(None);
        };
        let promised = self.here.cost() - step.cost;
        if promised <= self.settings.tolerance * self.scale() {
            return self.settle(&step);
        }
        let (there, step) = self.here.advance(self.oracle, &model, step, TAKE * promised)?;
        let kept = (self.here.cost() - there.cost()) / promised;
        let reach = region.reach(&step.d);
        if kept >= TAKE {
            self.curvature = there.curvature(self.oracle, &self.here, &step)?;
            self.here = there;
        }
        self.radius = next_radius(self.radius, kept, reach);
        Ok(None)
    }

    /// What to do where a step promises nothing.
    fn settle(&mut self, step: &Step) -> Result<Option<Ending>, Stop> {
        let slope = self.here.slope(self.oracle.bounds(), step);
        if slope <= self.settings.stationarity * self.scale() {
            return Ok(self.finish(Ending::Optimal, self.here.is_exact(step)));
        }
        // Where the cost no longer tells good steps from bad ones, the slope does.
        let there = Iterate::at(self.oracle, &self.here.x + &step.d, self.here.cap)?;
        if there.cost() <= self.here.cost() + self.settings.tolerance * self.scale() {
            self.curvature = there.curvature(self.oracle, &self.here, step)?;
            self.here = there;
        } else if self.curvature.iter().any(|&b| b != 0.0) {
            self.curvature.fill(0.0);
        } else {
            return Ok(self.finish(Ending::Stalled, false));
        }
        Ok(None)
    }

    /// Ends, unless with smaller weights than the problem's own: then goes on with larger ones. Where
    /// even the problem's own leave a norm, smaller weights led all starts towards the same few points,
    /// which need not be good ones; then begins once more with the problem's own.
    fn finish(&mut self, ending: Ending, exact: bool) -> Option<Ending> {
        if self.here.is_capped() {
            self.here.cap *= if exact { f64::INFINITY } else { GROWTH };
        } else {
            let Some(start) = self.start.take().filter(|_| !exact) else {
                return Some(ending);
            };
            self.here = Iterate { cap: f64::INFINITY, ..start };
            self.curvature.fill(0.0);
        }
        self.radius = self.radius.max(self.settings.radius);
        None
    }
}
