//! A point with its linearisation, and the steps that start there.

use nalgebra::{DMatrix, DVector};

use super::subproblem::{Model, PerPiece, Region, Step, values};
use crate::search::{Bounds, Linearisation, Multipliers, Oracle, Piece, Shape, Stop, Term};

/// Share of its largest value above which a multiplier counts.
const ACTIVE: f64 = 1e-5;

/// A point with all that is known there.
#[derive(Clone)]
pub(super) struct Iterate {
    pub(super) x: DVector<f64>,
    pub(super) parts: Linearisation,
    /// The most that a norm weighs in the search.
    pub(super) cap: f64,
}

impl Iterate {
    pub(super) fn at(oracle: &mut Oracle<'_>, x: DVector<f64>, cap: f64) -> Result<Self, Stop> {
        Ok(Self { parts: oracle.linearise(x.as_slice())?, x, cap })
    }

    /// What a term weighs in the search.
    fn weight(&self, term: &Term) -> f64 {
        if term.shape == Shape::Norm { term.weight.min(self.cap) } else { term.weight }
    }

    /// What each term weighs in the search.
    pub(super) fn weights(&self) -> Vec<f64> {
        self.parts.terms.iter().map(|term| self.weight(term)).collect()
    }

    /// The cost in the search's own weights.
    pub(super) fn cost(&self) -> f64 {
        self.parts.terms.iter().map(|term| self.weight(term) * term.value()).sum()
    }

    fn norms(&self) -> impl Iterator<Item = (usize, &Term)> {
        self.parts.terms.iter().enumerate().filter(|(_, term)| term.shape == Shape::Norm)
    }

    /// Whether some norm weighs less than its own weight.
    pub(super) fn is_capped(&self) -> bool {
        self.norms().any(|(_, term)| term.weight > self.cap)
    }

    /// Whether a larger weight of any norm would change nothing: the multipliers of all are shorter than
    /// they might be.
    pub(super) fn is_exact(&self, step: &Step) -> bool {
        self.norms().all(|(k, term)| self.vanishes(term, &step.multipliers[k]))
    }

    /// Whether a norm with these multipliers is zero: a shorter multiplier stays one whatever the weight.
    fn vanishes(&self, term: &Term, nu: &[f64]) -> bool {
        Shape::Norm.of(nu.iter().copied()) < (1.0 - ACTIVE) * self.weight(term)
    }

    /// What stands for the cost around here.
    pub(super) fn model<'a>(
        &'a self,
        weights: &'a [f64],
        curvature: &'a DMatrix<f64>,
        region: &'a Region,
    ) -> Model<'a> {
        Model { parts: &self.parts, weights, curvature, region }
    }

    /// The pieces' values.
    pub(super) fn values(&self) -> PerPiece {
        values(&self.parts)
    }

    /// Makes a step; where it gains less than `enough`, the pieces bend away from their linearisation,
    /// and a step corrected with the values found there may do better.
    pub(super) fn advance(
        &self,
        oracle: &mut Oracle<'_>,
        model: &Model<'_>,
        step: Step,
        enough: f64,
    ) -> Result<(Self, Step), Stop> {
        let there = Self::at(oracle, &self.x + &step.d, self.cap)?;
        if self.cost() - there.cost() >= enough {
            return Ok((there, step));
        }
        let values = corrected(&self.parts, &there.parts, &step.d);
        let Some(second) = model.minimise(oracle, &values)? else {
            return Ok((there, step));
        };
        let corrected = Self::at(oracle, &self.x + &second.d, self.cap)?;
        let worse = corrected.cost() >= there.cost();
        Ok(if worse { (there, step) } else { (corrected, second) })
    }

    /// The Lagrangian's largest change over half the width of the box in one variable, to first order,
    /// with the multipliers of a step from here. Towards a wall that is near it has no room to change.
    pub(super) fn slope(&self, bounds: &Bounds, step: &Step) -> f64 {
        let mut gradient = DVector::zeros(self.x.len());
        for (term, multipliers) in self.parts.terms.iter().zip(&step.multipliers) {
            for (piece, multiplier) in term.pieces.iter().zip(multipliers) {
                gradient += &piece.gradient * *multiplier;
            }
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
    /// What counts is how it bends along the pieces that are level: across them the subproblem's own
    /// cones and maxima hold the step.
    pub(super) fn curvature(
        &self,
        oracle: &mut Oracle<'_>,
        before: &Self,
        step: &Step,
    ) -> Result<DMatrix<f64>, Stop> {
        let mut multipliers = Vec::new();
        let mut level: Vec<DVector<f64>> = Vec::new();
        let terms = self.parts.terms.iter().zip(&before.parts.terms).zip(&step.multipliers);
        for ((term, before), lambda) in terms {
            let held = held(term, before, lambda);
            match term.shape {
                Shape::Norm => {
                    if self.vanishes(term, lambda) {
                        level.extend(term.pieces.iter().map(|piece| piece.gradient.clone()));
                    }
                }
                Shape::Max => level
                    .extend(held.windows(2).map(|pair| &pair[1].0.gradient - &pair[0].0.gradient)),
                // One that is between zero and all is at its kink.
                Shape::Hinge => {
                    let kinks =
                        held.iter().filter(|(_, lambda)| *lambda < (1.0 - ACTIVE) * term.weight);
                    level.extend(kinks.map(|(piece, _)| piece.gradient.clone()));
                }
            }
            multipliers.push(held.iter().map(|(piece, lambda)| (piece.id, *lambda)).collect());
        }
        let multipliers = Multipliers { terms: multipliers };
        let curvature = oracle.curvature(self.x.as_slice(), &multipliers)?;
        Ok(convex_along(&curvature, &level))
    }
}

/// The pieces of a term that continue those whose multipliers count, with these multipliers.
fn held<'a>(term: &'a Term, before: &Term, lambda: &[f64]) -> Vec<(&'a Piece, f64)> {
    let counts = |lambda: f64| term.shape == Shape::Norm || lambda > ACTIVE * before.weight;
    let pieces = before.pieces.iter().zip(lambda).filter(|(_, lambda)| counts(**lambda));
    pieces
        .filter_map(|(piece, lambda)| Some((piece.id.continued(&term.pieces)?, *lambda)))
        .collect()
}

/// Singular values of unit vectors below it tell vectors that depend on the others.
const DEPENDENT: f64 = 1e-6;

/// The part of a symmetric matrix within the space where all `level` vanish, less what is negative
/// there; zero where any number is NaN or infinite.
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

/// Values for the second-order correction: what was found at `x + d`, taken back along the
/// linearisation at `x`.
fn corrected(here: &Linearisation, there: &Linearisation, d: &DVector<f64>) -> PerPiece {
    let of_term = |(here, there): (&Term, &Term)| {
        let value = |(piece, change): (&Piece, f64)| {
            piece.id.continued(&there.pieces).map_or(piece.value, |found| found.value - change)
        };
        here.pieces.iter().zip(here.changes(d)).map(value).collect()
    };
    here.terms.iter().zip(&there.terms).map(of_term).collect()
}
