//! Small experiments with runs made by hand, for tests.

use std::sync::Arc;

use super::{Analysis, targets};
use crate::exhibit::Finding;
use crate::experiment::{Experiment, Improvement, Plan, Registry, Run, RunSpec};
use crate::functions::Functions;
use crate::input::Document;

/// The plan of an experiment file without its name, on what the registry knows.
pub(crate) fn plan_on(text: &str, registry: &Registry) -> Plan {
    let document = Document::embedded("experiment.toml", &format!("name = 'x'\n{text}"));
    Experiment::read(&document, registry).unwrap().plan().unwrap()
}

/// The plan of an experiment file on test functions, without its name.
pub(super) fn plan(text: &str) -> Plan {
    plan_on(text, &Registry::new().with(Arc::new(Functions)))
}

/// All that runs say.
pub(crate) fn findings(plan: &Plan, runs: &[Run]) -> Vec<Finding> {
    let targets = targets(plan, runs);
    let analysis = Analysis::new(plan, runs, &targets);
    analysis.findings(&analysis.exhibits())
}

/// The answer to a question that is asked once.
pub(crate) fn answer<'a>(findings: &'a [Finding], question: &str) -> &'a str {
    let mut asked = findings.iter().filter(|finding| finding.question == question);
    let found = asked.next().map_or("", |finding| finding.answer.as_str());
    assert!(asked.next().is_none(), "{question} is asked twice");
    found
}

/// The runs of a plan: `found` says which costs each found after how many evaluations.
pub(crate) fn runs(plan: &Plan, found: impl Fn(&RunSpec) -> Vec<(u64, f64)>) -> Vec<Run> {
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
