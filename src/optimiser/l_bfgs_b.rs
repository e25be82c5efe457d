//! L-BFGS-B (Byrd, Lu, Nocedal and Zhu 1995, doi:10.1137/0916069; version 3.0, doi:10.1145/2049662.2049669) from random
//! starts, by the crate basin: steps of limited-memory BFGS that keep to the box.
//!
//! It takes the cost as it is, with a subgradient wherever it is evaluated, and knows nothing of its terms. It is made for
//! smooth costs; at a kink its search along a line may fail, and the start ends.

use std::num::NonZeroUsize;

use basin::Lbfgsb;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::descent::from_random_starts;
use super::method::Optimiser;
use crate::input::{count, positive};
use crate::search::{Oracle, Rng, Stop};

/// Settings of L-BFGS-B.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct LBfgsB {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// steps whose changes of the gradient are remembered
    #[serde(deserialize_with = "count::<1_000, _, _>")]
    pub memory: NonZeroUsize,
    /// a start ends when a step lowers the cost by less than this share of it, or of one where it is less
    #[serde(deserialize_with = "positive")]
    pub cost_tolerance: f64,
}

impl Default for LBfgsB {
    fn default() -> Self {
        let memory = NonZeroUsize::MIN.saturating_add(9);
        Self { formulation: None, memory, cost_tolerance: 1e-12 }
    }
}

impl Optimiser for LBfgsB {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        from_random_starts(oracle, rng, || {
            Lbfgsb::new()
                .with_m_capacity(self.memory.get())
                .with_relative_cost_reduction_tolerance(self.cost_tolerance)
        })
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }

    fn needs_derivatives(&self) -> bool {
        true
    }
}
