//! `--json`: every object that a verb prints can be read, and says what the text says.

#[cfg(feature = "harness")]
use std::collections::BTreeSet;

use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};

fn json(folder: &Folder, args: &[&str]) -> Value {
    let output = folder.run(&[args, &["--json"]].concat());
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

/// The names of an object's fields, as `docs/reference/json-verbs.md` has them.
#[cfg(feature = "harness")]
fn fields(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

#[test]
fn list_and_check_print_objects() {
    let folder = Folder::new().with("task.toml", "[task]\nrobot = 'ur5e'\n");
    let list = json(&folder, &["list"]);
    let names = |key: &str| -> Vec<&str> {
        list[key].as_array().unwrap().iter().map(|own| own["name"].as_str().unwrap()).collect()
    };
    assert!(names("optimisers").contains(&"scp") && names("functions").contains(&"sphere"));
    assert!(names("robots").contains(&"canadarm2"));
    // Xiao et al. have two coefficients for each of six joints, and the duration.
    let raw = &list["formulations"][0];
    assert_eq!((&raw["formulation"], &raw["variables"]), (&"raw".into(), &13.into()));

    let robot = json(&folder, &["check", "ur5e"]);
    assert_eq!((&robot["kind"], &robot["joints"]), (&"robot".into(), &6.into()));
    assert_eq!(robot["resolved"]["name"], "ur5e");
    let task = json(&folder, &["check", "task.toml"]);
    assert_eq!((&task["kind"], &task["robot"]), (&"task".into(), &"ur5e".into()));
    assert!(task["resolved"]["task"]["limits"].is_object(), "{task}");

    let urdf = json(&folder, &["robot", "convert", "ur5e"]);
    assert!(urdf["format"] == "urdf" && urdf["file"].is_null());
    assert!(urdf["text"].as_str().unwrap().contains("<robot"), "{urdf}");
    let urdf = json(&folder, &["robot", "convert", "ur5e", "--out", "ur5e.urdf"]);
    assert!(urdf["file"] == "ur5e.urdf" && urdf["text"].is_null());
}

#[cfg(feature = "harness")]
#[test]
fn verbs_of_results_print_objects() {
    let small = "name = 'small'\nseeds = 3\nbudget = { evaluations = 100 }\n\
        functions = { name = ['sphere'], dimension = [2] }\n[[optimiser]]\nrandom = {}\n[[optimiser]]\npso = {}\n";
    let folder = Folder::new().with("small.toml", small);
    let checked = json(&folder, &["check", "small.toml", "--no-estimate"]);
    assert_eq!((&checked["runs"], &checked["seeds"]), (&6.into(), &serde_json::json!([3, 3])));
    assert_eq!(checked["resolved"]["budget"]["evaluations"], 100);
    let shard = json(&folder, &["run", "small.toml", "--out", "out", "--shard", "0/2"]);
    assert_eq!((&shard["shard"], &shard["shard_runs"]), (&"0/2".into(), &3.into()));
    let run = json(&folder, &["run", "small.toml", "--out", "out"]);
    let report = json(&folder, &["report", "out"]);
    assert_eq!(run, report);
    assert_eq!((&report["stored"], &report["failed"]), (&6.into(), &0.into()));
    assert!(!report["findings"].as_array().unwrap().is_empty());
    for key in ["tables", "figures"] {
        for file in report[key].as_array().unwrap() {
            assert!(folder.path().join(file.as_str().unwrap()).is_file(), "{file}");
        }
    }
    assert_eq!(
        fields(&report),
        BTreeSet::from([
            "experiment",
            "runs",
            "stored",
            "failed",
            "page",
            "is_written",
            "tables",
            "figures",
            "lines",
            "findings",
        ])
    );
    let compact = json(&folder, &["compact", "out"]);
    assert!(compact["merged"] == true && compact["files_after"].is_u64(), "{compact}");
    let export = json(&folder, &["export", "out", "--format", "ioh", "--out", "ioh"]);
    assert_eq!((&export["runs"], &export["functions"]), (&6.into(), &1.into()));
    let import = json(&folder, &["import", "ioh", "--format", "ioh", "--out", "imported"]);
    assert_eq!((&import["runs"], &import["optimisers"]), (&6.into(), &2.into()));
    let submit = json(&folder, &["submit", "small.toml", "--to", "slurm", "--shards", "2"]);
    assert_eq!((&submit["scheduler"], &submit["shards"]), (&"sbatch".into(), &2.into()));
    assert!(submit["job"].as_str().unwrap().contains("--array 0-1"), "{submit}");
}

/// A report draws the charts asked for, with the axes and colours asked for.
#[cfg(feature = "harness")]
#[test]
fn charts_are_drawn_as_asked() {
    let small = "name = 'small'\nseeds = 3\nbudget = { evaluations = 300 }\n\
        functions = { name = ['sphere'], dimension = [2] }\n[[optimiser]]\nrandom = {}\n[[optimiser]]\npso = {}\n";
    let folder = Folder::new().with("small.toml", small).with("own.txt", "#112233\n#445566\n");
    assert!(folder.run(&["run", "small.toml", "--out", "out"]).status.success());
    let svg = |out: &str, options: &[&str]| {
        let args = ["report", "out", "--out", out, "--charts", "convergence"];
        let output = folder.run(&[&args, options].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let figures = folder.path().join(out).join("figures");
        assert_eq!(std::fs::read_dir(&figures).unwrap().count(), 3);
        std::fs::read_to_string(figures.join("convergence.svg")).unwrap().to_lowercase()
    };
    let plain = svg("plain", &[]);
    // `pso` is the sixth kind of optimisers: Okabe and Ito's sky blue.
    assert!(plain.contains("#56b4e9") && !plain.contains("#112233"));
    assert_ne!(svg("linear", &["--linear"]), plain);
    assert_ne!(svg("linear_y", &["--linear=y"]), svg("linear_x", &["--linear=x"]));
    for colours in ["own.txt", "#112233,#445566"] {
        let own = svg("own", &["--colours", colours]);
        // By kind `random` is grey and `pso` blue; in the order of the file they are the first and the second.
        let count = |text: &str, colour: &str| text.matches(colour).count();
        assert_eq!(count(&own, "#112233"), count(&plain, "#8c8c8c"));
        assert_eq!(count(&own, "#445566"), count(&plain, "#56b4e9"));
        assert!(!own.contains("#56b4e9"), "{colours}");
    }
    assert!(svg("tol", &["--colours", "tol-bright"]).contains("#ee6677"));
    for (options, expected) in [
        (
            ["--charts", "pareto"],
            "no chart `pareto` of these results, expected some of convergence, ",
        ),
        (["--colours", "red"], "expected okabe-ito, tol-bright, grey"),
        (["--colours", "#12"], "found `#12`, expected a colour such as #0072B2"),
        (["--charts", ""], "no chart ``"),
    ] {
        let output = folder.run(&[&["report", "out", "--out", "wrong"], &options[..]].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        let message = stderr(&output).replace("\n  │ ", " ").replace('\n', " ");
        assert!(message.contains(expected), "{message}");
        assert!(!folder.path().join("wrong/report.html").exists());
    }
}
