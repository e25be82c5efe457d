//! The empirical distribution of running times over many targets.

use polars::prelude::*;

use super::fixed_target::times;
use crate::analysis::grouped::{Analysis, trial};
use crate::analysis::statistics::{Trial, simulated_restarts};
use crate::exhibit::Table;
use crate::experiment::Run;
use crate::search::Rng;

/// Targets: the least cost known and 10², …, 10⁻⁸ above it, five to a power of ten, as COCO has them.
const TARGETS: i32 = 51;
/// Simulated restarts for each instance and target.
const RESTARTS: usize = 50;
/// Points of a curve.
const POINTS: usize = 100;

/// By how much the targets lie above the least cost, the largest first.
pub(super) fn differences() -> impl Iterator<Item = f64> {
    (0..TARGETS).map(|i| 10_f64.powf(2.0 - f64::from(i) / 5.0))
}

/// What a group's runs say about all targets, in evaluations.
#[derive(Default)]
struct Times {
    /// Of the runs as they were.
    runs: Vec<f64>,
    /// Of runs restarted until they succeed.
    restarted: Vec<f64>,
}

impl Times {
    fn extend(&mut self, other: &Self) {
        self.runs.extend(&other.runs);
        self.restarted.extend(&other.restarted);
    }

    fn sorted(mut self) -> Self {
        self.runs.sort_by(f64::total_cmp);
        self.restarted.sort_by(f64::total_cmp);
        self
    }
}

/// A curve: the optimiser's and the group's label, and the times behind it.
type Curve<'a> = ([&'a str; 2], Times);

/// One curve per optimiser and group, and one per optimiser over all.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let budget = analysis.runs.iter().map(|run| run.budget).max().unwrap_or(1);
    let grid = grid(10.0 * budget as f64);
    let curves = curves(analysis);
    let rows = || curves.iter().flat_map(|curve| grid.iter().map(move |&at| (curve, at)));
    let frame = df!(
        "group" => rows().map(|((labels, _), _)| labels[1]).collect::<Vec<_>>(),
        "optimiser" => rows().map(|((labels, _), _)| labels[0]).collect::<Vec<_>>(),
        "evaluations" => rows().map(|(_, at)| at).collect::<Vec<_>>(),
        "share of runs" => rows().map(|((_, t), at)| share(&t.runs, at)).collect::<Vec<_>>(),
        "share with restarts" =>
            rows().map(|((_, t), at)| share(&t.restarted, at)).collect::<Vec<_>>(),
    )?;
    let caption = "Share of pairs of run and target reached within so many evaluations; 51 targets from 10² to \
        10⁻⁸ above the least cost known or found. With restarts: a run that fails is followed by others, drawn with \
        replacement, until one succeeds.";
    Ok(Table::curve("running-time-distribution", caption, frame))
}

fn curves<'a>(analysis: &'a Analysis<'_>) -> Vec<Curve<'a>> {
    let mut all: Vec<Times> = analysis.plan.optimisers.iter().map(|_| Times::default()).collect();
    let mut curves: Vec<Curve<'_>> = Vec::new();
    for group in &analysis.groups {
        let times = times_of(analysis, group);
        all[group[0].optimiser].extend(&times);
        curves.push((analysis.labels(group), times.sorted()));
    }
    let first = curves.first().map(|(labels, _)| labels[1]);
    if curves.iter().any(|(labels, _)| Some(labels[1]) != first) {
        let over_all = all.into_iter().enumerate().filter(|(_, times)| !times.runs.is_empty());
        curves.extend(over_all.map(|(i, times)| ([analysis.optimiser(i), "all"], times.sorted())));
    }
    curves
}

/// Evaluations, evenly spaced on a logarithmic axis.
fn grid(last: f64) -> Vec<f64> {
    let mut grid: Vec<f64> =
        (0..POINTS).map(|i| last.powf(i as f64 / (POINTS - 1) as f64).round()).collect();
    grid.dedup();
    grid
}

/// Share of sorted times up to a limit.
fn share(times: &[f64], limit: f64) -> f64 {
    times.partition_point(|&time| time <= limit) as f64 / times.len().max(1) as f64
}

/// The running times of the runs of one optimiser on one group of instances.
fn times_of(analysis: &Analysis<'_>, group: &[&Run]) -> Times {
    let mut by_instance: Vec<&Run> = group.to_vec();
    by_instance.sort_by_key(|run| run.instance);
    let mut found = Times::default();
    let mut rng = Rng::new(1);
    for runs in by_instance.chunk_by(|a, b| a.instance == b.instance) {
        let least = analysis.targets.least[runs[0].instance];
        for target in differences().map(|difference| least + difference) {
            let trials: Vec<Trial> = runs.iter().map(|run| trial(run, target)).collect();
            found.runs.extend(times(&trials));
            found.restarted.extend(simulated_restarts(&trials, RESTARTS, |n| rng.index(n)));
        }
    }
    found
}
