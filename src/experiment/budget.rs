//! What a run may spend.

use std::num::NonZeroU64;

use serde::{Deserialize, Serialize};

use crate::input::count;

/// The `budget` table.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table such as `{ evaluations = 150_000 }`")]
pub(super) struct BudgetTable {
    /// Evaluations per run.
    #[serde(deserialize_with = "count::<1_000_000_000_000, _, _>")]
    pub(super) evaluations: NonZeroU64,
}
