//! Particle swarm optimisation as the paper sets it up (eq. 23): one neighbourhood, inertia falling
//! linearly, the whole swarm moved at once.
//!
//! What the paper leaves open is settled here and can be set: the factors `r₁`, `r₂` are drawn for
//! every component; velocities start uniform within their limit, a fraction of the box (Eberhart and
//! Shi 2000, doi:10.1109/CEC.2000.870279); a particle that leaves the box is reflected at its wall.

use std::num::NonZeroUsize;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use super::places::{rank, uniform_point};
use crate::input::{count, finite, non_negative, positive, share};
use crate::search::{Evaluation, Oracle, Points, Rng, Stop};

/// Settings of the particle swarm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Pso {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// number of particles, `NP`
    #[serde(deserialize_with = "count::<1_000_000, _, _>")]
    pub population: NonZeroUsize,
    /// moves of the swarm over which the inertia falls, and after which the swarm rests; without it
    /// as many as the budget allows
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iterations: Option<NonZeroUsize>,
    /// inertia weight of the first and of the last move, `w_max` and `w_min`
    pub inertia: Inertia,
    /// pull towards the particle's own best, `c₁`
    #[serde(deserialize_with = "non_negative")]
    pub cognitive: f64,
    /// pull towards the swarm's best, `c₂`
    #[serde(deserialize_with = "non_negative")]
    pub social: f64,
    /// velocity adjustment factor `δ`: a move is `δ` times the velocity
    #[serde(deserialize_with = "positive")]
    pub delta: f64,
    /// largest velocity component, as a fraction of the box's width
    #[serde(deserialize_with = "share")]
    pub velocity_limit: f64,
    /// what happens to a particle at a wall of the box
    pub walls: Walls,
}

/// Inertia weights of the first and of the last move.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Inertia {
    /// at the first move
    #[serde(deserialize_with = "finite")]
    pub first: f64,
    /// at the last move
    #[serde(deserialize_with = "finite")]
    pub last: f64,
}

/// What happens to a particle that would leave the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Walls {
    /// It stays on the wall and loses the velocity that took it there.
    Absorb,
    /// It comes back by as much as it went too far, with its velocity turned round.
    Reflect,
}

impl Default for Pso {
    /// The paper's settings; `δ`, the velocity limit and the walls are this program's choice.
    fn default() -> Self {
        Self {
            formulation: None,
            population: NonZeroUsize::MIN.saturating_add(149),
            iterations: None,
            inertia: Inertia { first: 0.9, last: 0.1 },
            cognitive: 2.0,
            social: 2.0,
            delta: 1.0,
            velocity_limit: 0.2,
            walls: Walls::Reflect,
        }
    }
}

impl Optimiser for Pso {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let moves = self.moves(oracle.remaining());
        let mut swarm = Swarm::scatter(self, oracle, rng);
        swarm.evaluate(oracle)?;
        for iteration in 1..moves {
            let progress = (iteration - 1) as f64 / (moves - 2).max(1) as f64;
            let inertia = self.inertia.first + (self.inertia.last - self.inertia.first) * progress;
            swarm.advance(self, inertia, oracle, rng);
            swarm.evaluate(oracle)?;
        }
        Ok(())
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}

impl Pso {
    /// How often the swarm is evaluated: the paper's `N_max`.
    fn moves(&self, evaluations: u64) -> u64 {
        self.iterations.map_or_else(
            || evaluations.div_ceil(self.population.get() as u64),
            |iterations| iterations.get() as u64,
        )
    }
}

/// Positions, velocities and memories of all particles.
struct Swarm {
    positions: Points,
    velocities: Points,
    evaluations: Vec<Evaluation>,
    best_positions: Points,
    best_costs: Vec<f64>,
    /// The particle that remembers the lowest cost.
    leader: usize,
}

impl Swarm {
    fn scatter(settings: &Pso, oracle: &Oracle<'_>, rng: &mut Rng) -> Self {
        let count = settings.population.get();
        let mut positions = Points::zeros(oracle.bounds().len(), count);
        let mut velocities = positions.clone();
        for (position, velocity) in positions.iter_mut().zip(velocities.iter_mut()) {
            uniform_point(oracle, rng, position);
            for (v, [lower, upper]) in velocity.iter_mut().zip(oracle.bounds().iter()) {
                let limit = settings.velocity_limit * (upper - lower);
                *v = rng.uniform(-limit, limit);
            }
        }
        Self {
            best_positions: positions.clone(),
            best_costs: vec![f64::INFINITY; count],
            evaluations: vec![Evaluation::default(); count],
            positions,
            velocities,
            leader: 0,
        }
    }

    /// Evaluates all positions, then updates the memories.
    fn evaluate(&mut self, oracle: &mut Oracle<'_>) -> Result<(), Stop> {
        oracle.evaluate_batch(&self.positions, &mut self.evaluations)?;
        for (i, evaluation) in self.evaluations.iter().enumerate() {
            let cost = rank(evaluation);
            if cost < self.best_costs[i] {
                self.best_costs[i] = cost;
                self.best_positions[i].copy_from_slice(&self.positions[i]);
                if cost < self.best_costs[self.leader] {
                    self.leader = i;
                }
            }
        }
        Ok(())
    }

    /// Eq. 23 for every particle and component.
    fn advance(&mut self, settings: &Pso, inertia: f64, oracle: &Oracle<'_>, rng: &mut Rng) {
        let Self { positions, velocities, best_positions, leader, .. } = self;
        let global = &best_positions[*leader];
        let particles = positions.iter_mut().zip(velocities.iter_mut()).zip(best_positions.iter());
        for ((position, velocity), own) in particles {
            for (j, [lower, upper]) in oracle.bounds().iter().enumerate() {
                let (x, v) = (&mut position[j], &mut velocity[j]);
                let limit = settings.velocity_limit * (upper - lower);
                let to_own = settings.cognitive * rng.unit() * (own[j] - *x);
                let to_global = settings.social * rng.unit() * (global[j] - *x);
                *v = (inertia * *v + to_own + to_global).clamp(-limit, limit);
                *x += settings.delta * *v;
                settings.walls.enforce(x, v, [lower, upper]);
            }
        }
    }
}

impl Walls {
    fn enforce(self, x: &mut f64, v: &mut f64, [lower, upper]: [f64; 2]) {
        if (lower..=upper).contains(x) {
            return;
        }
        let wall = x.clamp(lower, upper);
        match self {
            Self::Absorb => (*x, *v) = (wall, 0.0),
            Self::Reflect => (*x, *v) = ((2.0 * wall - *x).clamp(lower, upper), -*v),
        }
    }
}
