//! The tables of a report, one file a table.

mod best_motions;
mod convergence;
mod distribution;
mod expected_running_time;
mod feasibility;
mod fixed_budget;
mod fixed_target;
mod motion;
mod pairs;
mod profiles;
mod ranks;
mod runs;

use polars::prelude::*;

pub use motion::motion_table;

use super::statistics::Bootstrap;
use super::{Analysis, summary};
use crate::search::Rng;

/// One table of a report.
#[derive(Debug, Clone)]
pub struct Table {
    /// Name of its files.
    pub name: &'static str,
    /// What it shows.
    pub caption: String,
    /// Its rows.
    pub frame: DataFrame,
    /// Whether it is a curve's many points, which nobody reads.
    pub is_curve: bool,
}

impl Table {
    fn new(name: &'static str, caption: impl Into<String>, frame: DataFrame) -> Self {
        Self { name, caption: caption.into(), frame, is_curve: false }
    }

    fn curve(name: &'static str, caption: impl Into<String>, frame: DataFrame) -> Self {
        Self { is_curve: true, ..Self::new(name, caption, frame) }
    }
}

/// The names that tables may have.
pub const NAMES: [&str; 18] = [
    "summary",
    "best",
    "pareto",
    "targets",
    "fixed-target",
    "fixed-budget",
    "first-feasible",
    "friedman",
    "ranks",
    "pairs",
    "blocks",
    "runs",
    "convergence",
    "expected-running-time",
    "running-time-distribution",
    "performance-profiles",
    "data-profiles",
    "motion",
];

impl Analysis<'_> {
    /// Every table that the runs give.
    pub fn tables(&self) -> PolarsResult<Vec<Table>> {
        let caption = "Certified best costs over all runs; a failed run counts as infinite.";
        let summary = summary(self.plan, self.runs, self.targets)?;
        let mut tables = vec![Table::new("summary", caption, summary)];
        tables.push(best_motions::table(self)?);
        tables.extend(best_motions::pareto(self)?);
        tables.push(fixed_target::targets(self)?);
        tables.push(fixed_target::table(self)?);
        tables.push(fixed_budget::table(self)?);
        tables.push(feasibility::table(self)?);
        if let Some(blocks) = &self.blocks {
            tables.push(ranks::friedman_table(blocks)?);
            tables.push(ranks::table(self, blocks)?);
            tables.push(pairs::table(self, blocks)?);
            tables.push(ranks::blocks_table(self, blocks)?);
        }
        tables.push(runs::table(self)?);
        tables.push(convergence::table(self)?);
        tables.push(expected_running_time::table(self)?);
        tables.push(distribution::table(self)?);
        tables.extend(profiles::tables(self)?);
        let (stored, planned) = (self.runs.len(), self.plan.runs.len());
        if stored < planned {
            let note = format!(" Only {stored} of {planned} runs are stored so far.");
            for table in &mut tables {
                table.caption += &note;
            }
        }
        Ok(tables)
    }
}

/// Level of the bootstrap's intervals.
const LEVEL: f64 = 0.95;

/// The bootstrap's interval of a statistic: 1000 resamples; of a sample of more than 1000, as many as
/// make a million draws, 400 at least.
fn interval<T: Copy>(sample: &[T], statistic: impl Fn(&[T]) -> f64) -> [f64; 2] {
    let resamples = (1_000_000 / sample.len().max(1)).clamp(400, 1000);
    let mut rng = Rng::new(1);
    let draw = |count| rng.index(count);
    Bootstrap { level: LEVEL, resamples }.interval(sample, statistic, draw)
}
