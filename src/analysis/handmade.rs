//! Small experiments with runs made by hand, for tests.

use super::{Improvement, Run};
use crate::experiment::{ExperimentFile, Plan, RunSpec};
use crate::input::Document;

/// The plan of an experiment file without its name.
pub(super) fn plan(text: &str) -> Plan {
    let document = Document::embedded("experiment.toml", &format!("name = 'x'\n{text}"));
    Plan::new(&ExperimentFile::read(&document).unwrap(), &document).unwrap()
}

/// The runs of a plan: `found` says which costs each found after how many evaluations.
pub(super) fn runs(plan: &Plan, found: impl Fn(&RunSpec) -> Vec<(u64, f64)>) -> Vec<Run> {
    let run = |spec: &RunSpec| {
        let found = found(spec);
        let last = found.last().map_or(f64::INFINITY, |step| step.1);
        let ended = (last.is_finite()).then_some((spec.budget, last));
        let steps = found.into_iter().chain(ended);
        Run {
            key: spec.key.clone(),
            optimiser: spec.optimiser,
            instance: spec.instance,
            seed: spec.seed,
            budget: spec.budget,
            cost: last,
            evaluations: spec.budget,
            trace: steps.map(|(evaluation, cost)| Improvement { evaluation, cost }).collect(),
            ..Run::default()
        }
    };
    plan.runs.iter().map(run).collect()
}
