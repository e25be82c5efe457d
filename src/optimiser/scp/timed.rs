//! The search on a [`Timed`](crate::search::Timed) cost, for many variables.
//!
//! Limits and time are in the model as they are, so nothing bends away from it but the error, whose second derivatives are
//! taken in a few directions only (see [`bends`](super::bends)).
//!
//! The error's weight begins small, as in the search on other costs. It grows where a step would leave most of the error
//! for the sake of time, so a start that is far from its goal first reaches it and then hastens, and falls to a few times
//! the error's multiplier once the error is gone: any larger weight would only make steps short.

use nalgebra::DVector;

use super::bends::{Bends, Curvature};
use super::subproblem::Region;
use super::timed_subproblem::{Cuts, Model, Solution};
use super::{Ending, NARROW, SMALLEST, Scp, TAKE, WIDEN, next_radius};
use crate::search::{Bent, Fold, Oracle, Piece, PieceId, Stop, TimedParts, TimedWeights};

/// Share of the settings' first weight that the error's weight begins with: it grows where it has to, step by step, and a
/// larger one leads into poor valleys more often.
const START: f64 = 0.5;

/// A step that would leave more of the error than this share of it calls for a larger weight.
const LEFT: f64 = 0.9;

/// How near to its bound, the weight, the length of a multiplier is at it.
const BOUND: f64 = 0.99;

/// By how much the weight grows at a time, and how many times the multiplier's length it is when the error is gone.
const GROWTH: f64 = 4.0;

/// Below it an error is gone, as far as the weight is concerned.
const GONE: f64 = 1e-3;

/// Multipliers below this share of the error's weight are none.
const NOTHING: f64 = 1e-6;

/// A step that gains so many times what it promised was held back by folds that bend too much.
const MORE: f64 = 1.2;

/// How often the weight may fall.
const FALLS: usize = 20;

/// One start on its way.
pub(super) struct Search<'a, 'b> {
    settings: &'a Scp,
    oracle: &'a mut Oracle<'b>,
    weights: TimedWeights,
    x: DVector<f64>,
    here: TimedParts,
    /// What the error weighs in the search.
    weight: f64,
    falls: usize,
    radius: f64,
    /// The error's multiplier.
    nu: DVector<f64>,
    bends: Bends,
    /// The multipliers of pieces that bend.
    multipliers: Vec<(PieceId, f64)>,
    /// How these bend at the present point, once that was asked for.
    folds: Option<Vec<Fold>>,
    /// What share of that is taken.
    fold_share: f64,
    cuts: Cuts,
    last: Option<DVector<f64>>,
}

impl<'a, 'b> Search<'a, 'b> {
    pub(super) fn new(
        settings: &'a Scp,
        oracle: &'a mut Oracle<'b>,
        weights: TimedWeights,
        start: &[f64],
    ) -> Result<Self, Stop> {
        let here = oracle.timing(start)?;
        let first = START * settings.first_weight * weights.time * here.time();
        Ok(Self {
            weight: if first > 0.0 { weights.error.min(first) } else { weights.error },
            falls: 0,
            radius: settings.radius,
            nu: DVector::zeros(here.error.value.len()),
            x: DVector::from_column_slice(start),
            bends: Bends::default(),
            multipliers: Vec::new(),
            folds: None,
            fold_share: 1.0,
            cuts: Cuts::default(),
            last: None,
            settings,
            oracle,
            weights,
            here,
        })
    }

    /// The weights of the search.
    fn own_weights(&self) -> TimedWeights {
        TimedWeights { error: self.weight, ..self.weights }
    }

    fn cost(&self, parts: &TimedParts) -> f64 {
        self.own_weights().cost(parts)
    }

    /// Solves one subproblem and makes its step, or not.
    pub(super) fn step(&mut self) -> Result<Option<Ending>, Stop> {
        if self.radius < SMALLEST {
            return Ok(Some(Ending::Stalled));
        }
        let region = Region::around(self.oracle.bounds(), &self.x, self.radius);
        let curvature = self.curvature()?;
        let Some(step) = self.weighed(&region, &curvature)? else {
            self.radius /= 4.0;
            return Ok(None);
        };
        let here = self.cost(&self.here);
        let promised = here - step.cost;
        if promised <= self.settings.tolerance * here.abs() {
            return Ok(self.settle(&step));
        }
        let (there, step) = self.advance(step, here - WIDEN * promised, &region, &curvature)?;
        let kept = (here - self.cost(&there)) / promised;
        let reach = region.reach(&step.d);
        self.relax(&there, &step);
        // Folds are the positive part of how pieces bend, and where the negative one counts, steps gain more than they promise.
        if kept > MORE {
            self.fold_share /= GROWTH;
        } else if kept < NARROW {
            self.fold_share = (GROWTH * self.fold_share).min(1.0);
        }
        if kept >= TAKE {
            self.x += &step.d;
            self.bends.told = None;
            self.folds = None;
            self.cuts.move_by(&step.d);
            self.here = there;
        }
        self.nu = step.nu;
        let least = NOTHING * self.weight;
        let pieces = step.multipliers.iter().filter(|(_, multiplier)| *multiplier > least);
        self.multipliers = pieces.copied().collect();
        self.last = Some(step.d);
        self.radius = next_radius(self.radius, kept, reach);
        Ok(None)
    }

