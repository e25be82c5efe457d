//! How good the best is.

use std::collections::BTreeSet;

use super::Finding;
use super::words::{list, number, off_the_goal, plural, span};
use crate::analysis::ties::{SAME, SAME_MOTION};
use crate::analysis::{Analysis, Run};
use crate::experiment::Instance;
use crate::reorientation::{BestKnown, Reorientation};

const QUESTION: &str = "How good is it?";

/// Residuals below count as none \[°\].
const AT_GOAL_DEG: f64 = 0.01;
/// Most optimisers that are named as the best.
const MOST_NAMES: usize = 5;

/// A best run with the task it is on.
type OnTask<'a> = (&'a Run, &'a Reorientation);

/// On the tasks and on the other problems of an experiment.
pub(super) fn findings(analysis: &Analysis<'_>) -> Vec<Finding> {
    let instances = &analysis.plan.instances;
    let tasks = instances.iter().filter(|instance| instance.is_task()).count();
    let best = analysis.best_motions();
    let on_tasks = match best.as_slice() {
        [] => None,
        [only] if tasks == 1 => Some(one_task(analysis, *only)),
        best => Some(many_tasks(best, tasks)),
    };
    let told = on_tasks.into_iter().chain(functions(analysis));
    told.map(|answer| Finding::new(QUESTION, answer)).collect()
}

fn one_task(analysis: &Analysis<'_>, (run, problem): OnTask<'_>) -> String {
    let known = BestKnown::of(problem)
        .map_or_else(|| "no best is known".to_owned(), |known| known.compared_with(run.cost));
    format!(
        "The best motion is by {}: J {:.6} ({known}), {} s, and the base ends {}.",
        winners(analysis, run),
        run.cost,
        number(run.duration),
        off_the_goal(run.residual_deg)
    )
}

/// Whose runs end as low as the lowest of its instance.
fn winners(analysis: &Analysis<'_>, lowest: &Run) -> String {
    let is_level = |run: &&Run| run.cost - lowest.cost <= SAME_MOTION * lowest.cost.abs();
    let on_instance = analysis.runs.iter().filter(|run| run.instance == lowest.instance);
    let level: BTreeSet<usize> = on_instance.filter(is_level).map(|run| run.optimiser).collect();
    let names: Vec<&str> = level.iter().map(|&o| analysis.optimiser(o)).collect();
    match names.len() {
        1 => names[0].to_owned(),
        n if n > MOST_NAMES => format!("{n} optimisers alike"),
        _ => format!("{} alike", list(&names)),
    }
}

fn many_tasks(best: &[OnTask<'_>], tasks: usize) -> String {
    let gap = |(run, problem): &OnTask<'_>| {
        BestKnown::of(problem).map(|known| (run.cost - known.j) / known.j)
    };
    let gaps: Vec<f64> = best.iter().filter_map(gap).collect();
    let reached = gaps.iter().filter(|&&gap| gap.abs() <= SAME_MOTION).count();
    let beaten = gaps.iter().filter(|&&gap| gap < -SAME_MOTION).count();
    let all = plural(tasks, "instance");
    let told = match gaps.len() {
        0 => format!("No best cost is known of the {all}."),
        known => {
            let known = plural(known, "instance");
            let more = if beaten > 0 {
                format!(", and beaten by more on {beaten}")
            } else {
                String::new()
            };
            let furthest = 100.0 * gaps.iter().copied().fold(0.0, f64::max);
            let missed = if reached + beaten < gaps.len() {
                format!("; elsewhere the best is up to {} % above", number(furthest))
            } else {
                String::new()
            };
            format!(
                "A best cost is known of {known}; it was reached within 10⁻⁶ on {reached}{more}{missed}."
            )
        }
    };
    let home = best.iter().filter(|(run, _)| run.residual_deg <= AT_GOAL_DEG).count();
    let durations: Vec<f64> = best.iter().map(|(run, _)| run.duration).collect();
    format!(
        "{told} The base ends within 0.01° of the goal on {home} of {all}, and the best motions take {}.",
        span(&durations, " s")
    )
}

/// Who solves how many of the instances whose least value is known.
fn functions(analysis: &Analysis<'_>) -> Option<String> {
    let instances = &analysis.plan.instances;
    let least = |instance: &Instance| instance.known_cost().filter(|_| !instance.is_task());
    let least: Vec<Option<f64>> = instances.iter().map(least).collect();
    let known = least.iter().flatten().count();
    if known == 0 {
        return None;
    }
    let mut solved = vec![vec![false; instances.len()]; analysis.plan.optimisers.len()];
    for run in analysis.runs {
        solved[run.optimiser][run.instance] |=
            least[run.instance].is_some_and(|least| run.cost - least <= SAME);
    }
    let count = |solved: &Vec<bool>| solved.iter().filter(|&&solved| solved).count();
    let mut by_count: Vec<(usize, &str)> =
        solved.iter().enumerate().map(|(o, s)| (count(s), analysis.optimiser(o))).collect();
    by_count.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let unsolved = known - (0..instances.len()).filter(|&i| solved.iter().any(|s| s[i])).count();
    let (most, _) = by_count.first()?;
    if *most == 0 {
        return Some("No run solved an instance to 10⁻⁸.".to_owned());
    }
    let told: Vec<String> =
        by_count.iter().map(|(count, name)| format!("{name} {count}")).collect();
    let rest = match unsolved {
        0 => String::new(),
        n => format!(" Nobody solved {n} of them."),
    };
    let known = plural(known, "instance");
    Some(format!("Of {known}, solved to 10⁻⁸ in any run: {}.{rest}", list(&told)))
}
