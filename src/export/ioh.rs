//! IOHprofiler: one JSON file an algorithm and function, and one table of its runs a dimension.
//!
//! The layout is that of the logger `ioh` 0.3.22 (doi `10.1162/evco_a_00342`), as `iohinspector` 0.0.8
//! reads it. Both split a table into runs where `evaluations` is 1. Attributes of an experiment are
//! evaluated as Python when read, so they are literals here; those of a run are not surfaced, so the
//! seed is also a column. `digest` tells a run's instance from all others, which may share its number.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::suite::{ExportedRun, Function, SUITE, Suite, SuiteError};
use super::write_plain;
use crate::output::create_folder;

/// Version of the logger whose layout this is.
const VERSION: &str = "0.3.22";

/// Columns of the tables, and their heading before each run.
const COLUMNS: [&str; 3] = ["evaluations", "raw_y", "seed"];

/// Writes all files into a folder.
pub(super) fn write(suite: &Suite, folder: &Path) -> Result<(), SuiteError> {
    for ((algorithm, function), by_dimension) in suite.cells() {
        let function = &suite.functions[function];
        let id = function.number;
        let algorithm = &suite.algorithms[algorithm];
        let home = folder.join(&algorithm.folder);
        let data = format!("data_f{id}_{}", function.file);
        create_folder(&home.join(&data))?;
        let mut scenarios = Vec::new();
        for (dimension, trials) in by_dimension {
            let path = format!("{data}/IOHprofiler_f{id}_DIM{dimension}.dat");
            write_plain(&home.join(&path), &table(&trials))?;
            let runs: Vec<Value> = trials.iter().map(|trial| run(suite, trial)).collect();
            scenarios.push(json!({ "dimension": dimension, "path": path, "runs": runs }));
        }
        let index = json!({
            "version": VERSION,
            "suite": SUITE,
            "function_id": id,
            "function_name": function.name,
            "maximization": false,
            "algorithm": { "name": algorithm.name, "info": algorithm.settings },
            "experiment_attributes": experiment_attributes(suite, function),
            "run_attributes": ["seed", "optimum", "budget", "digest"],
            "attributes": COLUMNS,
            "scenarios": scenarios,
        });
        let name = format!("IOHprofiler_f{id}_{}.json", function.file);
        write_plain(&home.join(name), &format!("{index:#}\n"))?;
    }
    Ok(())
}

/// What holds for all runs of a function, each value a literal of Python.
fn experiment_attributes(suite: &Suite, function: &Function) -> Vec<Value> {
    let known = function.instances.iter().all(|instance| instance.is_known);
    let optimum = if known { "known" } else { "least found" };
    let text = |text: &str| Value::from(text).to_string();
    vec![
        json!({ "experiment": text(&suite.name) }),
        json!({ "group": text(&function.groups.join("; ")) }),
        json!({ "budget": suite.budget.to_string() }),
        json!({ "optimum_source": text(optimum) }),
        json!({ "written_by": text(concat!("driftless ", env!("CARGO_PKG_VERSION"))) }),
    ]
}

/// One run; a cost that is not finite becomes null.
fn run(suite: &Suite, trial: &ExportedRun) -> Value {
    let best = trial.best();
    let found = trial.trace.iter().find(|(_, cost)| *cost == best);
    json!({
        "instance": suite.objective(trial).number,
        "evals": trial.evaluations(),
        "best": { "evals": found.map(|(evaluation, _)| evaluation), "y": best, "x": [] },
        "seed": trial.seed,
        "optimum": suite.objective(trial).optimum,
        "budget": trial.budget,
        "digest": suite.objective(trial).digest,
    })
}

/// The traces, with all digits; a cost that is not finite yet is `inf`.
fn table(trials: &[&ExportedRun]) -> String {
    let mut text = String::new();
    for trial in trials {
        text.push_str(&COLUMNS.join(" "));
        text.push('\n');
        for (evaluation, cost) in &trial.trace {
            let _ = writeln!(text, "{evaluation} {cost:?} {}", trial.seed);
        }
    }
    text
}