    /// How the error bends; of no weight before the first subproblem.
    fn curvature(&mut self) -> Result<Curvature, Stop> {
        if self.nu.norm() == 0.0 {
            return Ok(Curvature::default());
        }
        if self.bends.told.is_none() {
            self.bends.told = Some(self.oracle.bends(self.x.as_slice(), self.nu.len())?);
        }
        if self.folds.is_none() {
            let pieces = self.here.bent.pieces();
            let continued =
                |(id, multiplier): &(PieceId, f64)| Some((id.continued(&pieces)?.id, *multiplier));
            let here: Vec<_> = self.multipliers.iter().filter_map(continued).collect();
            let folds = if here.is_empty() {
                Vec::new()
            } else {
                self.oracle.folds(self.x.as_slice(), &here)?
            };
            self.folds = Some(folds);
        }
        let folds = self.folds.as_deref().unwrap_or_default();
        Ok(self.bends.curvature(&self.nu).folded(folds, self.fold_share))
    }

    /// A step, with a weight of the error that does not leave most of it.
    fn weighed(
        &mut self,
        region: &Region,
        curvature: &Curvature,
    ) -> Result<Option<Solution>, Stop> {
        loop {
            let error = self.here.error.value.clone();
            let bent = self.here.bent.clone();
            let found = self.minimise(region, &error, &bent, curvature)?;
            let Some(step) = found else { return Ok(None) };
            let is_bound = step.nu.norm() > BOUND * self.weight;
            if !is_bound || step.left <= LEFT * error.norm() || self.weight >= self.weights.error {
                return Ok(Some(step));
            }
            self.weight = (GROWTH * self.weight).min(self.weights.error);
        }
    }

    /// Lets the weight fall where the error is gone.
    fn relax(&mut self, there: &TimedParts, step: &Solution) {
        let enough = GROWTH * step.nu.norm();
        if there.error.value.norm() < GONE && enough < self.weight && self.falls < FALLS {
            let least = self.weights.time * there.time() / 10.0;
            self.weight = enough.max(least).min(self.weight);
            self.falls += 1;
        }
    }

    /// What to do where a step promises nothing.
    fn settle(&mut self, step: &Solution) -> Option<Ending> {
        let is_bound = step.nu.norm() > BOUND * self.weight;
        if !is_bound || self.weight >= self.weights.error {
            return Some(Ending::Optimal);
        }
        self.weight = (GROWTH * self.weight).min(self.weights.error);
        self.radius = self.radius.max(self.settings.radius);
        None
    }

    /// Makes a step; where its cost is above `enough`, the error bends away from its linearisation, and a step corrected
    /// with the error found there may do better.
    fn advance(
        &mut self,
        step: Solution,
        enough: f64,
        region: &Region,
        curvature: &Curvature,
    ) -> Result<(TimedParts, Solution), Stop> {
        let there = self.attempt(&step)?;
        if self.cost(&there) <= enough {
            return Ok((there, step));
        }
        let error = &there.error.value - &self.here.error.slopes * &step.d;
        let bent = corrected(&self.here.bent, &there.bent, &step.d);
        let Some(second) = self.minimise(region, &error, &bent, curvature)? else {
            return Ok((there, step));
        };
        let corrected = self.attempt(&second)?;
        let is_better = self.cost(&corrected) < self.cost(&there);
        Ok(if is_better { (corrected, second) } else { (there, step) })
    }

    fn attempt(&mut self, step: &Solution) -> Result<TimedParts, Stop> {
        let there = self.oracle.timing((&self.x + &step.d).as_slice())?;
        self.bends.remember(&step.d, &there.error.slopes - &self.here.error.slopes);
        Ok(there)
    }

    fn minimise(
        &mut self,
        region: &Region,
        error: &DVector<f64>,
        bent: &Bent,
        curvature: &Curvature,
    ) -> Result<Option<Solution>, Stop> {
        let model = Model {
            weights: self.own_weights(),
            here: self.cost(&self.here),
            x: &self.x,
            time: self.here.time(),
            limits: &self.here.limits,
            error,
            slopes: &self.here.error.slopes,
            bent,
            curvature,
            region,
            last: self.last.as_ref(),
        };
        model.minimise(self.oracle, &mut self.cuts)
    }
}

