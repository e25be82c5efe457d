//! What changes along a sweep.

use super::best::BestMotion;
use super::words::NONE_DEG;
use crate::analysis::statistics::median;
use crate::exhibit::Finding;
use crate::exhibit::words::{number, span};
use crate::reorientation::subject::SAME_MOTION;
use crate::words::plural;

/// A group of instances and the best motions of these.
struct Setting<'a> {
    group: &'a str,
    best: Vec<&'a BestMotion<'a>>,
}

impl Setting<'_> {
    fn median(&self, value: fn(&BestMotion<'_>) -> f64) -> f64 {
        median(self.best.iter().map(|motion| value(motion)).collect())
    }
}

/// The range of the best cost, and of motions, over the groups; none where no run found anything.
pub(super) fn finding(best: &[BestMotion<'_>]) -> Option<Finding> {
    let stops = stops(best);
    let many = stops.iter().any(|stop| stop.best.len() > 1);
    let over = if many { ", medians over the instances of each" } else { "" };
    let settings = plural(stops.len(), "setting");
    let (costs, motions) = (costs(best, &stops)?, motions(&stops));
    let told = format!("Over {settings}{over}, {costs}the best motions take {motions}.");
    Some(Finding::new("What does the sweep say?", told))
}

/// The range of the best cost; empty where weights vary, as these are a part of the cost.
fn costs(best: &[BestMotion<'_>], stops: &[Setting<'_>]) -> Option<String> {
    let costs = || stops.iter().map(|stop| (stop.group, stop.median(|motion| motion.run.cost)));
    let (least_at, least) = costs().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (most_at, most) = costs().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if weights_vary(best) {
        return Some(String::new());
    }
    let (low, high) = (number(least), number(most));
    Some(if most - least <= SAME_MOTION * least.abs() {
        format!("the best J is the same, {low}; ")
    } else {
        format!("the best J is least, {low}, at {least_at} and largest, {high}, at {most_at}; ")
    })
}

/// How long the best motions take, and how far off the base ends.
fn motions(stops: &[Setting<'_>]) -> String {
    let all = |value: fn(&BestMotion<'_>) -> f64| {
        stops.iter().map(|stop| stop.median(value)).collect::<Vec<f64>>()
    };
    let residuals = all(|motion| motion.residual_deg);
    let least = residuals.iter().copied().fold(f64::INFINITY, f64::min);
    let most = residuals.iter().copied().fold(0.0, f64::max);
    let residual = match (least < NONE_DEG, most < NONE_DEG) {
        (_, true) => "stays below 0.001°".to_owned(),
        (true, false) => format!("lies between 0 and {}°", number(most)),
        (false, false) => format!("lies between {}° and {}°", number(least), number(most)),
    };
    let durations = span(&all(|motion| motion.duration), " s");
    format!("{durations} and the residual {residual}")
}

/// Whether the weights of the base or of its turns differ between the motions' tasks.
fn weights_vary(best: &[BestMotion<'_>]) -> bool {
    let weights = |motion: &BestMotion<'_>| {
        let task = motion.problem.task();
        (task.base_weight, task.path.turn_weights)
    };
    best.windows(2).any(|pair| weights(&pair[0]) != weights(&pair[1]))
}

/// The groups with a run that found something, in the plan's order.
fn stops<'a>(best: &'a [BestMotion<'a>]) -> Vec<Setting<'a>> {
    let mut stops: Vec<Setting<'a>> = Vec::new();
    for motion in best {
        let group = motion.instance.group.as_str();
        match stops.iter_mut().find(|stop| stop.group == group) {
            Some(stop) => stop.best.push(motion),
            None => stops.push(Setting { group, best: vec![motion] }),
        }
    }
    stops
}
