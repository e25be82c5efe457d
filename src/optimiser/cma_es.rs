//! CMA-ES, the evolution strategy with covariance matrix adaptation and negative weights, after
//! Hansen's tutorial (2016, arXiv:1604.00772v2; its letters and equation numbers are used below),
//! restarted with a growing population, IPOP (Auger and Hansen 2005, doi:10.1109/CEC.2005.1554902).
//!
//! It samples within the box scaled to the unit cube. Beyond a wall the cost is continued by
//! reflection, so the strategy itself sees no walls: a point outside is evaluated where the walls
//! reflect it to, and learnt from as it was sampled (Biedrzycki 2020,
//! doi:10.1016/j.swevo.2019.100627, compares this with other rules).

use std::collections::VecDeque;
use std::num::{NonZeroU32, NonZeroUsize};

use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::population::Population;
use super::{Optimiser, scale_from_unit};
use crate::input::{count, non_negative, optional_count, share};
use crate::oracle::{Oracle, Rng, Stop};
use crate::problem::{Formulation, Points};

/// Settings of CMA-ES.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct CmaEs {
    /// variables in which the task is searched
    pub formulation: Formulation,
    /// points a generation at first, `λ`, at least four; without it 4 + ⌊3 ln n⌋ for n variables
    #[serde(deserialize_with = "optional_count::<4, LARGEST, _, _>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<NonZeroUsize>,
    /// standard deviation at first, `σ`, as a fraction of the box's width
    #[serde(deserialize_with = "share")]
    pub step: f64,
    /// a restart has so many times the points a generation
    #[serde(deserialize_with = "count::<100, _, _>")]
    pub growth: NonZeroU32,
    /// restart when costs have differed by less than this for some generations
    #[serde(deserialize_with = "non_negative")]
    pub cost_tolerance: f64,
}

