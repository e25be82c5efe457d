//! The best motion of every instance, and what the weight of the base trades.

use polars::prelude::*;

use super::{Analysis, Table};
use crate::analysis::Run;
use crate::reorientation::Reorientation;

/// One line an instance with a run that found something.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let best = analysis.best_runs();
    let problems: Vec<Option<&Reorientation>> =
        best.iter().map(|run| analysis.plan.instances[run.instance].reorientation()).collect();
    let limit = |order: usize| -> Vec<Option<f64>> {
        problems.iter().map(|p| p.and_then(|p| p.task().uniform_limit_deg(order))).collect()
    };
    let cost = format!("best {}", analysis.plan.cost_symbol());
    let mut frame = df!(
        "instance" => best.iter().map(|run| analysis.plan.instances[run.instance].label.as_str()).collect::<Vec<_>>(),
        "weight_base" => problems.iter().map(|p| p.map(|p| p.task().base_weight)).collect::<Vec<_>>(),
        "rate_limit_deg_s" => limit(0),
        "acceleration_limit_deg_s2" => limit(1),
        "jerk_limit_deg_s3" => limit(2),
        "terms" => problems.iter().map(|p| p.map(|p| p.family().terms() as u64)).collect::<Vec<_>>(),
        "optimiser" => best.iter().map(|run| analysis.optimiser(run.optimiser)).collect::<Vec<_>>(),
        "seed" => best.iter().map(|run| run.seed).collect::<Vec<_>>(),
        cost => best.iter().map(|run| run.cost).collect::<Vec<_>>(),
        "residual [°]" => best.iter().map(|run| run.residual_deg).collect::<Vec<_>>(),
        "t_f [s]" => best.iter().map(|run| run.duration).collect::<Vec<_>>(),
    )?;
    if problems.iter().all(Option::is_none) {
        frame = frame.drop_many([
            "weight_base",
            "rate_limit_deg_s",
            "acceleration_limit_deg_s2",
            "jerk_limit_deg_s3",
            "terms",
            "residual [°]",
            "t_f [s]",
        ]);
    }
    Ok(Table::new("best", "The run with the lowest certified cost of each instance.", frame))
}

/// Residuals that differ by less are the same, in degrees: searches end with some 10⁻⁶.
const SAME_DEG: f64 = 1e-5;
/// Durations that differ by a smaller share are the same.
const SAME_DURATION: f64 = 1e-6;

/// An experiment has one robot, so there is no need to compare robots.
fn same_but_for_weight(a: &Reorientation, b: &Reorientation) -> bool {
    let (own, other) = (a.task(), b.task());
    own.base_weight != other.base_weight
        && own.start == other.start
        && own.goal == other.goal
        && own.limits == other.limits
        && a.family().terms() == b.family().terms()
}

/// Which best motions none of another weight of the same task but for the weight beats in residual and duration; none
/// unless the weight varies.
pub(super) fn pareto(analysis: &Analysis<'_>) -> PolarsResult<Option<Table>> {
    let tasks = analysis.best_motions();
    let varies = tasks.windows(2).any(|w| w[0].1.task().base_weight != w[1].1.task().base_weight);
    if !varies {
        return Ok(None);
    }
    let dominates = |a: &Run, b: &Run| {
        let no_worse = a.residual_deg <= b.residual_deg + SAME_DEG
            && a.duration <= b.duration * (1.0 + SAME_DURATION);
        let better = a.residual_deg < b.residual_deg - SAME_DEG
            || a.duration < b.duration * (1.0 - SAME_DURATION);
        no_worse && better
    };
    let efficient = |(run, problem): &(&Run, &Reorientation)| {
        !tasks.iter().any(|(other, its)| same_but_for_weight(its, problem) && dominates(other, run))
    };
    let frame = df!(
        "instance" => tasks.iter().map(|(run, _)| analysis.plan.instances[run.instance].label.as_str()).collect::<Vec<_>>(),
        "weight_base" => tasks.iter().map(|(_, problem)| problem.task().base_weight).collect::<Vec<_>>(),
        "residual [°]" => tasks.iter().map(|(run, _)| run.residual_deg).collect::<Vec<_>>(),
        "t_f [s]" => tasks.iter().map(|(run, _)| run.duration).collect::<Vec<_>>(),
        "efficient" => tasks.iter().map(efficient).collect::<Vec<_>>(),
    )?;
    let caption = "Residual against duration of the best motions; efficient are those that no other weight's beats in \
        one without being worse in the other.";
    Ok(Some(Table::new("pareto", caption, frame)))
}
