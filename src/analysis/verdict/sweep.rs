//! What changes along a sweep.

use super::Finding;
use super::words::{NONE_DEG, number, plural, span};
use crate::analysis::statistics::median;
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
    let costs = || stops.iter().map(|stop| (stop.group, stop.median(|run| run.cost)));
    let (least_at, least) = costs().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (most_at, most) = costs().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let symbol = analysis.plan.cost_symbol();
    let many = stops.iter().any(|stop| stop.best.len() > 1);
    let over = if many { ", medians over the instances of each" } else { "" };
    let settings = plural(stops.len(), "setting");
    let (least, most) = (number(least), number(most));
    let told = format!(
        "Over {settings}{over}, the best {symbol} is least, {least}, at {least_at} and largest, {most}, at {most_at}."
    );
    let motions = if symbol == "J" { motions(&stops) } else { String::new() };
    Some(Finding::new("What does the sweep say?", told + &motions))
}

/// How long the best motions take, and how far off the base ends.
fn motions(stops: &[Stop<'_>]) -> String {
    let all = |value| stops.iter().map(|stop| stop.median(value)).collect::<Vec<f64>>();
    let residuals = all(|run| run.residual_deg);
    let least = residuals.iter().copied().fold(f64::INFINITY, f64::min);
    let most = residuals.iter().copied().fold(0.0, f64::max);
    let residual = match (least < NONE_DEG, most < NONE_DEG) {
        (_, true) => "stays below 0.001°".to_owned(),
        (true, false) => format!("goes from below 0.001° to {}°", number(most)),
        (false, false) => format!("goes from {}° to {}°", number(least), number(most)),
    };
    let durations = span(&all(|run| run.duration), " s");
    format!(" The best motions take {durations}; the residual {residual}.")
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