impl Default for CmaEs {
    fn default() -> Self {
        Self {
            formulation: Formulation::TimeFree,
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

    fn formulation(&self) -> Formulation {
        self.formulation
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
            let steps: Vec<_> = (0..count).map(|_| distribution.step(rng)).collect();
            let mut points = Points::zeros(n, count);
            for (x, y) in points.iter_mut().zip(&steps) {
                let reflected = (&distribution.mean + distribution.sigma * y).map(reflect);
                scale_from_unit(oracle, reflected.as_slice(), x);
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

/// The place in the unit interval that its mirrored copies repeat.
fn reflect(z: f64) -> f64 {
    let z = z.rem_euclid(2.0);
    if z > 1.0 { 2.0 - z } else { z }
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

/// What follows from the numbers of variables and of points: table 1.
struct Constants {
    /// One for each point, the best first; the first `μ` are positive.
    w: Vec<f64>,
    mu: usize,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// Expected length of a normal vector, `E‖N(0, I)‖`.
    chi: f64,
}

impl Constants {
    fn new(variables: usize, count: usize) -> Self {
        let (n, mu) = (variables as f64, count / 2);
        // Eq. 49.
        let middle = f64::midpoint(count as f64, 1.0).ln();
        let raw: Vec<f64> = (1..=count).map(|i| middle - (i as f64).ln()).collect();
        let [(sum, mu_eff), (sum_minus, mu_eff_minus)] = [&raw[..mu], &raw[mu..]].map(|w| {
            let (sum, squares) = (w.iter().sum::<f64>(), w.iter().map(|w| w * w).sum::<f64>());
            (sum.abs(), sum * sum / squares)
        });
        // Eqs. 55 to 58.
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let d_sigma = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        let c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = 2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff);
        let c_mu = c_mu.min(1.0 - c_1);
        // Eqs. 50 to 53.
        let alpha = (1.0 + c_1 / c_mu)
            .min(1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0))
            .min((1.0 - c_1 - c_mu) / (n * c_mu));
        let weight = |&w: &f64| if w >= 0.0 { w / sum } else { alpha * w / sum_minus };
        let w = raw.iter().map(weight).collect();
        let chi = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
        Self { w, mu, mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi }
    }
}

/// `N(m, σ² C)` with `C = B D² Bᵀ`, and the paths along which it moved.
struct Distribution {
    mean: DVector<f64>,
    sigma: f64,
    c: DMatrix<f64>,
    b: DMatrix<f64>,
    d: DVector<f64>,
    p_sigma: DVector<f64>,
    p_c: DVector<f64>,
    generation: i32,
}

impl Distribution {
    fn around(mean: DVector<f64>, sigma: f64) -> Self {
        let n = mean.len();
        Self {
            mean,
            sigma,
            c: DMatrix::identity(n, n),
            b: DMatrix::identity(n, n),
            d: DVector::repeat(n, 1.0),
            p_sigma: DVector::zeros(n),
            p_c: DVector::zeros(n),
            generation: 0,
        }
    }

    /// A draw from `N(0, C)`, eqs. 38 and 39.
    fn step(&self, rng: &mut Rng) -> DVector<f64> {
        let z = DVector::from_fn(self.d.len(), |_, _| rng.normal());
        &self.b * self.d.component_mul(&z)
    }

    /// Whether it can go on: appendix B.3, `ConditionCov`, `TolX` and `TolXUp`.
    fn is_sound(&self, initial: f64) -> bool {
        let (shortest, longest) = (self.d.min(), self.d.max());
        let reach = self.sigma * longest / initial;
        shortest > 1e-7 * longest && reach > 1e-12 && reach < 1e4
    }

    /// Learns from the steps of a generation, the best first: eqs. 41 to 47.
    fn adapt(&mut self, k: &Constants, y: &[&DVector<f64>]) {
        let n = self.mean.len() as f64;
        let weighted = k.w[..k.mu].iter().zip(y);
        let y_w = weighted.fold(DVector::zeros(self.mean.len()), |sum, (&w, &y)| sum + w * y);
        self.mean += self.sigma * &y_w;

        let whitened = &self.b * self.whiten(&y_w);
        self.p_sigma *= 1.0 - k.c_sigma;
        self.p_sigma += (k.c_sigma * (2.0 - k.c_sigma) * k.mu_eff).sqrt() * whitened;
        let length = self.p_sigma.norm() / k.chi;
        self.sigma *= (k.c_sigma / k.d_sigma * (length - 1.0)).exp();

        self.generation = self.generation.saturating_add(1);
        let so_far = 1.0 - (1.0 - k.c_sigma).powi(self.generation.saturating_mul(2));
        let h_sigma = if length / so_far.sqrt() < 1.4 + 2.0 / (n + 1.0) { 1.0 } else { 0.0 };
        self.p_c *= 1.0 - k.c_c;
        self.p_c += h_sigma * (k.c_c * (2.0 - k.c_c) * k.mu_eff).sqrt() * &y_w;

        let missed = (1.0 - h_sigma) * k.c_c * (2.0 - k.c_c);
        let kept = 1.0 + k.c_1 * missed - k.c_1 - k.c_mu * k.w.iter().sum::<f64>();
        let mut c = kept * &self.c;
        c.ger(k.c_1, &self.p_c, &self.p_c, 1.0);
        for (&w, &y) in k.w.iter().zip(y) {
            let w = if w < 0.0 { w * n / self.whiten(y).norm_squared() } else { w };
            c.ger(k.c_mu * w, y, y, 1.0);
        }
        self.c = c;
        self.decompose();
    }

    /// `D⁻¹ Bᵀ y`, as long as `C^(−1/2) y`.
    fn whiten(&self, y: &DVector<f64>) -> DVector<f64> {
        self.b.tr_mul(y).component_div(&self.d)
    }

    /// `B` and `D`; without a real one, a `D` of zeros, which is not sound.
    fn decompose(&mut self) {
        if self.c.iter().all(|entry| entry.is_finite()) {
            let eigen = self.c.clone().symmetric_eigen();
            self.d = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
            self.b = eigen.eigenvectors;
        } else {
            self.d.fill(0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights and rates of pycma 4.5, the first and the last two of the weights.
    #[test]
    fn constants_agree_with_pycma() {
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
        };
        let k = Constants::new(10, 10);
        near(k.mu_eff, 3.167_299_281_410_702);
        near(k.c_1, 0.015_283_824_524_751_714);
        near(k.c_mu, 0.023_551_776_650_417_47);
        near(k.c_c, 0.294_990_383_035_622_25);
        near(k.chi, 3.084_726_565_169_012_3);
        near(k.w[0], 0.456_272_646_903_405_97);
        near(k.w[8], -0.452_864_086_378_421_96);
        near(k.w[9], -0.549_749_917_697_385_3);
        let k = Constants::new(12, 40);
        near(k.c_mu, 0.093_077_300_377_506_39);
        near(k.w[0], 0.167_124_701_498_080_1);
        near(k.w[39], -0.070_799_156_250_569_37);
    }

    #[test]
    fn walls_reflect() {
        for (z, expected) in [(0.25, 0.25), (-0.25, 0.25), (1.25, 0.75), (2.5, 0.5), (-3.75, 0.25)]
        {
            assert_eq!(reflect(z), expected);
        }
    }
}
