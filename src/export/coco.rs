//! COCO: for each algorithm and function an index, and for each dimension two tables of its runs.
//!
//! The layout is that of COCO's logger `bbob`, format `bbob-new2` (doi 10.1080/10556788.2020.1808977), as
//! `cocopp` 2.9.1 reads it: `.dat` has a row where a target is first reached, `.tdat` where the
//! evaluations reach a mark. Costs are differences from the instance's optimum. Points are left out.
//!
//! Every pair of instance and seed is a trial with a number of its own: `cocopp` would weigh trials
//! that share a number by how often it stands there.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use super::suite::{Algorithm, ExportedRun, Function, SUITE, Suite, SuiteError};
use super::write_plain;
use crate::output::create_folder;

/// Below this difference from the optimum no further target is set.
const PRECISION: f64 = 1e-8;

/// Targets a decade: `10^(i/5)` for whole `i`.
const TARGETS: f64 = 5.0;

/// Numbers of trials that each instance has, more than there can be seeds.
const SEEDS: u64 = 2_000_000;

/// Marks a decade of evaluations: `10^(i/20)`, rounded down.
const MARKS: f64 = 20.0;

/// Stands where no cost was finite, and for differences that are larger: the reader never comes to an
/// end with infinities.
const NOTHING: f64 = 1e300;

/// Writes all files into a folder.
pub(super) fn write(suite: &Suite, folder: &Path) -> Result<(), SuiteError> {
    for ((algorithm, function), by_dimension) in suite.cells() {
        let function = &suite.functions[function];
        let id = function.number;
        let algorithm = &suite.algorithms[algorithm];
        let home = folder.join(&algorithm.folder);
        let data = format!("data_f{id}");
        create_folder(&home.join(&data))?;
        let mut index = String::new();
        for (dimension, trials) in by_dimension {
            let path = format!("{data}/bbobexp_f{id}_DIM{dimension}.dat");
            let groups: BTreeSet<&str> =
                trials.iter().map(|trial| suite.objective(trial).group.as_str()).collect();
            let groups: Vec<&str> = groups.into_iter().collect();
            let budget = trials.iter().map(|trial| trial.budget).max().unwrap_or(1);
            let digests: BTreeSet<(u32, &str)> = trials
                .iter()
                .map(|trial| suite.objective(trial))
                .map(|instance| (instance.number, instance.digest.as_str()))
                .collect();
            let digests: Vec<String> =
                digests.iter().map(|(number, digest)| format!("{number} {digest}")).collect();
            let entry = [&groups.join("; "), &digests.join(", "), &budget.to_string()];
            head(&mut index, algorithm, function, (id, dimension), entry.map(String::as_str));
            index.push_str(&path);
            let (mut by_target, mut by_evaluation) = (String::new(), String::new());
            for trial in trials {
                let trace = trace(suite, trial);
                let last = trace.last().map_or(NOTHING, |row| row.difference);
                let number = SEEDS * u64::from(suite.objective(trial).number) + trial.seed;
                let _ = write!(index, ", {number}:{}|{last:.1e}", trial.evaluations());
                let optimum = suite.objective(trial).optimum;
                write_rows(&mut by_target, optimum, &targets_hit(&trace));
                write_rows(&mut by_evaluation, optimum, &at_marks(&trace, dimension));
            }
            index.push('\n');
            write_plain(&home.join(&path), &by_target)?;
            write_plain(&home.join(&path).with_extension("tdat"), &by_evaluation)?;
        }
        write_plain(&home.join(format!("bbobexp_f{id}.info")), &index)?;
    }
    Ok(())
}

/// The first two lines of an entry of the index.
fn head(
    index: &mut String,
    algorithm: &Algorithm,
    function: &Function,
    (id, dimension): (u32, u16),
    [group, digests, budget]: [&str; 3],
) {
    let known = function.instances.iter().all(|instance| instance.is_known);
    let optimum = if known { "known beforehand" } else { "least cost found by any of these runs" };
    let _ = writeln!(
        index,
        "suite = '{SUITE}', funcId = {id}, DIM = {dimension}, Precision = {PRECISION:.3e}, \
         algId = '{}', coco_version = '2.8.2', logger = 'bbob', data_format = 'bbob-new2', \
         settings = ''\n\
         % {}: {} {}; group {group}; Fopt: {optimum}; instance i with seed s is trial {SEEDS} i + s; \
         digests of instances {digests}; budget {budget}",
        algorithm.name.replace('\'', "\""),
        function.name,
        algorithm.name,
        algorithm.settings,
    );
}

/// One row of a table.
#[derive(Debug, Clone, Copy)]
struct Row {
    evaluation: u64,
    /// The best so far less the optimum.
    difference: f64,
    /// The best so far.
    cost: f64,
}

/// A run's trace.
fn trace(suite: &Suite, trial: &ExportedRun) -> Vec<Row> {
    let optimum = suite.objective(trial).optimum;
    // Without a finite cost there may be no optimum either.
    let finite = |x: f64| if x.is_finite() { x.min(NOTHING) } else { NOTHING };
    let row = |&(evaluation, cost): &(u64, f64)| Row {
        evaluation,
        difference: finite(cost - optimum),
        cost: finite(cost),
    };
    trial.trace.iter().map(row).collect()
}

/// The first row, and those that reach a target which none before did.
fn targets_hit(trace: &[Row]) -> Vec<Row> {
    // Equal to a target within rounding is a hit.
    let target = |row: &Row| (TARGETS * row.difference.max(PRECISION).log10() - 1e-10).ceil();
    let mut least = f64::INFINITY;
    let mut hits = Vec::new();
    for row in trace {
        if target(row) < least {
            least = target(row);
            hits.push(*row);
        }
    }
    hits
}

/// The best so far at every mark of the evaluations, at 1, 2, 5, 10, … times the dimension, and at the end.
fn at_marks(trace: &[Row], dimension: u16) -> Vec<Row> {
    let last = trace.last().map_or(1, |row| row.evaluation);
    let scaled = (0..=last.max(1).ilog10()).flat_map(|decade| {
        [1, 2, 5].map(|n| 10_u64.pow(decade).saturating_mul(n * u64::from(dimension)))
    });
    let spaced = (0..).map(|i| 10_f64.powf(f64::from(i) / MARKS) as u64);
    let mut marks: BTreeSet<u64> = spaced.take_while(|mark| *mark < last).collect();
    marks.extend(scaled.filter(|mark| *mark < last));
    marks.insert(last);
    let at = |mark: u64| {
        let made = trace.partition_point(|row| row.evaluation <= mark);
        made.checked_sub(1).map(|i| Row { evaluation: mark, ..trace[i] })
    };
    marks.into_iter().filter_map(at).collect()
}

/// One run of a table. The columns: evaluations, constraints evaluated, difference from the optimum, cost,
/// least cost. The last two are the same, since only the best so far is stored.
fn write_rows(text: &mut String, optimum: f64, rows: &[Row]) {
    let optimum = if optimum.is_finite() { optimum } else { 0.0 };
    let _ = writeln!(
        text,
        "% f evaluations | g evaluations | best noise-free fitness - Fopt ({optimum:.12e}) + sum g_i+ \
         | measured fitness | best measured fitness or single-digit g-values | x1 | x2..."
    );
    for Row { evaluation, difference, cost } in rows {
        let _ = writeln!(text, "{evaluation} 0 {difference:e} {cost:e} {cost:e}");
    }
}
