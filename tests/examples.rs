//! The examples do what their pages say: they run, are killed and go on, and the command reads their results without them.
#![cfg(all(feature = "harness", feature = "cli"))]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::Duration;

/// An example's program, which stands beside the command's.
fn example(name: &str) -> Command {
    let command = Path::new(env!("CARGO_BIN_EXE_driftless"));
    Command::new(command.with_file_name("examples").join(name))
}

fn driftless(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_driftless")).args(arguments).output().unwrap()
}

fn text(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    assert!(output.status.success(), "{out}{err}");
    format!("{out}{err}")
}

/// The batches of stored runs.
fn stored(results: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(results.join("runs")).into_iter().flatten();
    let files = entries.map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> =
        files.filter(|path| path.extension().is_some_and(|e| e == "parquet")).collect();
    files.sort();
    files
}

/// The known optimum of the paper's family over its task.
#[test]
fn a_motion_is_planned() {
    let said = text(&example("plan_a_motion").output().unwrap());
    assert!(said.contains("J 0.781849"), "{said}");
}

#[test]
fn a_race_is_run_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let said = text(&example("race").arg(folder.path()).output().unwrap());
    assert!(said.contains("cma-es") && folder.path().join("report.html").is_file(), "{said}");
}

/// Kills an example while it runs, has it go on, and reads its results with the command, which knows neither its
/// optimiser nor its problem. So many of the runs it can do itself.
fn survives(name: &str, runs: usize, possible: usize, label: &str) {
    let folder = tempfile::tempdir().unwrap();
    let results = folder.path().join("results");
    let path = results.to_str().unwrap();
    let mut first = example(name).arg(path).spawn().unwrap();
    while stored(&results).is_empty() {
        sleep(Duration::from_millis(1));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    let before = stored(&results);
    let dates: Vec<_> =
        before.iter().map(|file| fs::metadata(file).unwrap().modified().unwrap()).collect();
    let said = text(&example(name).arg(path).output().unwrap());
    assert!(said.contains(label), "{said}");
    for (file, date) in before.iter().zip(dates) {
        assert_eq!(fs::metadata(file).unwrap().modified().unwrap(), date, "done again");
    }
    assert_eq!(stored(&results).len(), runs);

    let said = text(&driftless(&["report", path]));
    assert!(said.contains(label), "{said}");
    assert!(fs::read_to_string(results.join("report.html")).unwrap().contains(label));
    let status = text(&driftless(&["status", "--json", path]));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert_eq!(
        (status["stored"].as_u64(), status["others"].as_u64()),
        (Some(runs as u64), Some(0))
    );
    for format in ["ioh", "coco"] {
        let out = folder.path().join(format);
        text(&driftless(&["export", path, "--format", format, "--out", out.to_str().unwrap()]));
        assert!(fs::read_dir(out).unwrap().count() > 0);
    }
    text(&driftless(&["compact", path]));
    assert_eq!(stored(&results).len(), 1);

    // What is there is known; what is missing the command cannot do, and says so.
    let experiment = results.join("experiment.toml");
    let experiment = experiment.to_str().unwrap();
    text(&driftless(&["run", experiment, "--out", path]));
    let elsewhere = folder.path().join("elsewhere");
    let refused = driftless(&["run", experiment, "--out", elsewhere.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(
        !refused.status.success() && said.contains("program that made these results"),
        "{said}"
    );
    let done = |folder: &Path| {
        let status = text(&driftless(&["status", "--json", folder.to_str().unwrap()]));
        serde_json::from_str::<serde_json::Value>(&status).unwrap()["stored"].as_u64().unwrap()
    };
    assert_eq!(if elsewhere.exists() { done(&elsewhere) } else { 0 }, possible as u64);

    // Nothing is deleted or rewritten that the command could not do again.
    let kept = fs::read(results.join("experiment.toml")).unwrap();
    if possible == 0 {
        assert!(!driftless(&["run", experiment, "--out", path, "--budget", "7"]).status.success());
    }
    text(&driftless(&["run", experiment, "--out", path, "--fresh"]));
    assert_eq!(done(&results), runs as u64);
    assert_eq!(fs::read(results.join("experiment.toml")).unwrap(), kept);
}

/// Five optimisers of the default experiment and one's own, five seeds each.
#[test]
fn an_optimiser_of_ones_own_is_run_killed_resumed_and_reported() {
    survives("own_optimiser", 30, 25, "hill-climb");
}

/// Three optimisers, fifteen seeds each.
#[test]
fn a_problem_of_ones_own_is_run_killed_resumed_and_reported() {
    survives("own_problem", 45, 0, "springs");
}
