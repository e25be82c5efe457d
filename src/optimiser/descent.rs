//! What gradient methods of the crate basin share: starts, and the oracle as basin sees it.
//!
//! They move within the box scaled to the unit cube, so that the units of the variables do not matter, and start where
//! [`Scp`] does. Every evaluation comes with a subgradient. Where a cost has a kink a method may end early: then, as
//! where it has converged or failed, the next start follows.

use std::cell::RefCell;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, CountsMirror, Executor, Gradient, InitialState, Solver, State,
};

use super::places::{mirror_from_unit, rank};
use super::scp::Scp;
use crate::search::{Failure, Oracle, Rng, Stop};

/// Follows one random start after the other until the oracle stops, each by a method of its own.
pub(super) fn from_random_starts<'b, M, S>(
    oracle: &mut Oracle<'b>,
    rng: &mut Rng,
    method: impl Fn() -> M,
) -> Result<(), Stop>
where
    M: for<'a> Solver<UnitCube<'a, 'b>, S, Error = ConstraintSolveError<Stop>>
        + InitialState<Vec<f64>, State = S>,
    S: State<Param = Vec<f64>, Float = f64> + CountsMirror,
{
    for drawn in 0.. {
        let start = Scp::random_start(oracle, rng, drawn);
        let place = |(x, [lower, upper]): (&f64, [f64; 2])| {
            if upper > lower { (x - lower) / (upper - lower) } else { 0.5 }
        };
        let start: Vec<f64> = start.iter().zip(oracle.bounds().iter()).map(place).collect();
        let cube = UnitCube::new(oracle);
        let run = Executor::from_start(cube, method(), start).max_iter(u64::MAX).run();
        run.map_err(|error| match error {
            ConstraintSolveError::Evaluation(stop) => stop,
            error => Failure::new(error.to_string()).into(),
        })?;
    }
    Ok(())
}

/// The oracle as basin sees it: its box is the unit cube, and slopes are by the cube's variables.
pub(super) struct UnitCube<'a, 'b> {
    oracle: RefCell<&'a mut Oracle<'b>>,
    bounds: [Vec<f64>; 2],
    /// The last point: some methods ask for its cost first and for its slopes later.
    last: RefCell<Option<Known>>,
}

/// A point of the cube, the cost there and its slopes.
type Known = (Vec<f64>, f64, Vec<f64>);

impl<'a, 'b> UnitCube<'a, 'b> {
    fn new(oracle: &'a mut Oracle<'b>) -> Self {
        let bounds = [0.0, 1.0].map(|bound| vec![bound; oracle.bounds().len()]);
        Self { oracle: RefCell::new(oracle), bounds, last: RefCell::new(None) }
    }
}

impl Constraints for UnitCube<'_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        let [lower, upper] = &self.bounds;
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(lower), Some(upper)))
    }
}

impl CostFunction for UnitCube<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Stop;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, Stop> {
        Ok(self.cost_and_gradient(z)?.0)
    }
}

impl Gradient for UnitCube<'_, '_> {
    type Gradient = Vec<f64>;

    fn gradient(&self, z: &Vec<f64>) -> Result<Vec<f64>, Stop> {
        Ok(self.cost_and_gradient(z)?.1)
    }

    fn cost_and_gradient(&self, z: &Vec<f64>) -> Result<(f64, Vec<f64>), Stop> {
        let mut last = self.last.borrow_mut();
        if let Some((known, cost, slopes)) = &*last
            && known == z
        {
            return Ok((*cost, slopes.clone()));
        }
        let mut oracle = self.oracle.borrow_mut();
        let mut x = z.clone();
        mirror_from_unit(&oracle, z, &mut x);
        let found = oracle.subgradient(&x)?;
        let widths = oracle.bounds().iter().map(|[lower, upper]| upper - lower);
        let slopes: Vec<f64> = found.slopes.iter().zip(widths).map(|(s, w)| s * w).collect();
        let cost = rank(&found.evaluation);
        *last = Some((z.clone(), cost, slopes.clone()));
        Ok((cost, slopes))
    }
}
