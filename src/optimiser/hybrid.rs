//! Any other optimiser first, then [`Scp`] from the best point it found.

use schemars::JsonSchema;
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

use super::{LShade, Optimiser, Scp, Settings};
use crate::input::share;
use crate::oracle::{Oracle, Rng, Stop};
use crate::problem::Formulation;

/// Settings of a hybrid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Hybrid {
    /// optimiser that searches first, with its settings, such as `{ de = { weight = 0.7 } }`
    #[serde(deserialize_with = "time_free")]
    #[schemars(with = "serde_json::Value")]
    pub search: Box<Settings>,
    /// share of the budget that it may spend
    #[serde(deserialize_with = "share")]
    pub share: f64,
    /// settings of `scp`, whose first start is the best point found
    pub refine: Scp,
}

impl Default for Hybrid {
    fn default() -> Self {
        let search = Box::new(Settings::LShade(LShade::default()));
        Self { search, share: 0.1, refine: Scp::default() }
    }
}

/// An optimiser that searches the variables in which there are derivatives.
fn time_free<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Box<Settings>, D::Error> {
    let settings = Settings::deserialize(deserializer)?;
    match settings.formulation() {
        Formulation::TimeFree => Ok(Box::new(settings)),
        other => Err(D::Error::custom(format!(
            "found a search in `{}`, expected one in `time-free`, as derivatives are",
            other.name()
        ))),
    }
}

impl Optimiser for Hybrid {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let evaluations = (self.share * oracle.remaining() as f64).ceil() as u64;
        oracle.within(evaluations, |oracle| self.search.optimiser().minimise(oracle, rng))?;
        let found = oracle.best().map(|best| best.x.clone());
        self.refine.minimise_from(found.as_deref(), oracle, rng)
    }

    fn needs_derivatives(&self) -> bool {
        true
    }
}
