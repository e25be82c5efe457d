//! An optimiser without derivatives, then [`Scp`] from the best point it found; again and again while
//! the budget lasts.

use schemars::JsonSchema;
use serde::de::{Deserializer, Error as _};
use serde::{Deserialize, Serialize};

use super::{LShade, Optimiser, Scp, Settings};
use crate::input::share;
use crate::search::{Oracle, Rng, Stop};

/// Settings of a hybrid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub struct Hybrid {
    /// optimiser that searches first, with its settings, such as `{ de = { weight = 0.7 } }`
    #[serde(deserialize_with = "to_refine")]
    #[schemars(with = "serde_json::Value")]
    pub search: Box<Settings>,
    /// share of the budget that it may spend at a time
    #[serde(deserialize_with = "share")]
    pub share: f64,
    /// settings of `scp`, whose first start is the best point found
    pub refine: Scp,
}

impl Default for Hybrid {
    fn default() -> Self {
        let search = Box::new(Settings::LShade(LShade::default()));
        Self { search, share: 0.02, refine: Scp::default() }
    }
}

/// An optimiser that needs no derivatives.
fn to_refine<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Box<Settings>, D::Error> {
    let settings = Settings::deserialize(deserializer)?;
    if settings.optimiser().needs_derivatives() {
        let found = settings.name();
        let expected = "an optimiser that needs no derivatives";
        return Err(D::Error::custom(format!("found `{found}`, expected {expected}")));
    }
    Ok(Box::new(settings))
}

impl Optimiser for Hybrid {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let round = (self.share * oracle.remaining() as f64).ceil() as u64;
        loop {
            let search = |oracle: &mut Oracle<'_>| self.search.optimiser().minimise(oracle, rng);
            let found = oracle.within(round, search)?;
            self.refine.minimise_from(found.as_ref().map(|best| &*best.x), oracle, rng)?;
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.search.formulation()
    }

    fn needs_derivatives(&self) -> bool {
        true
    }
}
