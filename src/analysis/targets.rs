//! Costs that a run is asked to reach.

use super::Run;
use super::statistics::convergence_target;
use crate::experiment::{Instance, Plan};

/// Moré and Wild's τ, for instances without targets of their own.
const TAUS: [f64; 3] = [1e-1, 1e-3, 1e-5];

/// The targets of every instance of a plan; the k-th of each belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Targets {
    /// By instance; none where nothing was found on an instance without targets.
    pub values: Vec<Vec<f64>>,
    /// The least cost known of each instance, or the least that any of the runs has found.
    pub least: Vec<f64>,
    /// What to call the k-th.
    pub labels: Vec<String>,
    /// Where those of each instance come from.
    pub sources: Vec<&'static str>,
}

/// The targets that the plan states or that follow from best known costs; for an instance without, those of
/// Moré and Wild (2009), doi 10.1137/080724083: `f_L + τ (f(x_0) − f_L)` for τ of 10⁻¹, 10⁻³ and 10⁻⁵,
/// with `x_0` in the middle of the box, on the task the motion without bumps, and `f_L` the least cost that
/// any of the runs has found.
pub fn targets(plan: &Plan, runs: &[Run]) -> Targets {
    let mut found = vec![f64::INFINITY; plan.instances.len()];
    for run in runs {
        let last = run.trace.last().map_or(f64::INFINITY, |step| step.cost);
        found[run.instance] = found[run.instance].min(last);
    }
    let stated = |instance: &Instance| !instance.targets.is_empty();
    let of = |(instance, &least): (&Instance, &f64)| match instance {
        instance if stated(instance) => instance.targets.clone(),
        instance if least.is_finite() => {
            let start = instance.centre_cost();
            TAUS.map(|tau| convergence_target(least, start, tau)).to_vec()
        }
        _ => Vec::new(),
    };
    let values: Vec<Vec<f64>> = plan.instances.iter().zip(&found).map(of).collect();
    let known = |(instance, found): (&Instance, &f64)| instance.known_cost().unwrap_or(*found);
    let source =
        |instance: &Instance| if stated(instance) { "experiment" } else { "Moré and Wild" };
    Targets {
        labels: labels(plan, &values, plan.instances.iter().any(stated)),
        least: plan.instances.iter().zip(&found).map(known).collect(),
        sources: plan.instances.iter().map(source).collect(),
        values,
    }
}

fn labels(plan: &Plan, values: &[Vec<f64>], stated: bool) -> Vec<String> {
    let count = values.iter().map(Vec::len).max().unwrap_or(0);
    let label = |k: usize| {
        let mut distinct: Vec<f64> = values.iter().filter_map(|v| v.get(k).copied()).collect();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        match distinct[..] {
            _ if !stated => format!("τ = {}", plain(TAUS[k])),
            [target] => format!("{} ≤ {}", plan.cost_symbol(), plain(target)),
            _ => format!("target {}", k + 1),
        }
    };
    (0..count).map(label).collect()
}

/// A number as given, with an exponent where it is far from one.
pub(super) fn plain(number: f64) -> String {
    let written_out = number == 0.0 || (1e-3..1e6).contains(&number.abs());
    if written_out { format!("{number}") } else { format!("{number:e}") }
}
