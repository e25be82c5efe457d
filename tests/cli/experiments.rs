//! What `run` promises: the same results whatever the number of jobs, nothing done twice, nothing
//! half-written, figures in three formats.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::folder::{Folder, stderr, stdout};
use polars::prelude::*;

const SMALL: &str = "name = 'small'\nseeds = 3\nbudget = { evaluations = 700 }\ntargets = [1000, 0.1]\n\
    [sweep]\njerk_limit_deg_s3 = [40, 80]\n[[optimiser]]\npso = { population = 20 }\n\
    [[optimiser]]\nrandom = { formulation = 'scaled' }\n";

/// A task of the paper's, but for another robot.
pub(crate) const OWN_ARM: &str = "[task]\nrobot = 'arm.toml'\n\
    start = { joints_deg = [10, 30, 45, -20, -25, 40], base_zyx_deg = [6, 15, 7] }\n\
    goal = { joints_deg = [40, 60, 90, -10, -30, 60], base_zyx_deg = [0, 0, 0] }\n\
    limits = { rate_deg_s = 60, acceleration_deg_s2 = 70 }\n";

pub(crate) fn run(folder: &Folder, args: &[&str]) -> String {
    let output = folder.run(&[&["run"], args].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

/// Every file of a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let entries = entries.filter(|entry| entry.path().is_file());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap())).collect()
}

/// The tables in a folder, file by file.
fn tables(folder: &Path) -> impl Iterator<Item = DataFrame> {
    let read = |bytes: Vec<u8>| ParquetReader::new(std::io::Cursor::new(bytes)).finish().unwrap();
    files(folder).into_values().map(read)
}

/// The rows of all tables in a folder, each a table of its own.
pub(crate) fn single_rows(folder: &Path) -> Vec<DataFrame> {
    tables(folder).flat_map(|t| (0..t.height() as i64).map(move |i| t.slice(i, 1))).collect()
}

#[test]
fn traces_are_the_same_bytes_whatever_the_jobs() {
    let folder = Folder::new().with("small.toml", SMALL);
    for (out, jobs) in [("one", "1"), ("two", "2"), ("again", "2")] {
        run(&folder, &["small.toml", "--out", out, "--jobs", jobs]);
    }
    let traces = |out: &str| files(&folder.path().join(out).join("traces"));
    let one = traces("one");
    assert_eq!(one.len(), 12);
    assert_eq!(one, traces("two"));
    assert_eq!(one, traces("again"));
}

#[test]
fn budgets_are_spent_to_the_last_evaluation_and_not_overshot() {
    let folder = Folder::new().with("small.toml", SMALL);
    run(&folder, &["small.toml", "--out", "out"]);
    for runs in single_rows(&folder.path().join("out/runs")) {
        assert_eq!(runs.column("evaluations").unwrap().u64().unwrap().get(0), Some(700));
    }
    for trace in tables(&folder.path().join("out/traces")) {
        let column = trace.column("evaluation").unwrap().u64().unwrap().clone();
        let evaluations: Vec<u64> = column.into_no_null_iter().collect();
        assert_eq!((evaluations[0], evaluations[evaluations.len() - 1]), (1, 700));
        assert!(evaluations.is_sorted_by(|a, b| a < b));
        let column = trace.column("j").unwrap().f64().unwrap().clone();
        let costs: Vec<f64> = column.into_no_null_iter().collect();
        assert!(costs.is_sorted_by(|a, b| a >= b));
    }
}

#[test]
fn stored_runs_are_not_done_again() {
    let folder = Folder::new().with("small.toml", SMALL);
    run(&folder, &["small.toml", "--out", "out", "--shard", "0/2"]);
    let first = files(&folder.path().join("out/runs"));
    assert_eq!(first.len(), 6);
    run(&folder, &["small.toml", "--out", "out", "--shard", "1/2"]);
    let summary = run(&folder, &["small.toml", "--out", "out"]);
    let all = files(&folder.path().join("out/runs"));
    assert_eq!(all.len(), 12);
    // Runs carry their date: the same bytes mean that nothing was done twice.
    assert!(first.iter().all(|(name, bytes)| all[name] == *bytes));
    assert!(summary.contains("J ≤ 1000") && summary.contains("3/3") && summary.contains("0/3"));
    run(&folder, &["small.toml", "--out", "out", "--fresh"]);
    let fresh = files(&folder.path().join("out/runs"));
    assert!(first.iter().all(|(name, bytes)| fresh[name] != *bytes));
}

/// An edited experiment finds its stored runs under their new names, and leaves out what it no longer
/// has.
#[test]
fn edited_experiments_keep_what_still_fits() {
    let field = |settings: &[&str]| {
        let tables = settings.iter().map(|s| format!("[[optimiser]]\npso = {{ {s} }}\n"));
        let head = "name = 'edited'\nseeds = 2\nbudget = { evaluations = 100 }\n";
        head.to_owned() + &tables.collect::<String>()
    };
    let (a, b, c) = ("population = 10", "population = 11", "population = 12");
    let folder = Folder::new().with("edited.toml", field(&[a, b]));
    run(&folder, &["edited.toml"]);
    let folder = folder.with("edited.toml", field(&[b, c]));
    let output = folder.run(&["run", "edited.toml"]);
    assert!(stderr(&output).contains("2 of 4 runs are stored already"), "{}", stderr(&output));
    let summary = stdout(&output);
    for label in ["pso/time-free population=11 ", "pso/time-free population=12 "] {
        let line = summary.lines().find(|l| l.contains(label)).unwrap();
        assert!(line.split_whitespace().nth(2) == Some("2"), "{line}");
    }
    assert!(!summary.contains("population=10"));
}

/// What a run determines stands in its row, and its inputs beside it run again.
#[test]
fn results_say_how_to_get_them_again() {
    let robot =
        include_str!("../../src/robot/shipped/xiao2023.toml").replace("mass = 600", "mass = 700");
    let text = SMALL.replace("[sweep]", &format!("{OWN_ARM}[sweep]"));
    let folder = Folder::new().with("small.toml", text).with("arm.toml", robot);
    run(&folder, &["small.toml", "--out", "out"]);
    let recipe = single_rows(&folder.path().join("out/runs"))[0].column("recipe").unwrap().clone();
    let recipe: serde_json::Value =
        serde_json::from_str(recipe.str().unwrap().get(0).unwrap()).unwrap();
    assert_eq!(recipe["subject"]["identity"]["task"]["robot"]["base"]["body"]["mass"], 700.0);
    std::fs::remove_file(folder.path().join("arm.toml")).unwrap();
    run(&folder, &["out/experiment.toml", "--out", "again"]);
    let traces = |out: &str| files(&folder.path().join(out).join("traces"));
    assert_eq!(traces("out"), traces("again"));
}

#[test]
fn figures_come_in_three_formats_with_text_that_is_there() {
    let folder = Folder::new().with("small.toml", SMALL);
    run(&folder, &["small.toml", "--out", "out"]);
    let figures = files(&folder.path().join("out/figures"));
    for (name, is_there) in
        [("convergence", true), ("jerk-sweep", true), ("joint-angles", false), ("pareto", false)]
    {
        // With a sweep there is no best motion of all.
        assert_eq!(figures.contains_key(&format!("{name}.pdf")), is_there, "{name}");
    }
    let one = SMALL.replace("[40, 80]", "[80]");
    let folder = folder.with("one.toml", one);
    run(&folder, &["one.toml", "--out", "one"]);
    let figures = files(&folder.path().join("one/figures"));
    for name in ["joint-angles", "joint-derivatives", "base-attitude", "snapshots", "convergence"] {
        let svg = String::from_utf8(figures[&format!("{name}.svg")].clone()).unwrap();
        assert!(svg.contains("<path") && !svg.contains("<text"), "{name}: text is no outline");
        let png = &figures[&format!("{name}.png")];
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        let width = u32::from_be_bytes(png[16..20].try_into().unwrap());
        assert_eq!(width, 1040, "88 mm at 300 dots an inch");
        // 300 dots an inch are 11811 a metre.
        let size = png.windows(4).position(|bytes| bytes == b"pHYs").unwrap() + 4;
        assert_eq!(png[size..size + 4], 11_811_u32.to_be_bytes());
        assert_eq!(&figures[&format!("{name}.pdf")][..5], b"%PDF-");
    }
}

/// Instances that differ in shift and rotation alone are summarised and drawn together; what only a
/// task has is not shown.
#[test]
fn test_functions_are_problems_like_any_other() {
    let text = "name = 'functions'\nseeds = 2\nbudget = { evaluations = 3000 }\n[functions]\n\
        name = ['sphere', 'rastrigin']\ndimension = [2, 3]\ninstances = 3\n\
        [[optimiser]]\npso = { population = 20 }\n[[optimiser]]\nrandom = {}\n";
    let folder = Folder::new().with("functions.toml", text);
    let check = stdout(&folder.run(&["check", "functions.toml"]));
    assert!(check.contains("# 48 runs: 12 instances × 2 optimisers × 2 seeds"), "{check}");
    let summary = run(&folder, &["functions.toml", "--out", "out"]);
    assert_eq!(files(&folder.path().join("out/runs")).len(), 48);
    let figures = files(&folder.path().join("out/figures"));
    assert!(figures.contains_key("final-costs.svg") && !figures.contains_key("snapshots.svg"));
    let rows: Vec<&str> = summary.lines().filter(|line| line.contains("dimension=")).collect();
    assert_eq!(rows.len(), 8, "{summary}");
    let cells: Vec<&str> = rows[0].split_whitespace().collect();
    assert_eq!(cells[..5], ["sphere", "dimension=2", "pso", "6", "0"]);
    assert_eq!(cells[cells.len() - 3..], ["6/6", "6/6", "6/6"], "{summary}");
    assert!(summary.contains("f ≤ 0.01") && summary.contains("f ≤ 1e-8"), "{summary}");
    for word in ["t_f", "residual", "motion", "J"] {
        assert!(!summary.contains(word), "{word}: {summary}");
    }
    for runs in single_rows(&folder.path().join("out/runs")) {
        let name = runs.column("problem").unwrap().str().unwrap().get(0).unwrap();
        assert!(["sphere", "rastrigin"].contains(&name));
        assert!(runs.column("t_f").is_err(), "a function has no duration");
        assert_eq!(runs.column("evaluations").unwrap().u64().unwrap().get(0), Some(3000));
    }
    run(&folder, &["out/experiment.toml", "--out", "again"]);
    let traces = |out: &str| files(&folder.path().join(out).join("traces"));
    assert_eq!(traces("out"), traces("again"));
}

/// Without targets of its own an experiment takes those of the best motions known, 0.781849 and
/// 0.631490, and keeps them with its results.
#[test]
fn targets_follow_the_best_known() {
    let text = "name = 'x'\nseeds = 1\nbudget = { evaluations = 20 }\n[[optimiser]]\nrandom = {}\n";
    let folder = Folder::new().with("one.toml", text);
    let summary = run(&folder, &["one.toml", "--out", "one"]);
    for target in ["J ≤ 0.860033", "J ≤ 0.789667", "J ≤ 0.78263"] {
        assert!(summary.contains(target), "{summary}");
    }
    assert!(summary.contains(" above the best known, 0.781849)"), "{summary}");
    let runs = &single_rows(&folder.path().join("one/runs"))[0];
    let targets = runs.column("targets").unwrap().list().unwrap().get_as_series(0).unwrap();
    assert_eq!(targets.f64().unwrap().get(0), Some(0.860_033));
    let kept = fs::read_to_string(folder.path().join("one/experiment.toml")).unwrap();
    assert!(kept.contains("targets = [0.860033, 0.789667, 0.78263]"), "{kept}");

    let folder = folder.with("many.toml", text.to_owned() + "[sweep]\nterms = [2, 3, 5]\n");
    let summary = run(&folder, &["many.toml", "--out", "many"]);
    assert!(summary.contains("J, target 1"), "{summary}");
    for target in ["0/1 ≤ 0.860033", "0/1 ≤ 0.694639"] {
        assert!(summary.contains(target), "{summary}");
    }
    let kept = stdout(&folder.run(&["check", "many/experiment.toml"]));
    assert!(kept.contains("\"terms=5\" = []"), "{kept}");
    assert_eq!(run(&folder, &["many/experiment.toml", "--out", "many"]), summary);
}

#[test]
fn shipped_experiments_are_valid() {
    let mut folder = Folder::new();
    fs::create_dir(folder.path().join("robots")).unwrap();
    for (name, bytes) in files(Path::new("experiments/robots")) {
        folder = folder.with(&format!("robots/{name}"), bytes);
    }
    for (name, bytes) in files(Path::new("experiments")) {
        let check = |folder: &Folder, name: &str| folder.run(&["check", name, "--no-estimate"]);
        folder = folder.with(&name, bytes);
        let output = check(&folder, &name);
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        folder = folder.with("again.toml", stdout(&output));
        let again = check(&folder, "again.toml");
        assert_eq!(stdout(&again), stdout(&output));
    }
}

/// Masses whose sum is no finite number: no cost is one either. Every run is recorded all the same, and
/// the experiment is done.
#[test]
fn runs_that_find_nothing_are_recorded() {
    let robot = include_str!("../../src/robot/shipped/xiao2023.toml");
    let heavy = |line: &str| {
        if line.starts_with("mass = ") { "mass = 1e308".to_owned() } else { line.to_owned() }
    };
    let robot: Vec<String> = robot.lines().map(heavy).collect();
    let text = SMALL.replace("[sweep]", &format!("{OWN_ARM}[sweep]"));
    let folder = Folder::new().with("small.toml", text).with("arm.toml", robot.join("\n"));
    let output = folder.run(&["run", "small.toml", "--out", "out"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("warning: 12 of 12 runs failed or found nothing"));
    let status = stdout(&folder.run(&["status", "out"]));
    assert!(status.contains("12 of 12 runs are stored, 12 failed, 0 missing"), "{status}");
    assert!(status.contains("seed 1: no evaluation had a finite cost"), "{status}");
    for runs in single_rows(&folder.path().join("out/runs")) {
        assert_eq!(runs.column("evaluations").unwrap().u64().unwrap().get(0), Some(700));
        assert!(runs.column("j").unwrap().get(0).unwrap().is_null());
    }
    assert_eq!(tables(&folder.path().join("out/traces")).count(), 12);
}

/// A folder that cannot be written to is named, with exit status 1.
#[test]
fn unwritable_results_fail() {
    let folder = Folder::new().with("small.toml", SMALL).with("file", "");
    let output = folder.run(&["run", "small.toml", "--out", "file/out"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!("unwritable_results", stderr(&output));
}

/// A report tells what is there, be it nothing, and no label keeps it from being drawn.
#[test]
fn reports_of_few_runs_and_odd_labels_are_whole() {
    let text = "name = 'part'\nseeds = 2\nbudget = { evaluations = 100 }\n\
        [[optimiser]]\nrandom = {}\nlabel = \"a\\u0007\\uE000 <b>&\"\n\
        [[optimiser]]\nrandom = { formulation = 'raw' }\nlabel = 'block'\n\
        [[optimiser]]\nrandom = { formulation = 'scaled' }\n";
    let folder = Folder::new().with("part.toml", text);
    run(&folder, &["part.toml", "--out", "out", "--shard", "0/6"]);
    let report = |expected: &str| {
        let output = folder.run(&["report", "out", "--replace"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains(expected), "{}", stdout(&output));
        let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert!(page.contains(expected) && page.trim_end().ends_with("</html>"));
    };
    report("Only 1 of 6 runs is stored so far");
    for table in ["runs", "traces", "clocks"] {
        std::fs::remove_dir_all(folder.path().join("out").join(table)).unwrap();
    }
    report("Only 0 of 6 runs are stored so far");
    run(&folder, &["part.toml", "--out", "out"]);
    report("Who won?");
    let blocks = std::fs::read_to_string(folder.path().join("out/tables/blocks.csv")).unwrap();
    assert!(blocks.contains("seed 1,"), "{blocks}");
}
