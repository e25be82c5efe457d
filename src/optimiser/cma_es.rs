//! CMA-ES, the evolution strategy with covariance matrix adaptation and negative weights, after
//! Hansen's tutorial (2016, arXiv:1604.00772v2; its letters and equation numbers are used below),
//! restarted with a growing population, IPOP (Auger and Hansen 2005, doi:10.1109/CEC.2005.1554902).
//!
//! It samples within the box scaled to the unit cube. A draw outside is drawn again, ten times at most;
//! one that is outside even then is evaluated where the walls reflect it to, and learnt from as it was
//! drawn. Biedrzycki (2020, doi:10.1016/j.swevo.2019.100627) compares these and other rules; here
//! reflection alone lost sight of a rough bowl's slope, and drawing again alone was slow towards corners.

use std::collections::VecDeque;
use std::num::{NonZeroU32, NonZeroUsize};

use nalgebra::DVector;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::distribution::{Constants, Distribution};
use super::method::Optimiser;
use super::places::mirror_from_unit;
use super::population::Population;
use crate::input::{count, non_negative, optional_count, share};
use crate::search::{Oracle, Points, Rng, Stop};

/// Settings of CMA-ES.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct CmaEs {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// points per generation at first, `λ`, at least four; without it 4 + ⌊3 ln n⌋ for n variables
    #[serde(deserialize_with = "optional_count::<4, LARGEST, _, _>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<NonZeroUsize>,
    /// standard deviation at first, `σ`, as a fraction of the box's width
    #[serde(deserialize_with = "share")]
    pub step: f64,
    /// a restart has so many times the points per generation
    #[serde(deserialize_with = "count::<100, _, _>")]
    pub growth: NonZeroU32,
    /// restart when costs have differed by less than this for some generations
    #[serde(deserialize_with = "non_negative")]
    pub cost_tolerance: f64,
}

impl Default for CmaEs {
    fn default() -> Self {
        Self {
            formulation: None,
            population: None,
            step: 0.3,
            growth: NonZeroU32::MIN.saturating_add(1),
            cost_tolerance: 1e-12,
        }
    }
}

/// The largest population.
const LARGEST: u64 = 1_000_000;

impl Optimiser for CmaEs {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let n = oracle.bounds().len() as f64;
        let usual = 4 + (3.0 * n.ln()) as usize;
        let mut population = self.population.map_or(usual, NonZeroUsize::get);
        loop {
            self.descend(population, oracle, rng)?;
            population = (population * self.growth.get() as usize).min(LARGEST as usize);
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

impl CmaEs {
    /// Adapts a distribution from a random point of the box until there is nothing left to adapt.
    fn descend(&self, count: usize, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let n = oracle.bounds().len();
        let constants = Constants::new(n, count);
        let start = DVector::from_fn(n, |_, _| rng.unit());
        let mut distribution = Distribution::around(start, self.step);
        let mut recent = Recent::new(n, count);
        while distribution.is_sound(self.step) {
            let steps: Vec<_> = (0..count).map(|_| distribution.step_within(rng)).collect();
            let mut points = Points::zeros(n, count);
            for (x, y) in points.iter_mut().zip(&steps) {
                let z = &distribution.mean + distribution.sigma * y;
                mirror_from_unit(oracle, z.as_slice(), x);
            }
            let generation = Population::evaluate(points, oracle)?;
            let ranking = generation.ranking();
            let [best, worst] = [0, count - 1].map(|place| generation.costs[ranking[place]]);
            if recent.is_level(best, worst, self.cost_tolerance) {
                break;
            }
            let ranked: Vec<_> = ranking.iter().map(|&i| &steps[i]).collect();
            distribution.adapt(&constants, &ranked);
        }
        Ok(())
    }
}

/// Best costs of the last generations; appendix B.3, `TolFun` and `EqualFunValues`.
struct Recent {
    best: VecDeque<f64>,
    length: usize,
}

impl Recent {
    fn new(n: usize, count: usize) -> Self {
        Self { best: VecDeque::new(), length: 10 + (30 * n).div_ceil(count) }
    }

    /// Takes note of a generation; whether the costs of it and the bests before it are all the same.
    fn is_level(&mut self, best: f64, worst: f64, tolerance: f64) -> bool {
        if best == f64::INFINITY {
            return true;
        }
        self.best.push_back(best);
        if self.best.len() <= self.length {
            return false;
        }
        self.best.pop_front();
        let highest = self.best.iter().copied().fold(worst, f64::max);
        let lowest = self.best.iter().copied().fold(best, f64::min);
        highest - lowest <= tolerance
    }
}
