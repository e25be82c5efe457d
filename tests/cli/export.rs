//! What `export` writes, and when it writes nothing. `tests/exchange` has the tools whose formats these are
//! read it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};
use crate::replays::said;

const TWICE: &str = "name = 'twice'\nseeds = 3\nbudget = { evaluations = 300 }\n[sweep]\nterms = [2, 3]\n\
    [[optimiser]]\npso = { population = 20 }\n[[optimiser]]\npso = { population = 20, cognitive = 1.5 }\n\
    [[optimiser]]\nrandom = { formulation = 'raw' }\n";

const FUNCTIONS: &str = "name = 'functions'\nseeds = 2\nbudget = { evaluations = 400 }\n[functions]\n\
    name = ['sphere', 'rastrigin']\ndimension = [2, 3]\ninstances = 3\n[[optimiser]]\nrandom = {}\n";

/// Powers of time so large that hardly a cost is finite.
const OVERFLOW: &str = "name = 'overflow'\nseeds = 2\nbudget = { evaluations = 30 }\n\
    [trajectory.box]\nalpha = [1e300, 1e300]\n[[optimiser]]\nrandom = { formulation = 'raw' }\n";

/// A folder with the results of an experiment in `results`, exported to `ioh` and `coco`.
fn exported(experiment: &str) -> Folder {
    let folder = Folder::new().with("experiment.toml", experiment);
    let output = folder.run(&["run", "experiment.toml", "--out", "results"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for format in ["ioh", "coco"] {
        let output = folder.run(&["export", "results", "--format", format, "--out", format]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains("read it with\n  python -c"), "{}", stdout(&output));
    }
    folder
}

/// Every file below a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect();
    files.sort();
    files
}

fn with_extension(folder: &Path, extension: &str) -> Vec<PathBuf> {
    files(folder).into_iter().filter(|path| path.extension().unwrap() == extension).collect()
}

/// The rows of every run of a table; runs begin with a line that `is_heading`.
fn runs(table: &Path, is_heading: fn(&str) -> bool) -> Vec<Vec<Vec<f64>>> {
    let mut runs: Vec<Vec<Vec<f64>>> = Vec::new();
    for line in fs::read_to_string(table).unwrap().lines() {
        if is_heading(line) {
            runs.push(Vec::new());
        } else {
            let row = line.split(' ').map(|number| number.parse().unwrap()).collect();
            runs.last_mut().unwrap().push(row);
        }
    }
    runs
}

fn ioh_runs(table: &Path) -> Vec<Vec<Vec<f64>>> {
    runs(table, |line| line == "evaluations raw_y seed")
}

fn coco_runs(table: &Path) -> Vec<Vec<Vec<f64>>> {
    runs(table, |line| line.starts_with("% f evaluations | g evaluations | "))
}

/// A table's runs begin with evaluation 1 and come to it only there, and end with the last evaluation.
fn check_rows(runs: &[Vec<Vec<f64>>], spent: f64, cost: usize) {
    for rows in runs {
        assert!(rows.is_sorted_by(|a, b| a[0] < b[0] && a[cost] >= b[cost]), "{rows:?}");
        assert_eq!((rows[0][0], rows[rows.len() - 1][0]), (1.0, spent));
    }
}

#[test]
fn ioh_has_an_index_for_each_optimiser_and_function() {
    let folder = exported(TWICE);
    let ioh = folder.path().join("ioh");
    let mut folders: Vec<_> = fs::read_dir(&ioh)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    folders.sort();
    let expected =
        ["pso_time-free_population_20", "pso_time-free_population_20_cognitive_1_5", "random_raw"];
    assert_eq!(folders, expected);
    let indices = with_extension(&ioh, "json");
    assert_eq!(indices.len(), 6);
    let mut numbers = BTreeMap::new();
    for index in indices {
        let json: Value = serde_json::from_str(&fs::read_to_string(&index).unwrap()).unwrap();
        let dimension = match json["function_name"].as_str().unwrap() {
            "reorientation terms=2" => 13,
            "reorientation terms=3" => 19,
            other => panic!("{other}"),
        };
        numbers.insert(json["function_id"].as_u64().unwrap(), dimension);
        assert!(json["algorithm"]["name"].as_str().unwrap().contains('/'));
        let scenario = &json["scenarios"][0];
        assert_eq!(scenario["dimension"], dimension, "whatever the formulation");
        let runs = scenario["runs"].as_array().unwrap();
        let seeds: Vec<&Value> = runs.iter().map(|run| &run["seed"]).collect();
        assert_eq!(seeds, [1, 2, 3]);
        let rows = ioh_runs(&index.parent().unwrap().join(scenario["path"].as_str().unwrap()));
        assert_eq!(rows.len(), 3);
        check_rows(&rows, 300.0, 1);
        for (run, rows) in runs.iter().zip(rows) {
            let last = rows.last().unwrap();
            assert_eq!(
                (run["evals"].as_f64(), run["best"]["y"].as_f64()),
                (Some(300.0), Some(last[1]))
            );
            assert!(rows.iter().all(|row| run["seed"].as_f64() == Some(row[2])));
            let first = rows.iter().find(|row| row[1] == last[1]).unwrap()[0];
            assert_eq!(run["best"]["evals"].as_f64(), Some(first));
        }
    }
    assert_eq!(numbers.len(), 2, "{numbers:?}");
}

/// Of each function and dimension the three instances with two seeds are six trials with numbers of
/// their own.
#[test]
fn coco_has_a_trial_for_each_instance_and_seed() {
    let folder = exported(FUNCTIONS);
    let coco = folder.path().join("coco/random");
    let indices = with_extension(&coco, "info");
    assert_eq!(indices.len(), 2);
    let texts: Vec<String> =
        indices.iter().map(|index| fs::read_to_string(index).unwrap()).collect();
    let lines: Vec<&str> = texts.iter().flat_map(|text| text.lines()).collect();
    // The numbers of `FUNCTIONS`, as the catalogue of test functions has them.
    let expected = [(1, 2), (1, 3), (4, 2), (4, 3)];
    assert_eq!(lines.len(), 3 * expected.len());
    for (lines, (id, dimension)) in lines.chunks(3).zip(expected) {
        let text = lines.join("\n");
        let head = format!(
            "suite = 'driftless', funcId = {id}, DIM = {dimension}, Precision = 1.000e-8, "
        );
        assert!(lines[0].starts_with(&head) && lines[1].starts_with("% "), "{text}");
        assert!(lines[1].contains("known beforehand"), "{text}");
        let mut cells = lines[2].split(", ");
        let path = coco.join(cells.next().unwrap());
        let (numbers, spent): (Vec<&str>, Vec<&str>) =
            cells.map(|cell| cell.split('|').next().unwrap().split_once(':').unwrap()).unzip();
        let of = |instance: u64| [1, 2].map(|seed| (2_000_000 * instance + seed).to_string());
        let expected: Vec<String> = [1, 2, 3].into_iter().flat_map(of).collect();
        assert_eq!(
            (numbers, spent),
            (expected.iter().map(String::as_str).collect(), vec!["400"; 6])
        );
        let by_evaluation = coco_runs(&path.with_extension("tdat"));
        check_rows(&by_evaluation, 400.0, 2);
        let by_target = coco_runs(&path);
        assert_eq!((by_target.len(), by_evaluation.len()), (6, 6));
        for (targets, evaluations) in by_target.iter().zip(by_evaluation) {
            assert_eq!((targets[0][0], targets[0][2]), (1.0, evaluations[0][2]));
            // Each row but the first reaches a power of the fifth root of ten that the one before did not.
            let step = |row: &Vec<f64>| (5.0 * row[2].log10()).ceil();
            assert!(targets.is_sorted_by(|a, b| a[0] < b[0] && step(a) > step(b)), "{targets:?}");
        }
    }
}

/// A run that found nothing stays, with costs that no target is above.
#[test]
fn runs_that_found_nothing_stay() {
    let folder = exported(OVERFLOW);
    let [table] = &with_extension(&folder.path().join("ioh"), "dat")[..] else { panic!() };
    let row = |evaluation: f64, seed: f64| vec![evaluation, f64::INFINITY, seed];
    assert_eq!(ioh_runs(table), [1.0, 2.0].map(|seed| vec![row(1.0, seed), row(30.0, seed)]));
    let [index] = &with_extension(&folder.path().join("ioh"), "json")[..] else { panic!() };
    let json: Value = serde_json::from_str(&fs::read_to_string(index).unwrap()).unwrap();
    let run = &json["scenarios"][0]["runs"][0];
    assert!(run["evals"] == 30 && run["best"]["y"].is_null(), "{run}");
    let [table] = &with_extension(&folder.path().join("coco"), "dat")[..] else { panic!() };
    assert_eq!(coco_runs(table), vec![vec![vec![1.0, 0.0, 1e300, 1e300, 1e300]]; 2]);
    let [index] = &with_extension(&folder.path().join("coco"), "info")[..] else { panic!() };
    let text = fs::read_to_string(index).unwrap();
    let (before, last) = text.trim_end().rsplit_once(", ").unwrap();
    assert!(before.ends_with("00001:30|1.0e300") && last.ends_with("00002:30|1.0e300"), "{text}");
}

#[test]
fn half_an_experiment_is_exported_with_a_note() {
    let folder = Folder::new().with("twice.toml", TWICE);
    assert!(folder.run(&["run", "twice.toml", "--out", "out", "--shard", "0/2"]).status.success());
    let output = folder.run(&["export", "out", "--format", "ioh", "--out", "ioh"]);
    assert!(output.status.success());
    assert!(
        stderr(&output).contains("note: 9 of 18 runs are stored so far"),
        "{}",
        stderr(&output)
    );
    let tables = with_extension(&folder.path().join("ioh"), "dat");
    assert_eq!(tables.iter().map(|table| ioh_runs(table).len()).sum::<usize>(), 9);
}

/// What is there is not touched; what is written, is written whole.
#[test]
fn only_new_or_empty_folders_are_written() {
    let folder = exported(OVERFLOW);
    let before = files(folder.path());
    let output = folder.run(&["export", "results", "--format", "ioh", "--out", "coco"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!("export_full_folder", stderr(&output));
    assert_eq!(files(folder.path()), before, "something is left behind");
    fs::create_dir(folder.path().join("empty")).unwrap();
    for out in ["empty", "new/folder"] {
        let output = folder.run(&["export", "results", "--format", "ioh", "--out", out]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(files(&folder.path().join(out)).len(), 2);
    }
}

#[test]
fn folders_without_results_are_named() {
    let folder = Folder::new().with("experiment.toml", OVERFLOW);
    let fails = |results: &str, name: &str| {
        let output = folder.run(&["export", results, "--format", "ioh", "--out", "ioh"]);
        assert_eq!(output.status.code(), Some(2));
        insta::assert_snapshot!(name, stderr(&output));
        assert!(!folder.path().join("ioh").exists());
    };
    fails("nowhere", "export_no_results");
    fails(".", "export_no_runs");
}

/// The best motion of every instance, in the formats of `plan --motion`: at rest at both ends, and as long as
/// the table of best runs says.
#[test]
fn best_motions_are_exported() {
    let text = "name = 'two'\nseeds = 1\nbudget = { evaluations = 300 }\n[sweep]\nterms = [2, 3]\n\
        [[optimiser]]\nscp = { starts = 1 }\n";
    let folder = Folder::new().with("two.toml", text);
    assert!(folder.run(&["run", "two.toml", "--out", "results"]).status.success());
    assert!(folder.run(&["report", "results"]).status.success());
    for (format, ending) in [
        ("csv", "csv"),
        ("wide-csv", "wide.csv"),
        ("parquet", "parquet"),
        ("mat", "mat"),
        ("yaml", "yaml"),
        ("goal-yaml", "goal.yaml"),
        ("mujoco", "mujoco"),
    ] {
        let output = folder.run(&["export", "results", "--format", format, "--out", format]);
        assert!(output.status.success(), "{}", stderr(&output));
        let entries = std::fs::read_dir(folder.path().join(format)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        assert_eq!(names, ["terms_2", "terms_3"].map(|name| format!("{name}.{ending}")));
    }
    let sampled = ["export", "results", "--format", "wide-csv", "--rate", "50", "--out", "sampled"];
    assert!(folder.run(&sampled).status.success());
    let path = folder.path().join("sampled/terms_2.wide.csv");
    let times: Vec<f64> = csv::Reader::from_path(path)
        .unwrap()
        .records()
        .map(|row| row.unwrap()[0].parse().unwrap())
        .collect();
    let steps = times.len() - 1;
    assert!(times[..steps].iter().enumerate().all(|(k, time)| *time == k as f64 / 50.0));
    for (args, expected) in [
        (["--format", "ioh", "--dt", "0.1"], "--dt needs a motion to be written"),
        (["--format", "csv", "--dt", "1e-9"], "expected 1000000 samples or fewer"),
    ] {
        let refused = folder.run(&[&["export", "results", "--out", "none"], &args[..]].concat());
        let message = said(&stderr(&refused));
        assert!(!refused.status.success() && message.contains(expected), "{message}");
        assert!(!folder.path().join("none").exists());
    }
    let mut best = csv::Reader::from_path(folder.path().join("results/tables/best.csv")).unwrap();
    let column = best.headers().unwrap().iter().position(|name| name == "t_f [s]").unwrap();
    for (row, terms) in best.records().map(Result::unwrap).zip([2, 3]) {
        let path = folder.path().join(format!("csv/terms_{terms}.csv"));
        let rows: Vec<csv::StringRecord> =
            csv::Reader::from_path(path).unwrap().records().map(Result::unwrap).collect();
        let real = |row: &csv::StringRecord, i: usize| row[i].parse::<f64>().unwrap();
        assert!((real(rows.last().unwrap(), 0) - real(&row, column)).abs() < 1e-9);
        for end in [&rows[..6], &rows[rows.len() - 6..]] {
            assert!(end.iter().all(|row| real(row, 3).abs() < 1e-9), "{end:?}");
        }
    }
}