/// Values of pieces for a second-order correction: what was found at `x + d`, taken back along the linearisation at `x`.
fn corrected(here: &Bent, there: &Bent, d: &DVector<f64>) -> Bent {
    let correct = |pieces: &mut [Piece], there: &[Piece]| {
        for piece in pieces {
            if let Some(found) = piece.id.continued(there) {
                piece.value = found.value - piece.gradient.dot(d);
            }
        }
    };
    let mut bent = here.clone();
    correct(&mut bent.durations, &there.durations);
    for (term, there) in bent.terms.iter_mut().zip(&there.terms) {
        correct(&mut term.pieces, &there.pieces);
    }
    bent
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::search::{
        Bend, Bounds, ErrorSlopes, Evaluation, Failure, LinearLimits, Problem, Rng, Timed, Watch,
    };

    /// Both `|x_0 + 5|` and a duration `3 + x_0 + ½ c (x_0 − 2)²` fall from `x_0 = 2` on; the duration is said to bend by `c'`.
    struct Falling {
        bounds: Bounds,
        bend: f64,
        told: f64,
    }

    impl Falling {
        fn first() -> Vec<f64> {
            let mut gradient = vec![0.0; 6];
            gradient[0] = 1.0;
            gradient
        }

        /// The shares of the folds after each of some steps.
        fn shares<const STEPS: usize>(bend: f64, told: f64, first: f64) -> [f64; STEPS] {
            let problem = Self { bounds: Bounds::cube(6, [-2.0, 2.0]), bend, told };
            let (watch, settings) = (Watch::default(), Scp::default());
            let mut oracle = Oracle::new(&problem, 1_000, &watch);
            let start = [2.0, 0.0, 0.0, 0.0, 0.0, 0.0];
            let weights = problem.weights();
            let mut search = Search::new(&settings, &mut oracle, weights, &start).unwrap();
            search.fold_share = first;
            std::array::from_fn(|_| {
                assert_eq!(search.step(), Ok(None));
                search.fold_share
            })
        }
    }

    impl Problem for Falling {
        fn bounds(&self) -> &Bounds {
            &self.bounds
        }

        fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
            Ok(self.weights().evaluation(&self.parts(x)?))
        }

        fn timed(&self) -> Option<&dyn Timed> {
            Some(self)
        }
    }

    impl Timed for Falling {
        fn limits(&self, _: &[f64]) -> Result<LinearLimits, Failure> {
            Ok(LinearLimits::default())
        }

        fn error(&self, x: &[f64]) -> Result<ErrorSlopes, Failure> {
            let slopes = DMatrix::from_row_slice(1, 6, &Self::first());
            Ok(ErrorSlopes { value: DVector::from_element(1, x[0] + 5.0), slopes })
        }

        fn bent(&self, x: &[f64]) -> Result<Bent, Failure> {
            let (d, mut gradient) = (x[0] - 2.0, Self::first());
            gradient[0] += self.bend * d;
            let duration = Piece::new(0, 3.0 + x[0] + 0.5 * self.bend * d * d, gradient);
            Ok(Bent::new(vec![duration], Vec::new(), 0.0))
        }

        fn bends(&self, _: &[f64]) -> Result<Vec<Bend>, Failure> {
            Ok(Vec::new())
        }

        fn folds(&self, _: &[f64], _: &[(PieceId, f64)]) -> Result<Vec<Fold>, Failure> {
            let direction = DVector::from_vec(Self::first());
            Ok(vec![Fold { direction, curvature: self.told }])
        }

        fn weights(&self) -> TimedWeights {
            TimedWeights { time: 1.0, error: 1.0, excess: 1.0 }
        }

        fn start(&self, _: &mut Rng, _: f64) -> Vec<f64> {
            vec![0.0; 6]
        }
    }

    /// Of a straight slope a step within the region, by a model that bends, gains twice what it promises. The first step has no
    /// multipliers yet, and so no folds.
    #[test]
    fn folds_that_hold_steps_back_are_taken_for_less() {
        assert_eq!(Falling::shares(0.0, 1e3, 1.0), [1.0, 0.25, 0.0625]);
        // Steps to the region's wall are not held back.
        assert_eq!(Falling::shares(0.0, 1e-3, 1.0), [1.0; 3]);
    }

    /// The first step, of 0.2, promises 0.4; a bend of 20 takes all of that away.
    #[test]
    fn folds_are_taken_for_more_where_steps_keep_too_little() {
        assert_eq!(Falling::shares(20.0, 20.0, 0.125), [0.5]);
        assert_eq!(Falling::shares(20.0, 20.0, 0.5), [1.0]);
    }
}
