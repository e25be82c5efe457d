//! The simplex method of Nelder and Mead (1965, doi:10.1093/comjnl/7.4.308) from random starts, in
//! the form of Lagarias et al. (1998, doi:10.1137/S1052623496303470), by the crate basin.
//!
//! It moves within the box scaled to the unit cube, so that the units of the variables do not matter;
//! a vertex outside is projected onto the box. When a simplex has collapsed the next one starts.

use std::cell::RefCell;

use basin::{
    BoxBounds, ConstraintDescription as _, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, Executor, SimplexProgress,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Optimiser, rank, scale_from_unit};
use crate::input::{positive, share};
use crate::oracle::{Oracle, Rng, Stop};
use crate::problem::Formulation;

/// Settings of the simplex method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct NelderMead {
    /// variables in which the task is searched
    pub formulation: Formulation,
    /// length of the first simplex's edges along the axes, as a fraction of the box's width
    #[serde(deserialize_with = "share")]
    pub simplex: f64,
    /// expand, contract and shrink by less the more variables there are (Gao and Han 2012,
    /// doi:10.1007/s10589-010-9329-3)
    pub adaptive: bool,
    /// a start ends when the simplex is smaller than this fraction of the box's width
    #[serde(deserialize_with = "positive")]
    pub size_tolerance: f64,
    /// and its costs differ by less than this
    #[serde(deserialize_with = "positive")]
    pub cost_tolerance: f64,
}

impl Default for NelderMead {
    fn default() -> Self {
        Self {
            formulation: Formulation::TimeFree,
            simplex: 0.1,
            adaptive: false,
            size_tolerance: 1e-8,
            cost_tolerance: 1e-9,
        }
    }
}

impl Optimiser for NelderMead {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        loop {
            let start: Vec<f64> = oracle.bounds().iter().map(|_| rng.unit()).collect();
            self.follow(oracle, &start)?;
        }
    }

    fn formulation(&self) -> Formulation {
        self.formulation
    }
}

impl NelderMead {
    /// Moves a simplex from a point of the unit cube until it has collapsed.
    fn follow(&self, oracle: &mut Oracle<'_>, start: &[f64]) -> Result<(), Stop> {
        let solver =
            if self.adaptive { basin::NelderMead::adaptive() } else { basin::NelderMead::new() };
        let simplex = SimplexProgress::from_simplex(self.simplex(start));
        let mut simplex =
            Executor::new(UnitCube::new(oracle), endless(solver).projected(), simplex)
                .max_iter(u64::MAX)
                .into_stepper()
                .map_err(stop)?;
        while !self.collapsed(simplex.state()) && simplex.finished().is_none() {
            simplex.step().map_err(stop)?;
        }
        Ok(())
    }

    /// The start and one more vertex along every axis, inwards where the wall is near.
    fn simplex(&self, start: &[f64]) -> Vec<Vec<f64>> {
        let mut vertices = vec![start.to_vec(); start.len() + 1];
        for (vertex, j) in vertices[1..].iter_mut().zip(0..) {
            let inwards = if start[j] + self.simplex > 1.0 { -1.0 } else { 1.0 };
            vertex[j] += inwards * self.simplex;
        }
        vertices
    }

    /// Whether size and costs are within the tolerances; what cannot shrink any further has collapsed
    /// whatever its costs.
    fn collapsed(&self, simplex: &SimplexProgress<Vec<f64>>) -> bool {
        let best = &simplex.vertices()[0];
        let distance = |vertex: &Vec<f64>| {
            vertex.iter().zip(best).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let size = simplex.vertices().iter().map(distance).fold(0.0, f64::max);
        let difference = simplex.costs().iter().map(|cost| cost - simplex.costs()[0]);
        let level = difference.fold(0.0, f64::max) <= self.cost_tolerance;
        size <= f64::EPSILON || (size <= self.size_tolerance && level)
    }
}

/// Without basin's own tests of convergence.
fn endless(solver: basin::NelderMead<Vec<f64>>) -> basin::NelderMead<Vec<f64>> {
    solver
        .with_absolute_simplex_size_tolerance(None)
        .with_relative_simplex_size_tolerance(None)
        .with_absolute_simplex_cost_tolerance(None)
        .with_relative_simplex_cost_tolerance(None)
}

/// The oracle as basin sees it: its box is the unit cube.
struct UnitCube<'a, 'b> {
    oracle: RefCell<&'a mut Oracle<'b>>,
    walls: ConstraintSet<BoxBounds<Vec<f64>>>,
}

impl<'a, 'b> UnitCube<'a, 'b> {
    fn new(oracle: &'a mut Oracle<'b>) -> Self {
        let [lower, upper] = [0.0, 1.0].map(|wall| Some(vec![wall; oracle.bounds().len()]));
        let walls = ConstraintSet::new().with_bounds(BoxBounds::new(lower, upper));
        Self { oracle: RefCell::new(oracle), walls }
    }
}

impl Constraints for UnitCube<'_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> ConstraintSet<BoxBounds<&Vec<f64>>> {
        self.walls.borrowed()
    }
}

impl CostFunction for UnitCube<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Stop;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, Stop> {
        let mut oracle = self.oracle.borrow_mut();
        let mut x = vec![0.0; z.len()];
        scale_from_unit(&oracle, z, &mut x);
        oracle.evaluate(&x).map(|evaluation| rank(&evaluation))
    }
}

/// Why the oracle ended a start.
fn stop(error: ConstraintSolveError<Stop>) -> Stop {
    match error {
        ConstraintSolveError::Evaluation(stop) => stop,
        other => unreachable!("the unit cube is a box: {other}"),
    }
}
