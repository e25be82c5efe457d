//! The `[imported]` table of a folder of imported results.

use std::collections::BTreeMap;
use std::fmt;
use std::num::NonZeroU64;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::input::{Document, InputError};

/// Instance, optimiser and seed of a run, the first two by their places.
pub(super) type ImportedRun = (usize, usize, u64);

/// Whose format imported data have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DataFormat {
    /// IOHprofiler's.
    Ioh,
    /// COCO's.
    Coco,
    /// A long table, as `docs/import.md` has it.
    Csv,
}

impl DataFormat {
    /// The word in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ioh => "ioh",
            Self::Coco => "coco",
            Self::Csv => "csv",
        }
    }
}

impl fmt::Display for DataFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ioh => "IOHprofiler data",
            Self::Coco => "COCO data",
            Self::Csv => "CSV data",
        })
    }
}

/// The `[imported]` table of a folder: where its results come from, and which there are.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ImportTable {
    pub(super) format: DataFormat,
    pub(super) from: String,
    pub(super) runs: Vec<Spanned<RunsTable>>,
}

/// Runs of an optimiser: the same seeds with the same budget on some instances.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RunsTable {
    /// Place of the `[[optimiser]]`, counted from one.
    pub(super) optimiser: usize,
    pub(super) budget: NonZeroU64,
    pub(super) seeds: Vec<u64>,
    /// Places of the `[[problem]]`s, counted from one.
    pub(super) problems: Vec<usize>,
}

impl ImportTable {
    /// Where the results come from, in words.
    pub(super) fn words(&self) -> String {
        if self.from.is_empty() {
            self.format.to_string()
        } else {
            format!("{} in `{}`", self.format, self.from)
        }
    }

    /// How many runs there are.
    pub(super) fn count(&self) -> u64 {
        let count = |runs: &Spanned<RunsTable>| {
            let RunsTable { seeds, problems, .. } = runs.get_ref();
            (seeds.len() as u64).saturating_mul(problems.len() as u64)
        };
        self.runs.iter().map(count).fold(0, u64::saturating_add)
    }

    /// The budgets of the runs by instance, optimiser and seed, for so many instances and optimisers.
    pub(super) fn runs(
        &self,
        [instances, optimisers]: [usize; 2],
        document: &Document,
    ) -> Result<BTreeMap<ImportedRun, NonZeroU64>, InputError> {
        let mut places = BTreeMap::new();
        for table in &self.runs {
            let RunsTable { optimiser, budget, seeds, problems } = table.get_ref();
            let error = |what: &str, found: usize, count: usize| {
                let message = format!("found {what} {found}, expected one from 1 to {count}");
                document.error_at(table.span(), message, None)
            };
            let place =
                |number: usize, count: usize| number.checked_sub(1).filter(|place| *place < count);
            let o = place(*optimiser, optimisers)
                .ok_or_else(|| error("optimiser", *optimiser, optimisers))?;
            for problem in problems {
                let p = place(*problem, instances)
                    .ok_or_else(|| error("problem", *problem, instances))?;
                for seed in seeds {
                    if places.insert((p, o, *seed), *budget).is_some() {
                        let message = format!(
                            "found problem {problem} with optimiser {optimiser} and seed {seed} twice, expected each run once"
                        );
                        return Err(document.error_at(table.span(), message, None));
                    }
                }
            }
        }
        Ok(places)
    }
}
