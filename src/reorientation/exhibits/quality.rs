//! How good the best motions are.

use std::collections::BTreeSet;

use super::best::BestMotion;
use super::words::{AT_GOAL_DEG, off_the_goal};
use crate::exhibit::Finding;
use crate::exhibit::words::{list, number, span};
use crate::experiment::{Results, Run};
use crate::reorientation::best_known::BestKnown;
use crate::reorientation::subject::{SAME_MOTION, TaskSubject};
use crate::words::plural;

/// Most optimisers that are named as the best.
const MOST_NAMES: usize = 5;

/// Of the only task's best motion, or of the best motions of all tasks; none where there are no motions.
pub(super) fn finding(results: &Results<'_>, best: &[BestMotion<'_>]) -> Option<Finding> {
    let tasks = results.instances.iter().filter_map(TaskSubject::of).count();
    let answer = match best {
        [] => return None,
        [only] if tasks == 1 => one_task(results, only),
        best => many_tasks(best, tasks, tried(results)),
    };
    Some(Finding::new("How good is it?", answer))
}

fn one_task(results: &Results<'_>, motion: &BestMotion<'_>) -> String {
    let run = motion.run;
    let known = BestKnown::of(motion.problem)
        .map_or_else(|| "no best is known".to_owned(), |known| known.compared_with(run.cost));
    format!(
        "The best motion is by {}: J {:.6} ({known}), {} s, and the base ends {}.",
        winners(results, run),
        run.cost,
        number(motion.duration),
        off_the_goal(motion.residual_deg)
    )
}

/// Whose runs end as low as the lowest of its instance.
fn winners(results: &Results<'_>, lowest: &Run) -> String {
    let is_level = |run: &&Run| run.cost - lowest.cost <= SAME_MOTION * lowest.cost.abs();
    let on_instance = results.runs.iter().filter(|run| run.instance == lowest.instance);
    let level: BTreeSet<usize> = on_instance.filter(is_level).map(|run| run.optimiser).collect();
    let names: Vec<&str> = level.iter().map(|&o| results.optimisers[o].0).collect();
    match names.len() {
        1 => names[0].to_owned(),
        n if n > MOST_NAMES => format!("{n} optimisers alike"),
        _ => format!("{} alike", list(&names)),
    }
}

/// How many of the tasks have a run, whatever it found.
fn tried(results: &Results<'_>) -> usize {
    let tried: BTreeSet<usize> = results.runs.iter().map(|run| run.instance).collect();
    tried.into_iter().filter_map(|i| TaskSubject::of(&results.instances[i])).count()
}

fn many_tasks(best: &[BestMotion<'_>], tasks: usize, tried: usize) -> String {
    let gap = |motion: &BestMotion<'_>| {
        BestKnown::of(motion.problem).map(|known| (motion.run.cost - known.j) / known.j)
    };
    let gaps: Vec<f64> = best.iter().filter_map(gap).collect();
    let reached = gaps.iter().filter(|&&gap| gap.abs() <= SAME_MOTION).count();
    let beaten = gaps.iter().filter(|&&gap| gap < -SAME_MOTION).count();
    let all = plural(tried, "instance");
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
    let home = best.iter().filter(|motion| motion.residual_deg <= AT_GOAL_DEG).count();
    let durations: Vec<f64> = best.iter().map(|motion| motion.duration).collect();
    let open = match tasks - tried {
        0 => String::new(),
        1 => " One more is not tried yet.".to_owned(),
        open => format!(" {open} more are not tried yet."),
    };
    format!(
        "{told} The base ends within 0.01° of the goal on {home} of {all}, and the best motions take {}.{open}",
        span(&durations, " s")
    )
}
