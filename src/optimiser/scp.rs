//! Sequential convex programming on the composite cost `J = a ‖r(x)‖ + b max_p h_p(x)`.
//!
//! Each step linearises the smooth parts and leaves the norm and the maximum as they are: a conic
//! subproblem, solved by Clarabel, within a trust region (Fletcher 1982, doi:10.1007/BFb0120960, with
//! his second-order correction). Since the duration is the longest that any limit asks for, every
//! start is within the limits and stays there. The Lagrangian's second derivative along the active
//! parts, with what is negative taken out so that the subproblem stays convex, makes the last steps
//! those of Newton's method.
//!
//! The norm is an exact penalty: as soon as `a` exceeds the multiplier of `r = 0` the minimum no longer
//! depends on it. The task's weight is many times that, which makes a search hug `r = 0`, slow and
//! soon in a poor valley; so the search starts with a smaller one and raises it only as it must.
//!
//! A start has been followed to its end when, with the task's own weight, a step promises next to
//! nothing and the Lagrangian's slope, first-order optimality, is next to nothing too.

use std::num::NonZeroUsize;

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Optimiser;
use super::conic::{Step, Subproblem};
use crate::input::{count, fraction, optional_count, positive};
use crate::oracle::{Oracle, Rng, Stop};
use crate::problem::{Bounds, Linearisation, Multipliers, Piece};

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
    #[serde(deserialize_with = "fraction")]
    pub radius: f64,
    /// first weight of the base's error, in costs of the start's duration; it grows to the task's own
    #[serde(deserialize_with = "positive")]
    pub first_weight: f64,
    /// a start may end when a step promises to lower J by less than this share of it
    #[serde(deserialize_with = "positive")]
    pub tolerance: f64,
    /// and ends when the Lagrangian's slope in every coefficient is also below this share of J
    #[serde(deserialize_with = "positive")]
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
    /// The trust region shrank to nothing.
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
}

/// The trust region's smallest radius.
const SMALLEST: f64 = 1e-9;

/// Share of the promised gain that a step has to keep to be taken, not to narrow the region, and to
/// widen it.
const TAKE: f64 = 0.05;
const NARROW: f64 = 0.3;
const WIDEN: f64 = 0.7;

impl Scp {
    /// Minimises with `first` as the first start, where there is one.
    pub(super) fn minimise_from(
        &self,
        first: Option<&[f64]>,
        oracle: &mut Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<(), Stop> {
        let usual = if first.is_some() { 1 } else { 100 };
        let starts = self.starts.map_or(usual, NonZeroUsize::get);
        if let Some(first) = first {
            self.follow(oracle, first)?;
        }
        for _ in usize::from(first.is_some())..starts {
            self.follow(oracle, &Self::start(oracle.bounds(), rng))?;
        }
        Ok(())
    }

    /// Draws a start uniformly from the box shrunk about its middle, by the square of a number drawn
    /// uniformly from the unit interval: most tasks are solved best from near the middle, some only
    /// from far out.
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
        let mut here = Iterate::at(oracle, DVector::from_column_slice(start))?;
        let full_weight = here.parts.norm_weight;
        here = here.weighed(0.0);
        let first_weight = self.first_weight * here.cost();
        here = here.weighed(first_weight.min(full_weight));
        let mut curvature = DMatrix::zeros(start.len(), start.len());
        let mut radius = self.radius;
        for _ in 0..self.steps.get() {
            if radius < SMALLEST {
                return Ok(Ending::Stalled);
            }
            let region = Region::around(oracle, &here.x, radius);
            let model = Model { region: &region, parts: &here.parts, curvature: &curvature };
            let Some(step) = model.minimise(oracle, &Values::of(&here.parts)) else {
                radius /= 4.0;
                continue;
            };
            let promised = here.cost() - step.cost;
            if promised <= self.tolerance * here.cost() {
                // What the subproblem's curvature holds back is the Lagrangian's slope.
                let slope = (&curvature * &step.d).amax();
                if slope > self.stationarity * here.cost() {
                    curvature.fill(0.0);
                } else if here.parts.norm_weight < full_weight {
                    // A shorter multiplier stays one whatever the weight.
                    let exact = step.nu.norm() < (1.0 - ACTIVE) * here.parts.norm_weight;
                    let weight = if exact { full_weight } else { GROWTH * here.parts.norm_weight };
                    here = here.weighed(weight.min(full_weight));
                    radius = radius.max(self.radius);
                } else {
                    return Ok(Ending::Optimal);
                }
                continue;
            }
            let (there, step) = here.advance(oracle, &model, step, promised)?;
            let kept = (here.cost() - there.cost()) / promised;
            let reach = region.reach(&step.d);
            if kept >= TAKE {
                curvature = there.curvature(oracle, &here, &step)?;
                here = there;
            }
            radius = match kept {
                kept if kept >= WIDEN && reach > 0.9 => (2.0 * radius).min(1.0),
                kept if kept >= NARROW => radius,
                kept if kept >= TAKE => radius / 2.0,
                // Also a cost that is no number.
                _ => 0.35 * radius * reach.min(1.0),
            };
        }
        Ok(Ending::StepsSpent)
    }
}

