//! A point with its linearisation, and the steps that start there.

use nalgebra::{DMatrix, DVector};

use super::ACTIVE;
use super::subproblem::{Model, Step, Values};
use crate::search::{Bounds, Linearisation, Multipliers, Piece};
use crate::search::{Oracle, Stop};

/// A point with all that is known there.
#[derive(Clone)]
pub(super) struct Iterate {
    pub(super) x: DVector<f64>,
    /// With the weight of the norm that the search works with.
    pub(super) parts: Linearisation,
}

impl Iterate {
    pub(super) fn at(oracle: &mut Oracle<'_>, x: DVector<f64>) -> Result<Self, Stop> {
        Ok(Self { parts: oracle.linearise(x.as_slice())?, x })
    }

    /// Makes the norm weigh so much.
    pub(super) fn weighed(mut self, norm_weight: f64) -> Self {
        self.parts.norm_weight = norm_weight;
        self
    }

    /// The cost in the search's own weights.
    pub(super) fn cost(&self) -> f64 {
        self.parts.cost()
    }

    /// Makes a step; where it gains less than `enough`, the parts bend away from their linearisation,
    /// and a step corrected with the values found there may do better.
    pub(super) fn advance(
        &self,
        oracle: &mut Oracle<'_>,
        model: &Model<'_>,
        step: Step,
        enough: f64,
    ) -> Result<(Self, Step), Stop> {
        let weight = self.parts.norm_weight;
        let there = Self::at(oracle, &self.x + &step.d)?.weighed(weight);
        if self.cost() - there.cost() >= enough {
            return Ok((there, step));
        }
        let values = corrected(&self.parts, &there.parts, &step.d);
        let Some(second) = model.minimise(oracle, &values)? else {
            return Ok((there, step));
        };
        let corrected = Self::at(oracle, &self.x + &second.d)?.weighed(weight);
        let worse = corrected.cost() >= there.cost();
        Ok(if worse { (there, step) } else { (corrected, second) })
    }

    /// The Lagrangian's largest change over half the width of the box in one variable, to first order,
    /// with the multipliers of a step from here. Towards a wall that is near it has no room to change.
    pub(super) fn slope(&self, bounds: &Bounds, step: &Step) -> f64 {
        let mut gradient = self.parts.residual_jacobian.tr_mul(&step.nu);
        for (piece, lambda) in self.parts.pieces.iter().zip(step.lambda.iter()) {
            gradient += &piece.gradient * *lambda;
        }
        let variables = gradient.iter().zip(self.x.iter()).zip(bounds.iter());
        let change = |((slope, x), [lower, upper]): ((&f64, &f64), [f64; 2])| {
            let wall = if *slope > 0.0 { lower } else { upper };
            let half = (upper - lower) / 2.0;
            slope.abs() * half.min((x - wall).abs() / ACTIVE)
        };
        variables.map(change).fold(0.0, f64::max)
    }

    /// The Lagrangian's second derivative here, with the multipliers of the step that led here.
    ///
    /// What counts is how it bends along the parts that are level: across them the subproblem's own
    /// cone and maximum hold the step.
    pub(super) fn curvature(
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

/// Singular values of unit vectors below it tell vectors that depend on the others.
const DEPENDENT: f64 = 1e-6;

/// The part of a symmetric matrix within the space where all `level` vanish, less what is negative
/// there; nothing where a number is none.
fn convex_along(matrix: &DMatrix<f64>, level: &[DVector<f64>]) -> DMatrix<f64> {
    let mut numbers = level.iter().flat_map(|v| v.iter()).chain(matrix.iter());
    if !numbers.all(|number| number.is_finite()) {
        return DMatrix::zeros(matrix.nrows(), matrix.ncols());
    }
    let mut within = DMatrix::identity(matrix.nrows(), matrix.ncols());
    let unit: Vec<_> = level.iter().filter_map(|v| v.try_normalize(0.0)).collect();
    if !unit.is_empty() {
        let svd = DMatrix::from_columns(&unit).svd(true, false);
        let directions = svd.u.iter().flat_map(|u| u.column_iter());
        for (direction, size) in directions.zip(&svd.singular_values) {
            if *size > DEPENDENT {
                within -= direction * direction.transpose();
            }
        }
    }
    let eigen = (&within * matrix * &within).symmetric_eigen();
    let kept = DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0)));
    &eigen.eigenvectors * kept * eigen.eigenvectors.transpose()
}

/// How far, in normalised time, a peak may move in a step.
const SAME_PEAK: f64 = 0.1;

/// The piece at another point that continues `piece`.
fn continued<'a>(piece: &Piece, there: &'a Linearisation) -> Option<&'a Piece> {
    let same =
        |p: &&Piece| p.place.joint == piece.place.joint && p.place.order == piece.place.order;
    let distance = |p: &&Piece| (p.place.tau - piece.place.tau).abs();
    let nearest = there.pieces.iter().filter(same);
    nearest.min_by(|a, b| distance(a).total_cmp(&distance(b))).filter(|p| distance(p) < SAME_PEAK)
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
