//! Stored runs, grouped and compared.

use std::collections::HashMap;

use super::blocks::Blocks;
use super::statistics::Trial;
use super::targets::Targets;
use crate::exhibit::Exhibits;
use crate::experiment::{Plan, Run};

/// Stored runs, grouped, compared block by block, and asked for targets: what tables and findings are
/// made of.
#[derive(Debug)]
pub struct Analysis<'a> {
    pub(super) plan: &'a Plan,
    pub(super) runs: &'a [Run],
    /// The runs by optimiser and group of instances.
    pub(super) groups: Vec<Vec<&'a Run>>,
    pub(super) targets: &'a Targets,
    /// None where there is nothing to test.
    pub(super) blocks: Option<Blocks>,
}

impl<'a> Analysis<'a> {
    /// Of the stored runs of a plan.
    pub fn new(plan: &'a Plan, runs: &'a [Run], targets: &'a Targets) -> Self {
        Self { plan, runs, groups: groups(plan, runs), targets, blocks: Blocks::of(plan, runs) }
    }

    /// What the subjects of the plan show of their own, kind by kind.
    pub fn exhibits(&self) -> Exhibits {
        let mut exhibits = Exhibits::default();
        let results = self.plan.results(self.runs);
        for (_, instances) in self.plan.by_kind() {
            if let [first, ..] = instances.as_slice() {
                exhibits.extend(first.subject.exhibits(&results));
            }
        }
        exhibits
    }

    /// The label of an optimiser.
    pub(super) fn optimiser(&self, index: usize) -> &'a str {
        &self.plan.optimisers[index].label
    }

    /// What to call the k-th target of all instances.
    pub(super) fn target_label(&self, k: usize) -> String {
        let all = 0..self.plan.instances.len();
        self.targets.label(k, self.plan.cost_symbol(), all)
    }

    /// What to call the k-th target of a group.
    pub(super) fn target_label_of(&self, k: usize, group: &str) -> String {
        let all = self.plan.instances.iter().enumerate();
        let own = all.filter(|(_, instance)| instance.group == group).map(|(i, _)| i);
        self.targets.label(k, self.plan.cost_symbol(), own)
    }

    /// The label of the optimiser and of the group that some runs share.
    pub(super) fn labels(&self, group: &[&Run]) -> [&'a str; 2] {
        let instance = &self.plan.instances[group[0].instance];
        [self.optimiser(group[0].optimiser), &instance.group]
    }
}

/// Groups runs by optimiser and the instances' groups, in the order of their first row.
pub(super) fn groups<'a>(plan: &Plan, runs: &'a [Run]) -> Vec<Vec<&'a Run>> {
    let mut places = HashMap::new();
    let mut groups: Vec<Vec<&Run>> = Vec::new();
    for run in runs {
        let of = (run.optimiser, plan.instances[run.instance].group.as_str());
        let place = *places.entry(of).or_insert(groups.len());
        if place == groups.len() {
            groups.push(Vec::new());
        }
        groups[place].push(run);
    }
    groups
}

/// What a run says about a target.
pub(super) fn trial(run: &Run, target: f64) -> Trial {
    let hit = run.hit(target);
    Trial { evaluations: hit.unwrap_or(run.evaluations) as f64, solved: hit.is_some() }
}
