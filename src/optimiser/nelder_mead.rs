//! The simplex method of Nelder and Mead (1965, doi:10.1093/comjnl/7.4.308) from random starts, by the
//! crate argmin.
//!
//! It moves within the box scaled to the unit cube, so that the units of the variables do not matter.
//! Beyond a wall the cost is continued by reflection. When a simplex no longer gains the next one
//! starts: argmin would stop at equal costs, which a simplex that lies along a level has too early.

use std::cell::RefCell;
use std::num::NonZeroU32;

use argmin::core::{CostFunction, Error, IterState, Problem, Solver as _, State as _};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use super::places::{mirror_from_unit, rank};
use crate::input::{count, positive, share};
use crate::search::{Oracle, Rng, Stop};

/// Settings of the simplex method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct NelderMead {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// length of the first simplex's edges along the axes, as a fraction of the box's width
    #[serde(deserialize_with = "share")]
    pub simplex: f64,
    /// a start ends when the best cost falls by less than this while its patience lasts
    #[serde(deserialize_with = "positive")]
    pub cost_tolerance: f64,
    /// evaluations to wait for such a fall, for each variable
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub patience: NonZeroU32,
}

impl Default for NelderMead {
    fn default() -> Self {
        Self {
            formulation: None,
            simplex: 0.1,
            cost_tolerance: 1e-12,
            patience: NonZeroU32::MIN.saturating_add(29),
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

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

impl NelderMead {
    /// Moves a simplex from a point of the unit cube until it has collapsed.
    fn follow(&self, oracle: &mut Oracle<'_>, start: &[f64]) -> Result<(), Stop> {
        let patience = u64::from(self.patience.get()) * start.len() as u64;
        let (mut gained, mut lowest) = (oracle.evaluations(), f64::INFINITY);
        let view = UnitCube { oracle: RefCell::new(oracle), stop: RefCell::new(None) };
        let mut problem = Problem::new(&view);
        let mut solver = argmin::solver::neldermead::NelderMead::new(self.simplex(start));
        let mut state = solver.init(&mut problem, IterState::new());
        loop {
            if let Some(stop) = view.stop.take() {
                return Err(stop);
            }
            let (simplex, _) = state.unwrap_or_else(|error| unreachable!("costs compare: {error}"));
            let now = view.oracle.borrow().evaluations();
            if simplex.cost < lowest - self.cost_tolerance {
                (gained, lowest) = (now, simplex.cost);
            } else if now - gained > patience {
                return Ok(());
            }
            state = solver.next_iter(&mut problem, simplex);
        }
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
}

/// The oracle as argmin sees it: its box is the unit cube, and it always answers.
struct UnitCube<'a, 'b> {
    oracle: RefCell<&'a mut Oracle<'b>>,
    /// Why the oracle answers no more.
    stop: RefCell<Option<Stop>>,
}

impl CostFunction for &UnitCube<'_, '_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, z: &Vec<f64>) -> Result<f64, Error> {
        if self.stop.borrow().is_some() {
            return Ok(f64::INFINITY);
        }
        let mut oracle = self.oracle.borrow_mut();
        let mut x = z.clone();
        mirror_from_unit(&oracle, z, &mut x);
        // argmin gives up where it gets an error while it sets out.
        Ok(oracle.evaluate(&x).map_or_else(
            |stop| {
                self.stop.replace(Some(stop));
                f64::INFINITY
            },
            |evaluation| rank(&evaluation),
        ))
    }
}
