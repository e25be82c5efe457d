//! The tables of a report, one file per table.

mod best;
mod convergence;
mod dimensions;
mod distribution;
mod expected_running_time;
mod feasibility;
mod fixed_budget;
mod fixed_target;
mod interval;
mod pairs;
mod profiles;
mod ranks;
mod runs;

use polars::prelude::*;

use super::grouped::Analysis;
use super::summary::summary;
use crate::exhibit::Table;
use crate::words::plural;

/// The names that every experiment's tables may have.
pub const NAMES: [&str; 17] = [
    "summary",
    "best",
    "targets",
    "fixed-target",
    "fixed-budget",
    "first-feasible",
    "friedman",
    "ranks",
    "pairs",
    "blocks",
    "dimensions",
    "runs",
    "convergence",
    "expected-running-time",
    "running-time-distribution",
    "performance-profiles",
    "data-profiles",
];

impl Analysis<'_> {
    /// Every table that the runs give; `own` are a subject's, which stand behind that of the best runs.
    pub fn tables(&self, own: Vec<Table>) -> PolarsResult<Vec<Table>> {
        let caption = "Certified best costs over all runs; a failed run counts as infinite.";
        let summary = summary(self.plan, self.runs, self.targets)?;
        let mut tables = vec![Table::of("summary", caption, summary)];
        tables.push(best::table(self)?);
        tables.extend(own);
        tables.push(fixed_target::targets(self)?);
        tables.push(fixed_target::table(self)?);
        tables.push(fixed_budget::table(self)?);
        tables.extend(feasibility::table(self)?);
        if let Some(blocks) = &self.blocks {
            tables.push(ranks::friedman_table(blocks)?);
            tables.push(ranks::table(self, blocks)?);
            tables.push(pairs::table(self, blocks)?);
            tables.push(ranks::blocks_table(self, blocks)?);
        }
        tables.extend(dimensions::table(self)?);
        tables.push(runs::table(self)?);
        tables.push(convergence::table(self)?);
        tables.push(expected_running_time::table(self)?);
        tables.push(distribution::table(self)?);
        tables.extend(profiles::tables(self)?);
        let (stored, planned) = (self.runs.len(), self.plan.runs.len());
        let mut note = String::new();
        if stored < planned {
            note = format!(" Only {stored} of {} are stored so far.", plural(planned, "run"));
        }
        if self.plan.optimisers.iter().any(|entrant| entrant.imported().is_some()) {
            note += " Runs of imported optimisers are as their own programs evaluated them.";
        }
        for table in &mut tables {
            table.caption += &note;
        }
        Ok(tables)
    }
}
