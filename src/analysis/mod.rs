//! From stored runs to tables of what they say.

mod blocks;
mod format;
#[cfg(test)]
mod handmade;
mod pairs;
mod runs;
mod standing;
pub mod statistics;
mod summary;
pub mod tables;
mod targets;
mod ties;
mod verdict;

pub use blocks::ALPHA;
pub use format::{csv, latex, markdown, render};
pub use runs::{Improvement, Run, best_run, load};
pub use standing::{Failure, Standing, Tally, standing};
pub use summary::summary;
pub use targets::{Targets, least_found, targets};
pub use verdict::Finding;

use crate::experiment::Plan;
use crate::reorientation::Reorientation;
use blocks::Blocks;
use runs::groups;

/// Stored runs, grouped, compared block by block, and asked for targets: what tables and findings are
/// made of.
#[derive(Debug)]
pub struct Analysis<'a> {
    plan: &'a Plan,
    runs: &'a [Run],
    /// The runs by optimiser and group of instances.
    groups: Vec<Vec<&'a Run>>,
    targets: &'a Targets,
    /// None where there is nothing to test.
    blocks: Option<Blocks>,
}

impl<'a> Analysis<'a> {
    /// Of the stored runs of a plan.
    pub fn new(plan: &'a Plan, runs: &'a [Run], targets: &'a Targets) -> Self {
        Self { plan, runs, groups: groups(plan, runs), targets, blocks: Blocks::of(plan, runs) }
    }

    /// The label of an optimiser.
    fn optimiser(&self, index: usize) -> &'a str {
        &self.plan.optimisers[index].label
    }

    /// The lowest run of every instance, where there is one.
    fn best_runs(&self) -> Vec<&'a Run> {
        let mut by_instance: Vec<Vec<&Run>> = vec![Vec::new(); self.plan.instances.len()];
        self.runs.iter().for_each(|run| by_instance[run.instance].push(run));
        by_instance.into_iter().filter_map(|runs| best_run(runs.into_iter())).collect()
    }

    /// The best motion of every instance that has one: its run and its task.
    pub fn best_motions(&self) -> Vec<(&'a Run, &'a Reorientation)> {
        let plan = self.plan;
        let on_task = |run: &'a Run| Some((run, plan.instances[run.instance].reorientation()?));
        self.best_runs().into_iter().filter_map(on_task).collect()
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
    fn labels(&self, group: &[&Run]) -> [&'a str; 2] {
        let instance = &self.plan.instances[group[0].instance];
        [self.optimiser(group[0].optimiser), &instance.group]
    }
}
