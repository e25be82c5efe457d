//! L-SHADE: differential evolution that learns its weight and crossover probability from what
//! succeeded, with a population that shrinks linearly over the budget (Tanabe and Fukunaga 2014,
//! doi:10.1109/CEC.2014.6900380; its letters are used below).
//!
//! A mutant that leaves the box is set half-way between the wall and its target, variable by
//! variable, as in the paper. Of a success over a target without a finite cost the gain is unknown;
//! it replaces the target and teaches nothing.

use std::num::NonZeroUsize;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use super::population::{Population, index_besides};
use crate::input::{count, fraction, non_negative, optional_count};
use crate::search::{Oracle, Points, Rng, Stop};

/// Settings of L-SHADE.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct LShade {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// number of vectors at the start, `N_init`, at least four; without it 18 for each variable
    #[serde(deserialize_with = "optional_count::<4, 1_000_000, _, _>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<NonZeroUsize>,
    /// remembered pairs of weight and crossover probability, `H`
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub memory: NonZeroUsize,
    /// share of the population, the best, that mutants are drawn towards, `p`
    #[serde(deserialize_with = "fraction")]
    pub greediness: f64,
    /// size of the archive of replaced vectors, as a multiple of the population, `r_arc`
    #[serde(deserialize_with = "non_negative")]
    pub archive: f64,
}

impl Default for LShade {
    /// The paper's settings.
    fn default() -> Self {
        Self {
            formulation: None,
            population: None,
            memory: NonZeroUsize::MIN.saturating_add(5),
            greediness: 0.11,
            archive: 2.6,
        }
    }
}

/// Vectors at the end of the budget, `N_min`: what current-to-pbest/1 needs.
const SMALLEST: usize = 4;

impl Optimiser for LShade {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let (variables, budget) = (oracle.bounds().len(), oracle.remaining());
        let count = self.population.map_or(18 * variables, NonZeroUsize::get).max(SMALLEST);
        let mut population = Population::scatter(count, oracle, rng)?;
        let mut archive = Vec::new();
        let mut memory = Memory::new(self.memory.get());
        loop {
            let mut trials = population.points.clone();
            let parameters = self.vary(&population, &archive, &memory, &mut trials, oracle, rng);
            let trials = Population::evaluate(trials, oracle)?;
            let mut successes = Vec::new();
            for (i, &(f, cr)) in parameters.iter().enumerate() {
                let gain = population.costs[i] - trials.costs[i];
                if gain > 0.0 {
                    archive.push(population.points[i].to_vec());
                    successes.push(Success { gain, f, cr });
                }
                if trials.costs[i] <= population.costs[i] {
                    population.take(i, &trials, i);
                }
            }
            memory.learn(&successes);
            let spent = (budget - oracle.remaining()) as f64 / budget as f64;
            population.shrink(reduced(count, spent));
            let room = (self.archive * population.len() as f64).round() as usize;
            while archive.len() > room {
                archive.swap_remove(rng.index(archive.len()));
            }
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

/// `N_{G+1}`, eq. 10, at this share of the budget.
fn reduced(initial: usize, spent: f64) -> usize {
    let (initial, smallest) = (initial as f64, SMALLEST as f64);
    (initial + (smallest - initial) * spent).round() as usize
}

impl Population {
    /// Keeps the best.
    fn shrink(&mut self, count: usize) {
        if count < self.len() {
            let kept = &self.ranking()[..count];
            let mut points = self.points.prefix(count);
            points.iter_mut().zip(kept).for_each(|(x, &i)| x.copy_from_slice(&self.points[i]));
            self.costs = kept.iter().map(|&i| self.costs[i]).collect();
            self.points = points;
        }
    }
}

impl LShade {
    /// Makes the trial vectors out of the target vectors, which they are at first, by
    /// current-to-pbest/1/bin; `F` and `CR` of each.
    fn vary(
        &self,
        population: &Population,
        archive: &[Vec<f64>],
        memory: &Memory,
        trials: &mut Points,
        oracle: &Oracle<'_>,
        rng: &mut Rng,
    ) -> Vec<(f64, f64)> {
        let (x, count) = (&population.points, population.len());
        let ranking = population.ranking();
        let best = &ranking[..((self.greediness * count as f64).round() as usize).clamp(2, count)];
        let mut parameters = Vec::with_capacity(count);
        for (i, u) in trials.iter_mut().enumerate() {
            let (f, cr) = memory.draw(rng);
            let x_best = &x[best[rng.index(best.len())]];
            let r1 = index_besides(&[i], count, rng);
            let r2 = index_besides(&[i, r1], count + archive.len(), rng);
            let x_r2 = if r2 < count { &x[r2] } else { &archive[r2 - count] };
            let always = rng.index(u.len());
            for (j, [lower, upper]) in oracle.bounds().iter().enumerate() {
                if rng.unit() < cr || j == always {
                    let target = u[j];
                    let v = target + f * (x_best[j] - target) + f * (x[r1][j] - x_r2[j]);
                    u[j] = match v {
                        v if v < lower => f64::midpoint(lower, target),
                        v if v > upper => f64::midpoint(upper, target),
                        v => v,
                    };
                }
            }
            parameters.push((f, cr));
        }
        parameters
    }
}

/// A trial that was better than its target.
struct Success {
    /// `Δf`.
    gain: f64,
    f: f64,
    cr: f64,
}

/// What succeeded lately: `M_F`, and `M_CR`, where none stands for the terminal value `⊥`.
struct Memory {
    pairs: Vec<(f64, Option<f64>)>,
    /// The pair that is overwritten next, `k`.
    next: usize,
}

impl Memory {
    fn new(size: usize) -> Self {
        Self { pairs: vec![(0.5, Some(0.5)); size], next: 0 }
    }

    /// `F` and `CR` around a remembered pair, eqs. 1 and 2.
    fn draw(&self, rng: &mut Rng) -> (f64, f64) {
        let (m_f, m_cr) = self.pairs[rng.index(self.pairs.len())];
        let cr = m_cr.map_or(0.0, |m_cr| (m_cr + 0.1 * rng.normal()).clamp(0.0, 1.0));
        let mut f = 0.0;
        while f <= 0.0 {
            f = rng.cauchy(m_f, 0.1).min(1.0);
        }
        (f, cr)
    }

    /// Algorithm 1.
    fn learn(&mut self, successes: &[Success]) {
        let successes: Vec<_> = successes.iter().filter(|s| s.gain.is_finite()).collect();
        if successes.is_empty() {
            return;
        }
        let m_f = lehmer_mean(&successes, |s| s.f);
        let m_cr = self.pairs[self.next].1.and_then(|_| lehmer_mean(&successes, |s| s.cr));
        self.pairs[self.next] = (m_f.unwrap_or(0.5), m_cr);
        self.next = (self.next + 1) % self.pairs.len();
    }
}

/// `Σ w S² / Σ w S` with `w` in proportion to the gains, eq. 7; none where every value is zero.
fn lehmer_mean(successes: &[&Success], value: impl Fn(&Success) -> f64) -> Option<f64> {
    // Relative to the largest gain, lest their sum overflow.
    let largest = successes.iter().map(|s| s.gain).fold(0.0, f64::max);
    let (mut squares, mut values) = (0.0, 0.0);
    for success in successes {
        let (w, s) = (success.gain / largest, value(success));
        squares += w * s * s;
        values += w * s;
    }
    (values > 0.0).then(|| squares / values)
}
