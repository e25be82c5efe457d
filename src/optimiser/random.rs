//! Random search: every point drawn uniformly from the box, none remembered. The bar that every
//! other method has to clear.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::method::Optimiser;
use super::places::uniform_point;
use crate::search::{Evaluation, Oracle, Points, Rng, Stop};

/// Settings of random search.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct RandomSearch {
    /// variables in which a problem with several formulations is searched; without it the problem's first
    #[serde(skip_serializing_if = "Option::is_none")]
    pub formulation: Option<String>,
}

/// Points evaluated at a time; the result does not depend on it.
const BATCH: usize = 64;

impl Optimiser for RandomSearch {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let mut points = Points::zeros(oracle.bounds().len(), BATCH);
        let mut evaluations = [Evaluation::default(); BATCH];
        loop {
            points.iter_mut().for_each(|x| uniform_point(oracle, rng, x));
            oracle.evaluate_batch(&points, &mut evaluations)?;
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}
