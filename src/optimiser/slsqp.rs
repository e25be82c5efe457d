//! Sequential least-squares quadratic programming (Kraft 1988, DFVLR-FB 88-28) from random starts, by the crate basin.
//!
//! It takes the cost as it is, with a subgradient wherever it is evaluated, and the box; it knows nothing of the cost's
//! terms. It is made for smooth costs; at a kink its search along a line may fail, and the start ends.

use basin::Slsqp as Method;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::descent::from_random_starts;
use super::method::Optimiser;
use crate::input::positive;
use crate::search::{Oracle, Rng, Stop};

/// Settings of sequential least-squares quadratic programming.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Slsqp {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
    /// a start ends when a step changes the cost by less than this, or promises to, or is shorter in the unit cube
    #[serde(deserialize_with = "positive")]
    pub accuracy: f64,
}

impl Default for Slsqp {
    fn default() -> Self {
        Self { formulation: None, accuracy: 1e-12 }
    }
}

impl Optimiser for Slsqp {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        from_random_starts(oracle, rng, || {
            Method::new().with_absolute_accuracy_tolerance(self.accuracy)
        })
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }

    fn needs_derivatives(&self) -> bool {
        true
    }
}
