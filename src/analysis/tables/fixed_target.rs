//! How long it takes to reach given costs.

use polars::prelude::*;
use rayon::prelude::*;

use super::interval::interval;
use crate::analysis::grouped::{Analysis, trial};
use crate::analysis::statistics::{Trial, expected_running_time, quartiles};
use crate::exhibit::Table;

/// One line per instance and target.
pub(super) fn targets(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let mut columns = (vec![], vec![], vec![], vec![]);
    for (i, (instance, values)) in
        analysis.plan.instances.iter().zip(&analysis.targets.values).enumerate()
    {
        for (k, value) in values.iter().enumerate() {
            columns.0.push(instance.label.as_str());
            columns.1.push(analysis.target_label_of(k, &instance.group));
            columns.2.push(*value);
            columns.3.push(analysis.targets.source(i));
        }
    }
    let frame = df!(
        "instance" => columns.0,
        "target" => columns.1,
        "cost" => columns.2,
        "source" => columns.3,
    )?;
    let caption = "Costs to reach, and where they come from: stated in experiment.toml or following there from the best \
        known cost; else those of Moré and Wild, τ of the way from the least cost that any of the runs found to that in \
        the middle of the box.";
    Ok(Table::of("targets", caption, frame))
}

/// A line of the table: group, target, and the trials.
struct Line<'a> {
    optimiser: &'a str,
    group: &'a str,
    target: String,
    trials: Vec<Trial>,
}

/// One line per group, target and optimiser.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let lines = lines(analysis);
    let intervals: Vec<[f64; 2]> =
        lines.par_iter().map(|line| interval(&line.trials, expected_running_time)).collect();
    let quartiles: Vec<[f64; 3]> =
        lines.iter().map(|line| quartiles(times(&line.trials))).collect();
    let solved = |line: &Line<'_>| line.trials.iter().filter(|trial| trial.solved).count();
    let frame = df!(
        "group" => lines.iter().map(|l| l.group).collect::<Vec<_>>(),
        "target" => lines.iter().map(|l| l.target.as_str()).collect::<Vec<_>>(),
        "optimiser" => lines.iter().map(|l| l.optimiser).collect::<Vec<_>>(),
        "runs" => lines.iter().map(|l| l.trials.len() as u64).collect::<Vec<_>>(),
        "successes" => lines.iter().map(|l| solved(l) as u64).collect::<Vec<_>>(),
        "success rate" =>
            lines.iter().map(|l| solved(l) as f64 / l.trials.len() as f64).collect::<Vec<_>>(),
        "ERT" => lines.iter().map(|l| expected_running_time(&l.trials)).collect::<Vec<_>>(),
        "ERT 2.5 %" => intervals.iter().map(|ends| ends[0]).collect::<Vec<_>>(),
        "ERT 97.5 %" => intervals.iter().map(|ends| ends[1]).collect::<Vec<_>>(),
        "quartile 1" => quartiles.iter().map(|q| q[0]).collect::<Vec<_>>(),
        "median" => quartiles.iter().map(|q| q[1]).collect::<Vec<_>>(),
        "quartile 3" => quartiles.iter().map(|q| q[2]).collect::<Vec<_>>(),
    )?;
    let caption = "Evaluations until a run's best cost, as its search evaluated it, is at most the target. \
        Expected running time (ERT): all evaluations spent until then or until the end, those of failures too, \
        for each success, with its 95 % bootstrap percentile interval (1000 resamples; fewer of samples above 1000, 400 at \
        least). Quartiles count a run that does not reach the target as infinite. A run that panicked counts with what it \
        had reached. Evaluations of optimisers that use derivatives come with them.";
    Ok(Table::of("fixed-target", caption, frame))
}

fn lines<'a>(analysis: &'a Analysis<'_>) -> Vec<Line<'a>> {
    let mut lines = Vec::new();
    for k in 0..analysis.targets.count() {
        for group in &analysis.groups {
            let [optimiser, label] = analysis.labels(group);
            let trials: Vec<Trial> = group
                .iter()
                .filter_map(|run| Some(trial(run, *analysis.targets.values[run.instance].get(k)?)))
                .collect();
            if !trials.is_empty() {
                let target = analysis.target_label_of(k, label);
                lines.push(Line { optimiser, group: label, target, trials });
            }
        }
    }
    lines
}

/// Running times, infinite where the target was not reached.
pub(super) fn times(trials: &[Trial]) -> impl Iterator<Item = f64> {
    trials.iter().map(|trial| if trial.solved { trial.evaluations } else { f64::INFINITY })
}
