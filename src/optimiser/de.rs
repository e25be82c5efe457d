//! Differential evolution, the scheme DE/rand/1/bin (Storn and Price 1997,
//! doi:10.1023/A:1008202821328).
//!
//! A generation's trial vectors are made from the generation before and evaluated together. A mutant
//! that leaves the box is bounced back: in each variable that is outside, it is drawn between the
//! wall and the vector that was mutated (Price, Storn and Lampinen 2005, section 4.3.1,
//! doi:10.1007/3-540-31306-0).

use std::num::NonZeroUsize;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use super::population::{Population, index_besides};
use crate::input::{fraction, optional_count, positive};
use crate::search::{Oracle, Rng, Stop};

/// Settings of differential evolution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct De {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// number of vectors, `NP`, at least four; without it ten for each variable
    #[serde(deserialize_with = "optional_count::<4, 1_000_000, _, _>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<NonZeroUsize>,
    /// weight of the difference of two vectors, `F`
    #[serde(deserialize_with = "positive")]
    pub weight: f64,
    /// probability that a trial vector takes a variable from the mutant, `CR`
    #[serde(deserialize_with = "fraction")]
    pub crossover: f64,
}

impl Default for De {
    /// What the paper tries first.
    fn default() -> Self {
        Self { formulation: None, population: None, weight: 0.5, crossover: 0.9 }
    }
}

impl Optimiser for De {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let variables = oracle.bounds().len();
        let count = self.population.map_or(10 * variables, NonZeroUsize::get).max(4);
        let mut population = Population::scatter(count, oracle, rng)?;
        loop {
            let mut trials = population.points.clone();
            for (i, trial) in trials.iter_mut().enumerate() {
                self.vary(&population, i, trial, oracle, rng);
            }
            let trials = Population::evaluate(trials, oracle)?;
            for i in 0..count {
                if trials.costs[i] <= population.costs[i] {
                    population.take(i, &trials, i);
                }
            }
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

impl De {
    /// Makes the trial vector `u` out of the target vector `x_i`, which it is at first.
    fn vary(
        &self,
        population: &Population,
        i: usize,
        u: &mut [f64],
        oracle: &Oracle<'_>,
        rng: &mut Rng,
    ) {
        let (x, count) = (&population.points, population.len());
        let r1 = index_besides(&[i], count, rng);
        let r2 = index_besides(&[i, r1], count, rng);
        let r3 = index_besides(&[i, r1, r2], count, rng);
        let always = rng.index(u.len());
        for (j, [lower, upper]) in oracle.bounds().iter().enumerate() {
            if rng.unit() < self.crossover || j == always {
                let base = x[r1][j];
                let v = base + self.weight * (x[r2][j] - x[r3][j]);
                u[j] = match v {
                    v if v < lower => rng.uniform(lower, base),
                    v if v > upper => rng.uniform(base, upper),
                    v => v,
                };
            }
        }
    }
}
