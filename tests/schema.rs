//! The stored columns: `results/README.md` lists those that there are, in their order, with what the program says of
//! them, and stored tables have them.
#![cfg(feature = "harness")]

use std::fs;

use driftless::experiment::schema::{Cell, Column, clocks, plan, runs, traces};
use driftless::experiment::{Experiment, Folder, Options, Quantity};
use driftless::input::Document;
use driftless::registry;
use driftless::search::Watch;
use polars::prelude::*;

/// The rows of a table of columns.
fn rows<'a>(columns: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let row = |(name, meaning): (&str, &str)| format!("| `{name}` | {meaning} |\n");
    columns.map(row).collect()
}

fn listed(columns: &[Column]) -> String {
    let own = columns.iter().filter(|column| column.cell != Cell::OfSubject);
    rows(own.map(|column| (column.name, column.meaning)))
}

fn described(quantities: &[Quantity]) -> String {
    rows(quantities.iter().map(|quantity| (quantity.name.as_str(), quantity.meaning.as_str())))
}

#[test]
fn the_page_of_results_lists_every_column() {
    let page = fs::read_to_string("results/README.md").unwrap();
    let task = Experiment::read(&Experiment::embedded(), &registry()).unwrap().plan().unwrap();
    for expected in [
        listed(runs::COLUMNS),
        listed(traces::COLUMNS),
        listed(clocks::COLUMNS),
        listed(plan::COLUMNS),
        described(task.facts()),
        described(task.measures()),
    ] {
        assert!(page.contains(&expected), "results/README.md lacks\n{expected}");
    }
}

/// The names of a table's columns; a subject's stand where the schema says.
fn names(columns: &[Column], facts: &[Quantity], measures: &[Quantity]) -> Vec<String> {
    let own = |column: &Column| match column.name {
        runs::FACTS => facts.iter().map(|fact| fact.name.clone()).collect(),
        runs::MEASURES => measures.iter().map(|measure| measure.name.clone()).collect(),
        name => vec![name.to_owned()],
    };
    columns.iter().flat_map(own).collect()
}

#[test]
fn stored_tables_have_the_columns_in_order() {
    let document = Experiment::embedded();
    let experiment = Experiment::read(&document, &registry()).unwrap();
    let plan = experiment.with_budget(50.try_into().unwrap()).plan().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let results = Folder::create(folder.path(), plan).unwrap();
    results.run(Options::default(), &Watch::default(), &()).unwrap();
    let (facts, measures) = (results.plan.facts(), results.plan.measures());
    for (table, columns) in
        [("runs", runs::COLUMNS), ("traces", traces::COLUMNS), ("clocks", clocks::COLUMNS)]
    {
        let file = fs::read_dir(folder.path().join(table)).unwrap().next().unwrap().unwrap();
        let file = fs::File::open(file.path()).unwrap();
        let frame = ParquetReader::new(file).finish().unwrap();
        assert_eq!(columns_of(&frame), names(columns, facts, measures), "{table}");
    }
    let list = fs::File::open(folder.path().join("plan.parquet")).unwrap();
    let list = ParquetReader::new(list).finish().unwrap();
    assert_eq!(columns_of(&list), names(plan::COLUMNS, facts, measures));
    assert_eq!(list.height(), results.plan.runs.len());
}

fn columns_of(frame: &DataFrame) -> Vec<&str> {
    frame.get_column_names().into_iter().map(PlSmallStr::as_str).collect()
}

/// What a run's key is the hash of: stored runs are found by it, so it changes only where results do.
#[test]
fn the_recipe_of_a_run_is_pinned() {
    let text = "
        name = 'pinned'
        seeds = 1
        budget = { evaluations = 100 }
        functions = { name = ['sphere'], dimension = [2] }
        [[optimiser]]
        pso = {}
    ";
    let document = Document::embedded("pinned.toml", text);
    let plan = Experiment::read(&document, &registry()).unwrap().plan().unwrap();
    let recipe = concat!(
        r#"{"format":6,"version":5,"subject":{"kind":"function","name":"sphere","#,
        r#""identity":{"dimension":2,"instance":1}},"formulation":"","optimiser":{"pso":{"#,
        r#""population":150,"inertia":{"first":0.9,"last":0.1},"cognitive":2.0,"social":2.0,"#,
        r#""delta":1.0,"velocity_limit":0.2,"walls":"reflect"}},"seed":1,"evaluations":100}"#,
    );
    assert_eq!(plan.runs[0].recipe, recipe);
}

/// The subject's identity of the first run of an experiment on the paper's task.
fn identity(trajectory: &str) -> serde_json::Value {
    let text = format!(
        "name = 'pinned'\nseeds = 1\n[trajectory]\n{trajectory}\n[[optimiser]]\npso = {{}}\n"
    );
    let document = Document::embedded("pinned.toml", &text);
    let plan = Experiment::read(&document, &registry()).unwrap().plan().unwrap();
    let recipe: serde_json::Value = serde_json::from_str(&plan.runs[0].recipe).unwrap();
    recipe["subject"]["identity"].clone()
}

/// Results with sine polynomials from before there were other families are found by theirs.
#[test]
fn identities_of_families_are_pinned() {
    let text = |value: &serde_json::Value| serde_json::to_string(value).unwrap();
    let keys = |value: &serde_json::Value| -> Vec<String> {
        value.as_object().unwrap().keys().cloned().collect()
    };
    let sine = identity("terms = 3");
    assert_eq!(keys(&sine), ["task", "family", "accuracy", "box"]);
    assert_eq!(text(&sine["family"]), r#"{"name":"sine-polynomial","terms":3}"#);
    assert_eq!(text(&sine["accuracy"]), r#"{"attitude_steps":24,"peak_intervals":47}"#);
    assert_eq!(keys(&sine["box"]), ["coefficient", "duration", "alpha"]);
    assert_eq!(text(&sine["box"]["coefficient"]), "[1.0,0.35,0.15]");
    let spline = identity("family = 'spline'\npieces = 20\nbox.duration = [2, 9]");
    assert_eq!(keys(&spline), ["task", "family", "accuracy", "box"]);
    assert_eq!(text(&spline["family"]), r#"{"name":"spline","pieces":20,"degree":4}"#);
    assert_eq!(text(&spline["box"]), r#"{"duration":[2.0,9.0]}"#);
    assert_eq!(text(&spline["task"]), text(&sine["task"]));
}
