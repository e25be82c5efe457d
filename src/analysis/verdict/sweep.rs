//! What changes along a sweep.

use super::Finding;
use super::words::{NONE_DEG, number, plural, span};
use crate::analysis::statistics::median;
use crate::analysis::ties::SAME_MOTION;
use crate::analysis::{Analysis, Run};

/// A group of instances and the best runs of these.
struct Stop<'a> {
    group: &'a str,
    best: Vec<&'a Run>,
}

impl Stop<'_> {
    fn median(&self, value: fn(&Run) -> f64) -> f64 {
        median(self.best.iter().map(|run| value(run)).collect())
    }
}

/// The range of the best cost, and of motions, over the groups; none where no run found anything.
pub(super) fn finding(analysis: &Analysis<'_>) -> Option<Finding> {
    let stops = stops(analysis);
    let many = stops.iter().any(|stop| stop.best.len() > 1);
    let over = if many { ", medians over the instances of each" } else { "" };
    let settings = plural(stops.len(), "setting");
    let (costs, motions) = (costs(analysis, &stops)?, motions(&stops));
    let told = format!("Over {settings}{over}, {costs}the best motions take {motions}.");
    Some(Finding::new("What does the sweep say?", told))
}

/// The range of the best cost; empty where the weight of the base varies, as that is a part of the cost.
fn costs(analysis: &Analysis<'_>, stops: &[Stop<'_>]) -> Option<String> {
    let costs = || stops.iter().map(|stop| (stop.group, stop.median(|run| run.cost)));
    let (least_at, least) = costs().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (most_at, most) = costs().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let tasks = analysis.best_motions();
    let varies = tasks.windows(2).any(|w| w[0].1.task().base_weight != w[1].1.task().base_weight);
    if varies {
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
fn motions(stops: &[Stop<'_>]) -> String {
    let all = |value| stops.iter().map(|stop| stop.median(value)).collect::<Vec<f64>>();
    let residuals = all(|run| run.residual_deg);
    let least = residuals.iter().copied().fold(f64::INFINITY, f64::min);
    let most = residuals.iter().copied().fold(0.0, f64::max);
    let residual = match (least < NONE_DEG, most < NONE_DEG) {
        (_, true) => "stays below 0.001°".to_owned(),
        (true, false) => format!("lies between 0 and {}°", number(most)),
        (false, false) => format!("lies between {}° and {}°", number(least), number(most)),
    };
    let durations = span(&all(|run| run.duration), " s");
    format!("{durations} and the residual {residual}")
}

/// The groups with a run that found something, in the plan's order.
fn stops<'a>(analysis: &Analysis<'a>) -> Vec<Stop<'a>> {
    let mut stops: Vec<Stop<'a>> = Vec::new();
    for run in analysis.best_runs() {
        let group = analysis.plan.instances[run.instance].group.as_str();
        match stops.iter_mut().find(|stop| stop.group == group) {
            Some(stop) => stop.best.push(run),
            None => stops.push(Stop { group, best: vec![run] }),
        }
    }
    stops
}
