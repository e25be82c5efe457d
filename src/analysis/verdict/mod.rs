//! What a reader wants to know first, in words.

mod comparison;
mod quality;
mod running_time;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truths;

use std::collections::HashSet;

use super::grouped::Analysis;
use crate::exhibit::words::list;
use crate::exhibit::{Exhibits, Finding};
use crate::words::plural;

/// Imported optimisers that are named one by one.
const MOST_NAMED: usize = 8;

impl Analysis<'_> {
    /// What the runs say, the most important first, together with what the subjects say of their own. The numbers are
    /// rounded to what does not depend on the machine.
    pub fn findings(&self, own: &Exhibits) -> Vec<Finding> {
        let mut findings: Vec<Finding> = missing(self).into_iter().chain(imported(self)).collect();
        if self.runs.is_empty() {
            return findings;
        }
        let groups: HashSet<&str> =
            self.plan.instances.iter().map(|instance| instance.group.as_str()).collect();
        match &own.sweep {
            Some(sweep) if self.plan.optimisers.len() == 1 && groups.len() > 1 => {
                findings.push(sweep.clone());
            }
            _ => findings.extend(comparison::findings(self)),
        }
        findings.extend(own.quality.clone());
        findings.extend(quality::finding(self));
        findings.extend(own.findings.iter().cloned());
        findings
    }
}

/// Which optimisers' runs other programs have made.
fn imported(analysis: &Analysis<'_>) -> Option<Finding> {
    let mut sources: Vec<(&str, Vec<String>)> = Vec::new();
    for entrant in &analysis.plan.optimisers {
        let Some(from) = entrant.imported() else { continue };
        match sources.iter_mut().find(|(known, _)| *known == from) {
            Some((_, names)) => names.push(entrant.label.clone()),
            None => sources.push((from, vec![entrant.label.clone()])),
        }
    }
    let told = |(from, names): &(&str, Vec<String>)| match names.len() {
        n if n <= MOST_NAMED => format!("from {from}: {}", list(names)),
        n => format!("from {from}: {}", plural(n, "optimiser")),
    };
    let told: Vec<String> = sources.iter().map(told).collect();
    let answer = format!(
        "Imported {}. Of these runs only the best costs by evaluations are known, as their own programs evaluated them: no \
         points and no limits.",
        told.join("; ")
    );
    (!told.is_empty()).then(|| Finding::new("Is anything imported?", answer))
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
