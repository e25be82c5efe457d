//! What the best motion looks like.

use super::best::BestMotion;
use super::words::off_the_goal;
use crate::exhibit::Finding;
use crate::exhibit::words::{list, number, percent};
use crate::experiment::Results;
use crate::reorientation::subject::TaskSubject;
use crate::words::plural;

const QUESTION: &str = "What does the motion look like?";

/// Intervals in which the base's attitude is looked at.
const INTERVALS: usize = 500;
/// A peak counts as at its limit when it misses it by less than this share.
const AT_LIMIT: f64 = 1e-3;

/// Rates, accelerations and jerks.
const ORDERS: [&str; 3] = ["rates", "accelerations", "jerks"];

/// Of the only task's best motion, or of the best motions of all tasks; none where there are no motions.
pub(super) fn finding(results: &Results<'_>, best: &[BestMotion<'_>]) -> Option<Finding> {
    let tasks = results.instances.iter().filter_map(TaskSubject::of).count();
    let answer = match best {
        [] => return None,
        [motion] if tasks == 1 => format!("{} {}", way(motion), binding(&ratios(motion))),
        best => many(best),
    };
    Some(Finding::new(QUESTION, answer))
}

/// Duration and the base's way.
fn way(motion: &BestMotion<'_>) -> String {
    let (sampled, task) = (motion.sample(INTERVALS), motion.problem.task());
    let start = task.start.base;
    let furthest = sampled.base.iter().map(|base| start.angle_to(base)).fold(0.0, f64::max);
    let goal = start.angle_to(&task.goal.base);
    format!(
        "It takes {} s. The goal is {:.1}° from the base's start; on the way the base turns by up to {:.1}°, and it ends {}.",
        number(motion.duration),
        goal.to_degrees(),
        furthest.to_degrees(),
        off_the_goal(motion.residual_deg)
    )
}

/// Every joint's largest rate, acceleration and jerk as multiples of its limits.
fn ratios(motion: &BestMotion<'_>) -> Vec<[f64; 3]> {
    let assessment = motion.problem.certify(&motion.coefficients, Some(motion.duration));
    let joints = assessment.peaks.0.iter().zip(&motion.problem.task().limits.0);
    joints.map(|(peaks, limits)| std::array::from_fn(|k| peaks[k].value / limits[k])).collect()
}

/// The largest multiple of a limit.
fn largest(ratios: &[[f64; 3]], order: usize) -> f64 {
    ratios.iter().map(|joint| joint[order]).fold(0.0, f64::max)
}

/// Which limits are reached, by which joints, and how near the others are.
fn binding(ratios: &[[f64; 3]]) -> String {
    let (mut reached, mut within) = (Vec::new(), Vec::new());
    for (order, name) in ORDERS.into_iter().enumerate() {
        let most = largest(ratios, order);
        if most < 1.0 - AT_LIMIT {
            within.push(format!("{name} up to {}", percent(most)));
            continue;
        }
        let at = |joint: &[f64; 3]| joint[order] >= 1.0 - AT_LIMIT;
        let joints = (1..).zip(ratios).filter(|(_, joint)| at(joint)).map(|(i, _): (usize, _)| i);
        let joints: Vec<String> = joints.map(|joint| joint.to_string()).collect();
        let joints = match joints.len() {
            1 => format!("joint {}", joints[0]),
            n if n == ratios.len() => "all joints".to_owned(),
            _ => format!("joints {}", list(&joints)),
        };
        let beyond = most > 1.0 + AT_LIMIT;
        let how = if beyond {
            format!("exceed the limit, up to {}", percent(most))
        } else {
            "reach the limit".to_owned()
        };
        reached.push(format!("{name} {how} in {joints}"));
    }
    match (reached.is_empty(), within.is_empty()) {
        (true, _) => format!("No limit is reached: {} of it.", list(&within)),
        (false, true) => format!("Of the limits, {}.", list(&reached)),
        (false, false) => format!("Of the limits, {}; {} of it.", list(&reached), list(&within)),
    }
}

/// How many of the best motions reach each limit.
fn many(best: &[BestMotion<'_>]) -> String {
    let ratios: Vec<Vec<[f64; 3]>> = best.iter().map(ratios).collect();
    let told = ORDERS.into_iter().enumerate().map(|(order, name)| {
        let reached = ratios.iter().filter(|r| largest(r, order) >= 1.0 - AT_LIMIT).count();
        format!("{name} on {reached}")
    });
    format!(
        "Of the best motions of {}, limits are reached by {}.",
        plural(best.len(), "instance"),
        list(&told.collect::<Vec<_>>())
    )
}