/// A point with all that is known there.
struct Iterate {
    x: DVector<f64>,
    /// With the weight of the norm that the search works with.
    parts: Linearisation,
}

impl Iterate {
    fn at(oracle: &mut Oracle<'_>, x: DVector<f64>) -> Result<Self, Stop> {
        Ok(Self { parts: oracle.linearise(x.as_slice())?, x })
    }

    /// Makes the norm weigh so much.
    fn weighed(mut self, norm_weight: f64) -> Self {
        self.parts.norm_weight = norm_weight;
        self
    }

    /// The cost in the search's own weights.
    fn cost(&self) -> f64 {
        self.parts.cost()
    }

    /// Makes a step; where it keeps little of what it promised, the parts bend away from their
    /// linearisation, and a step corrected with the values found there may do better.
    fn advance(
        &self,
        oracle: &mut Oracle<'_>,
        model: &Model<'_>,
        step: Step,
        promised: f64,
    ) -> Result<(Self, Step), Stop> {
        let weight = self.parts.norm_weight;
        let there = Self::at(oracle, &self.x + &step.d)?.weighed(weight);
        if self.cost() - there.cost() >= TAKE * promised {
            return Ok((there, step));
        }
        let values = corrected(&self.parts, &there.parts, &step.d);
        let Some(second) = model.minimise(oracle, &values) else {
            return Ok((there, step));
        };
        let corrected = Self::at(oracle, &self.x + &second.d)?.weighed(weight);
        Ok(if corrected.cost() < there.cost() { (corrected, second) } else { (there, step) })
    }

    /// The Lagrangian's second derivative here, with the multipliers of the step that led here.
    ///
    /// What counts is how it bends along the parts that are level: across them the subproblem's own
    /// cone and maximum hold the step.
    fn curvature(
        &self,
        oracle: &mut Oracle<'_>,
        before: &Self,
        step: &Step,
    ) -> Result<DMatrix<f64>, Stop> {
        let held = before.parts.pieces.iter().zip(step.lambda.iter());
        let held: Vec<_> = held
            .filter(|(_, lambda)| **lambda > ACTIVE * before.parts.max_weight)
            .filter_map(|(piece, lambda)| Some((continued(piece, &self.parts)?, *lambda)))
            .collect();
        let multipliers = Multipliers {
            residual: step.nu.clone(),
            pieces: held.iter().map(|(piece, lambda)| (piece.place, *lambda)).collect(),
        };
        let mut level: Vec<DVector<f64>> = Vec::new();
        if step.nu.norm() < (1.0 - ACTIVE) * self.parts.norm_weight {
            level.extend(self.parts.residual_jacobian.row_iter().map(|row| row.transpose()));
        }
        level.extend(held.windows(2).map(|pair| &pair[1].0.gradient - &pair[0].0.gradient));
        let curvature = oracle.curvature(self.x.as_slice(), &multipliers)?;
        Ok(convex_along(&curvature, &level))
    }
}

