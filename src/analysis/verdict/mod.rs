//! What a reader wants to know first, in words.

mod comparison;
mod motion;
mod quality;
mod running_time;
mod sweep;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truths;
mod words;

use std::collections::HashSet;

use serde::Serialize;

use super::Analysis;
use crate::experiment::Instance;
use words::plural;

/// One thing that an experiment has to say.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What one may ask.
    pub question: String,
    /// The answer, in a few sentences.
    pub answer: String,
}

impl Finding {
    fn new(question: &str, answer: impl Into<String>) -> Self {
        Self { question: question.to_owned(), answer: answer.into() }
    }
}

impl Analysis<'_> {
    /// What the runs say, the most important first. The numbers are rounded to what does not depend on the
    /// machine.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings: Vec<Finding> = missing(self).into_iter().collect();
        if self.runs.is_empty() {
            return findings;
        }
        let groups: HashSet<&str> =
            self.plan.instances.iter().map(|instance| instance.group.as_str()).collect();
        match self.plan.optimisers.len() {
            1 if groups.len() > 1 && self.plan.instances.iter().all(Instance::is_task) => {
                findings.extend(sweep::finding(self));
            }
            _ => findings.extend(comparison::findings(self)),
        }
        findings.extend(quality::findings(self));
        findings.extend(motion::finding(self));
        findings
    }
}

/// What is not there yet, and what failed.
fn missing(analysis: &Analysis<'_>) -> Option<Finding> {
    let (stored, planned) = (analysis.runs.len(), analysis.plan.runs.len());
    let failed = analysis.runs.iter().filter(|run| run.cost.is_infinite()).count();
    let mut told = Vec::new();
    if stored < planned {
        let verb = if stored == 1 { "is" } else { "are" };
        told.push(format!("Only {stored} of {} {verb} stored so far.", plural(planned, "run")));
    }
    if failed > 0 {
        let their = if failed == 1 { "its cost counts" } else { "their costs count" };
        told.push(format!(
            "{} failed or found nothing; {their} as infinite.",
            plural(failed, "run")
        ));
    }
    (!told.is_empty()).then(|| Finding::new("Is anything missing?", told.join(" ")))
}
