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

use super::runs::groups;
use super::statistics::Bootstrap;
use super::{Run, Targets, summary};
use crate::experiment::Plan;
use crate::oracle::Rng;

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

/// What all tables are made of.
struct Field<'a> {
    plan: &'a Plan,
    runs: &'a [Run],
    /// The runs by optimiser and group of instances.
    groups: Vec<Vec<&'a Run>>,
    targets: &'a Targets,
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

/// Every table that the runs of a plan give.
pub fn tables(plan: &Plan, runs: &[Run], targets: &Targets) -> PolarsResult<Vec<Table>> {
    let field = Field { plan, runs, groups: groups(plan, runs), targets };
    let caption = "Certified best costs over all runs; a failed run counts as infinite.";
    let mut tables = vec![Table::new("summary", caption, summary(plan, runs, targets)?)];
    tables.push(best_motions::table(&field)?);
    tables.extend(best_motions::pareto(&field)?);
    tables.push(fixed_target::targets(&field)?);
    tables.push(fixed_target::table(&field)?);
    tables.push(fixed_budget::table(&field)?);
    tables.push(feasibility::table(&field)?);
    if let Some(blocks) = ranks::Blocks::of(&field) {
        tables.push(ranks::friedman_table(&field, &blocks)?);
        tables.push(ranks::table(&field, &blocks)?);
        tables.push(pairs::table(&field, &blocks)?);
        tables.push(ranks::blocks_table(&field, &blocks)?);
    }
    tables.push(runs::table(&field)?);
    tables.push(convergence::table(&field)?);
    tables.push(expected_running_time::table(&field)?);
    tables.push(distribution::table(&field)?);
    tables.extend(profiles::tables(&field)?);
    let (stored, planned) = (runs.len(), plan.runs.len());
    if stored < planned {
        let note = format!(" Only {stored} of {planned} runs are stored so far.");
        for table in &mut tables {
            table.caption += &note;
        }
    }
    Ok(tables)
}

impl Field<'_> {
    /// The label of an optimiser.
    fn optimiser(&self, index: usize) -> &str {
        &self.plan.optimisers[index].label
    }

    /// What to call the k-th target of all instances.
    fn target_label(&self, k: usize) -> String {
        let all = 0..self.plan.instances.len();
        self.targets.label(k, self.plan.cost_symbol(), all)
    }

    /// What to call the k-th target of a group.
    fn target_label_of(&self, k: usize, group: &str) -> String {
        let all = self.plan.instances.iter().enumerate();
        let own = all.filter(|(_, instance)| instance.group == group).map(|(i, _)| i);
        self.targets.label(k, self.plan.cost_symbol(), own)
    }

    /// The label of the optimiser and of the group that some runs share.
    fn labels(&self, group: &[&Run]) -> [&str; 2] {
        let instance = &self.plan.instances[group[0].instance];
        [self.optimiser(group[0].optimiser), &instance.group]
    }
}

/// Level of the bootstrap's intervals.
const LEVEL: f64 = 0.95;
/// Level of the tests.
const ALPHA: f64 = 0.05;

/// The bootstrap's interval of a statistic: 1000 resamples; of a sample of more than 1000, as many as
/// make a million draws, 400 at least.
fn interval<T: Copy>(sample: &[T], statistic: impl Fn(&[T]) -> f64) -> [f64; 2] {
    let resamples = (1_000_000 / sample.len().max(1)).clamp(400, 1000);
    let mut rng = Rng::new(1);
    let draw = |count| rng.index(count);
    Bootstrap { level: LEVEL, resamples }.interval(sample, statistic, draw)
}
