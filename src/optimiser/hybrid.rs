//! An optimiser without derivatives, then [`Scp`] from the best point it found; again and again while
//! the budget lasts.

use std::fmt::Display;

use schemars::JsonSchema;
use serde::de::{DeserializeOwned, Deserializer, Error as _};
use serde::{Deserialize, Serialize};

use super::l_shade::LShade;
use super::method::Optimiser;
use super::scp::Scp;
use crate::input::share;
use crate::search::{Oracle, Problem, Rng, Stop};

/// Settings of a hybrid whose first search is chosen by `S`, which shows its name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
#[serde(bound(
    deserialize = "S: From<LShade> + AsRef<dyn Optimiser> + Display + DeserializeOwned"
))]
#[schemars(rename = "Hybrid", bound = "S: From<LShade> + Serialize")]
pub struct Hybrid<S> {
    /// optimiser that searches first, with its settings, such as `{ de = { weight = 0.7 } }`
    #[serde(deserialize_with = "to_refine")]
    #[schemars(with = "serde_json::Value")]
    pub search: Box<S>,
    /// share of the budget that it may spend at a time
    #[serde(deserialize_with = "share")]
    pub share: f64,
    /// settings of `scp`, whose first start is the best point found
    pub refine: Scp,
}

impl<S: From<LShade>> Default for Hybrid<S> {
    fn default() -> Self {
        let search = Box::new(LShade::default().into());
        Self { search, share: 0.02, refine: Scp::default() }
    }
}

/// An optimiser that needs no derivatives.
fn to_refine<'de, S, D>(deserializer: D) -> Result<Box<S>, D::Error>
where
    S: AsRef<dyn Optimiser> + Display + Deserialize<'de>,
    D: Deserializer<'de>,
{
    let search = S::deserialize(deserializer)?;
    if search.as_ref().needs_derivatives() {
        let expected = "an optimiser that needs no derivatives";
        return Err(D::Error::custom(format!("found `{search}`, expected {expected}")));
    }
    Ok(Box::new(search))
}

impl<S: AsRef<dyn Optimiser> + Send + Sync> Optimiser for Hybrid<S> {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let round = (self.share * oracle.remaining() as f64).ceil() as u64;
        loop {
            let search = |oracle: &mut Oracle<'_>| (*self.search).as_ref().minimise(oracle, rng);
            let found = oracle.within(round, search)?;
            self.refine.minimise_from(found.as_ref().map(|best| &*best.x), oracle, rng)?;
        }
    }

    fn formulation(&self) -> Option<&str> {
        (*self.search).as_ref().formulation()
    }

    fn needs_derivatives(&self) -> bool {
        true
    }

    fn lacks(&self, problem: &dyn Problem) -> Option<&'static str> {
        self.refine.lacks(problem)
    }
}
