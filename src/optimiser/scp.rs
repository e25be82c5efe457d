//! Sequential convex programming on the composite cost `J = a ‖r(x)‖ + b max_p h_p(x)`.
//!
//! Each step linearises the smooth parts and leaves the norm and the maximum as they are: a conic
//! subproblem, solved by Clarabel, within a trust region (Fletcher 1982, doi:10.1007/BFb0120960, with
//! his second-order correction). Since the duration is the longest that any limit asks for, every
//! start is within the limits and stays there. Symmetric rank-one updates (Conn, Gould and Toint 1991,
//! doi:10.1007/BF01594934), with negative eigenvalues taken out so that the subproblem stays convex,
//! hold the curvature of the Lagrangian; without it steps along the active limits would be small.
//!
//! A start has been followed to its end when a step promises next to nothing and the Lagrangian's
//! slope, first-order optimality, is next to nothing too.

use std::num::NonZeroUsize;

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::conic::{Step, Subproblem};
use super::{Optimiser, uniform_point};
use crate::input::{count, fraction, positive};
use crate::oracle::{Oracle, Rng, Stop};
use crate::problem::{Linearisation, Piece};

/// Settings of sequential convex programming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Scp {
    /// random starts, each followed to its local optimum
    #[serde(deserialize_with = "count::<1_000_000_000, _, _>")]
    pub starts: NonZeroUsize,
    /// most steps from one start
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub steps: NonZeroUsize,
    /// first radius of the trust region, as a fraction of the box's half-width
    #[serde(deserialize_with = "fraction")]
    pub radius: f64,
    /// a start may end when a step promises to lower J by less than this share of it
    #[serde(deserialize_with = "positive")]
    pub tolerance: f64,
    /// and ends when the Lagrangian's slope in every coefficient is also below this share of J
    #[serde(deserialize_with = "positive")]
    pub stationarity: f64,
}

impl Default for Scp {
    fn default() -> Self {
        let [starts, steps] = [30, 200].map(|n| NonZeroUsize::MIN.saturating_add(n - 1));
        Self { starts, steps, radius: 0.3, tolerance: 1e-9, stationarity: 1e-5 }
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
        let mut x = vec![0.0; oracle.bounds().len()];
        for _ in 0..self.starts.get() {
            uniform_point(oracle, rng, &mut x);
            self.follow(oracle, &x)?;
        }
        Ok(())
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
    /// Follows one start to a local optimum.
    pub fn follow(&self, oracle: &mut Oracle<'_>, start: &[f64]) -> Result<Ending, Stop> {
        let mut here = Iterate::at(oracle, DVector::from_column_slice(start))?;
        let mut curvature = Curvature::none(start.len());
        let mut radius = self.radius;
        for _ in 0..self.steps.get() {
            if radius < SMALLEST {
                return Ok(Ending::Stalled);
            }
            let region = Region::around(oracle, &here.x, radius);
            let Some(step) =
                region.solve(oracle, &here.parts, &Values::of(&here.parts), &curvature)
            else {
                radius /= 4.0;
                continue;
            };
            let promised = here.cost - step.cost;
            if promised <= self.tolerance * here.cost.abs() {
                // What the subproblem's curvature holds back is the Lagrangian's slope.
                let slope = (&curvature.0 * &step.d).amax();
                if slope <= self.stationarity * here.cost.abs() {
                    return Ok(Ending::Optimal);
                }
                curvature.0 *= 0.1;
                continue;
            }
            let (there, step) = here.advance(oracle, &region, step, promised, &curvature)?;
            let kept = (here.cost - there.cost) / promised;
            let reach = region.reach(&step.d);
            if kept >= TAKE {
                curvature.update(&here.parts, &there.parts, &step);
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
    cost: f64,
    parts: Linearisation,
}

impl Iterate {
    fn at(oracle: &mut Oracle<'_>, x: DVector<f64>) -> Result<Self, Stop> {
        let cost = oracle.evaluate(x.as_slice())?.cost;
        let parts = oracle.linearise(x.as_slice())?;
        Ok(Self { x, cost, parts })
    }

    /// Makes a step; where it keeps little of what it promised, the parts bend away from their
    /// linearisation, and a step corrected with the values found there may do better.
    fn advance(
        &self,
        oracle: &mut Oracle<'_>,
        region: &Region,
        step: Step,
        promised: f64,
        curvature: &Curvature,
    ) -> Result<(Self, Step), Stop> {
        let there = Self::at(oracle, &self.x + &step.d)?;
        if self.cost - there.cost >= TAKE * promised {
            return Ok((there, step));
        }
        let values = corrected(&self.parts, &there.parts, &step.d);
        let Some(second) = region.solve(oracle, &self.parts, &values, curvature) else {
            return Ok((there, step));
        };
        let x = &self.x + &second.d;
        if oracle.evaluate(x.as_slice())?.cost < there.cost {
            Ok((Self::at(oracle, x)?, second))
        } else {
            Ok((there, step))
        }
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

    /// Solves the subproblem with these values of `r` and `h`, the linearisation's or corrected ones.
    fn solve(
        &self,
        oracle: &mut Oracle<'_>,
        parts: &Linearisation,
        values: &Values,
        curvature: &Curvature,
    ) -> Option<Step> {
        let Values { residual, pieces } = values;
        let Self { lower, upper, .. } = self;
        let curvature = &curvature.0;
        let problem = Subproblem { parts, residual, values: pieces, curvature, lower, upper };
        oracle.conic(|| problem.solve())
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

/// A positive semidefinite approximation of the Lagrangian's second derivative.
struct Curvature(DMatrix<f64>);

impl Curvature {
    fn none(variables: usize) -> Self {
        Self(DMatrix::zeros(variables, variables))
    }

    fn is_none(&self) -> bool {
        self.0.iter().all(|&b| b == 0.0)
    }

    /// Takes in the change of the Lagrangian's gradient along a step.
    fn update(&mut self, here: &Linearisation, there: &Linearisation, step: &Step) {
        let s = &step.d;
        let mut y = (&there.residual_jacobian - &here.residual_jacobian).tr_mul(&step.nu);
        for (piece, lambda) in here.pieces.iter().zip(step.lambda.iter()) {
            if let Some(found) = continued(piece, there) {
                y += (&found.gradient - &piece.gradient) * *lambda;
            }
        }
        if self.is_none() {
            self.0.fill_diagonal(s.dot(&y).abs() / s.dot(s));
        }
        let miss = y - &self.0 * s;
        let slope = miss.dot(s);
        if slope.abs() > 1e-8 * miss.norm() * s.norm() {
            self.0 += &miss * miss.transpose() / slope;
        }
        if !self.0.iter().all(|b| b.is_finite()) {
            *self = Self::none(s.len());
            return;
        }
        let eigen = self.0.clone().symmetric_eigen();
        let kept = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
        self.0 = &eigen.eigenvectors * kept * eigen.eigenvectors.transpose();
    }
}
