//! Expected running time against the target.

use polars::prelude::*;
use rayon::prelude::*;

use super::distribution::differences;
use crate::analysis::grouped::{Analysis, trial};
use crate::analysis::statistics::{Trial, expected_running_time};
use crate::exhibit::Table;
use crate::experiment::Run;

/// A line of the table: a group's runs, and by how much the targets of their instances lie above the least cost.
struct Line<'a> {
    group: &'a [&'a Run],
    difference: f64,
}

/// One line per optimiser, group and target.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let of = |group| differences().map(move |difference| Line { group, difference });
    let lines: Vec<Line<'_>> = analysis.groups.iter().flat_map(|group| of(group)).collect();
    let told: Vec<(u64, f64)> = lines.par_iter().map(|line| told(analysis, line)).collect();
    let frame = df!(
        "group" => lines.iter().map(|l| analysis.labels(l.group)[1]).collect::<Vec<_>>(),
        "optimiser" => lines.iter().map(|l| analysis.labels(l.group)[0]).collect::<Vec<_>>(),
        "above least" => lines.iter().map(|l| l.difference).collect::<Vec<_>>(),
        "runs" => lines.iter().map(|l| l.group.len() as u64).collect::<Vec<_>>(),
        "successes" => told.iter().map(|told| told.0).collect::<Vec<_>>(),
        "expected running time" => told.iter().map(|told| told.1).collect::<Vec<_>>(),
    )?;
    let caption = "Expected running time in evaluations, over all runs of a group, to targets that lie so much above the \
        least cost known or found of each run's instance: the targets of running-time-distribution. Infinite where no \
        run reached its target.";
    Ok(Table::curve("expected-running-time", caption, frame))
}

/// Successes and the expected running time.
fn told(analysis: &Analysis<'_>, line: &Line<'_>) -> (u64, f64) {
    let target = |run: &Run| analysis.targets.least[run.instance] + line.difference;
    let trials: Vec<Trial> = line.group.iter().map(|run| trial(run, target(run))).collect();
    let successes = trials.iter().filter(|trial| trial.solved).count();
    (successes as u64, expected_running_time(&trials))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::handmade::{plan, runs};
    use crate::analysis::targets;

    /// Evaluations of all runs for each success; the least value of the function is 0.
    #[test]
    fn failures_count_with_all_they_spent() {
        let plan = plan(
            "seeds = 2\nbudget = { evaluations = 100 }\n[functions]\nname = ['sphere']\n\
             [[optimiser]]\nrandom = {}\n",
        );
        let runs = runs(&plan, |run| match run.seed {
            1 => vec![(10, 1.0), (40, 0.01)],
            _ => vec![(20, 5.0)],
        });
        let targets = targets(&plan, &runs);
        let analysis = Analysis::new(&plan, &runs, &targets);
        let frame = table(&analysis).unwrap().frame;
        let times = frame.column("expected running time").unwrap().f64().unwrap();
        let successes = frame.column("successes").unwrap().u64().unwrap();
        assert_eq!(frame.height(), 51);
        // 10², 10⁰, 10⁻² and 10⁻⁸ above.
        for (row, solved, time) in
            [(0, 2, 15.0), (10, 1, 110.0), (20, 1, 140.0), (50, 0, f64::INFINITY)]
        {
            assert_eq!(successes.get(row), Some(solved), "row {row}");
            assert_eq!(times.get(row), Some(time), "row {row}");
        }
    }
}