/// By how much the weight of the norm grows at a time.
const GROWTH: f64 = 10.0;

/// Share of its largest value above which a multiplier counts.
const ACTIVE: f64 = 1e-5;

/// The part of a symmetric matrix within the space where all `level` vanish, less what is negative
/// there.
fn convex_along(matrix: &DMatrix<f64>, level: &[DVector<f64>]) -> DMatrix<f64> {
    let mut within = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let unit: Vec<_> = level.iter().filter_map(|v| v.try_normalize(0.0)).collect();
    if !unit.is_empty() {
        let svd = DMatrix::from_columns(&unit).svd(true, false);
        for (direction, size) in
            svd.u.iter().flat_map(|u| u.column_iter()).zip(&svd.singular_values)
        {
            if *size > 1e-6 {
                within -= direction * direction.transpose();
            }
        }
    }
    let eigen = (&within * matrix * &within).symmetric_eigen();
    let kept = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
    &eigen.eigenvectors * kept * eigen.eigenvectors.transpose()
}

/// The subproblem around a point: parts made linear, within a region.
struct Model<'a> {
    region: &'a Region,
    parts: &'a Linearisation,
    curvature: &'a DMatrix<f64>,
}

impl Model<'_> {
    /// Its minimum with these values of `r` and `h`, the linearisation's or corrected ones.
    fn minimise(&self, oracle: &mut Oracle<'_>, values: &Values) -> Option<Step> {
        let Values { residual, pieces } = values;
        let Self { region: Region { lower, upper, .. }, parts, curvature } = self;
        let problem = Subproblem { parts, residual, values: pieces, curvature, lower, upper };
        oracle.conic(|| problem.solve())
    }
}

/// The part of the box within the trust region, as bounds on the step.
struct Region {
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The region's extent in each variable.
    extent: Vec<f64>,
}

impl Region {
    fn around(oracle: &Oracle<'_>, x: &DVector<f64>, radius: f64) -> Self {
        let bounds = oracle.bounds().iter();
        let extent: Vec<f64> = bounds.map(|[l, u]| radius * (u - l) / 2.0).collect();
        let bounds = oracle.bounds().iter().zip(x.iter()).zip(&extent);
        let (lower, upper) = bounds
            .map(|(([l, u], x), e)| ((l - x).max(-e).min(0.0), (u - x).min(*e).max(0.0)))
            .unzip();
        Self { lower, upper, extent }
    }

    /// How far towards the region's wall a step goes; 1 is on it.
    fn reach(&self, d: &DVector<f64>) -> f64 {
        d.iter().zip(&self.extent).map(|(d, extent)| d.abs() / extent).fold(0.0, f64::max)
    }
}

/// The piece at another point that continues `piece`.
fn continued<'a>(piece: &Piece, there: &'a Linearisation) -> Option<&'a Piece> {
    let same =
        |p: &&Piece| p.place.joint == piece.place.joint && p.place.order == piece.place.order;
    let distance = |p: &&Piece| (p.place.tau - piece.place.tau).abs();
    let nearest = there.pieces.iter().filter(same);
    nearest.min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|p| distance(p) < 0.1)
}

/// The values of `r` and of every `h`.
struct Values {
    residual: DVector<f64>,
    pieces: Vec<f64>,
}

impl Values {
    fn of(parts: &Linearisation) -> Self {
        let pieces = parts.pieces.iter().map(|piece| piece.value).collect();
        Self { residual: parts.residual.clone(), pieces }
    }
}

/// Values for the second-order correction: what was found at `x + d`, taken back along the
/// linearisation at `x`.
fn corrected(here: &Linearisation, there: &Linearisation, d: &DVector<f64>) -> Values {
    let residual = &there.residual - &here.residual_jacobian * d;
    let value = |piece: &Piece| {
        let found = continued(piece, there).map(|found| found.value - piece.gradient.dot(d));
        found.unwrap_or(piece.value)
    };
    Values { residual, pieces: here.pieces.iter().map(value).collect() }
}
