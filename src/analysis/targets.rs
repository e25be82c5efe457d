//! Costs that a run is asked to reach.

use super::statistics::convergence_target;
use crate::experiment::{Instance, Plan, Run};

/// Moré and Wild's τ, for instances without targets of their own.
const TAUS: [f64; 3] = [1e-1, 1e-3, 1e-5];

/// The targets of every instance of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Targets {
    /// By instance.
    pub values: Vec<Vec<f64>>,
    /// The least cost known of each instance, or the least that any of the runs has found.
    pub least: Vec<f64>,
    /// Whether those of each instance are the experiment's, stated or from the best known cost.
    stated: Vec<bool>,
}

/// The least cost that any of the runs has found, as searches evaluated it, by instance; instances that differ
/// in budget alone share one. Infinite where nothing was found.
pub fn least_found(plan: &Plan, runs: &[Run]) -> Vec<f64> {
    let problems = plan.problems();
    let mut least = vec![f64::INFINITY; plan.instances.len()];
    for run in runs {
        let last = run.trace.last().map_or(f64::INFINITY, |step| step.cost);
        let least = &mut least[problems[run.instance]];
        *least = least.min(last);
    }
    problems.iter().map(|&problem| least[problem]).collect()
}

/// The targets that the experiment has; for an instance without, those of
/// Moré and Wild (2009), doi 10.1137/080724083: `f_L + τ (f(x_0) − f_L)` for τ of 10⁻¹, 10⁻³ and 10⁻⁵,
/// with `x_0` in the middle of the box, and `f_L` the least cost that
/// any of the runs has found. Where none has found any, there is nothing that a run could reach.
pub fn targets(plan: &Plan, runs: &[Run]) -> Targets {
    let found = least_found(plan, runs);
    let stated: Vec<bool> = plan.instances.iter().map(|i| !i.targets.is_empty()).collect();
    let of = |(instance, &found): (&Instance, &f64)| match instance.targets.as_slice() {
        [] => more_wild(found, instance.start_cost()).to_vec(),
        targets => targets.to_vec(),
    };
    let known =
        |(instance, found): (&Instance, &f64)| instance.subject.known_cost().unwrap_or(*found);
    Targets {
        values: plan.instances.iter().zip(&found).map(of).collect(),
        least: plan.instances.iter().zip(&found).map(known).collect(),
        stated,
    }
}

fn more_wild(found: f64, start: f64) -> [f64; 3] {
    match (found.is_finite(), start.is_finite()) {
        (false, _) => [f64::NEG_INFINITY; 3],
        (true, false) => [found; 3],
        (true, true) => {
            let least = found.min(start);
            TAUS.map(|tau| convergence_target(least, start, tau))
        }
    }
}

impl Targets {
    /// The largest number of targets of an instance.
    pub fn count(&self) -> usize {
        self.values.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Where an instance's targets come from.
    pub fn source(&self, instance: usize) -> &'static str {
        if self.stated[instance] { "experiment.toml" } else { "Moré and Wild" }
    }

    /// What to call the k-th target of some instances: its value or its τ, where they have the same, else
    /// its number.
    pub fn label(&self, k: usize, symbol: &str, instances: impl Iterator<Item = usize>) -> String {
        let mut all = instances.filter_map(|i| Some((self.stated[i], *self.values[i].get(k)?)));
        let Some((stated, value)) = all.next() else { return format!("target {}", k + 1) };
        let same = |(s, v): (bool, f64)| s == stated && (!stated || v == value);
        match all.all(same) {
            true if stated => format!("{symbol} ≤ {}", plain(value)),
            true => format!("τ = {}", plain(TAUS[k.min(2)])),
            false => format!("target {}", k + 1),
        }
    }
}

/// A number as given, with an exponent where it is far from one.
fn plain(number: f64) -> String {
    let written_out = number == 0.0 || (1e-3..1e6).contains(&number.abs());
    if written_out { format!("{number}") } else { format!("{number:e}") }
}
