//! Experiments over splines: they run, resume, report, export and replay.

use std::fs;

use crate::experiments::{run, single_rows};
use crate::folder::{Folder, stderr, stdout};

const SPLINES: &str = "name = 'splines'\nseeds = 2\nbudget = { evaluations = 60 }\n[trajectory.box]\nduration = [2, 20]\n\
    [sweep]\nfamily = ['sine-polynomial', 'spline']\nterms = [2]\npieces = [4, 6]\ndegree = [3]\n\
    [[optimiser]]\nscp = { starts = 1 }\n[[optimiser]]\nde = { population = 10, formulation = 'scaled' }\n";

/// Sizes are swept for the instances of their own family alone, and are null for others.
#[test]
fn families_and_sizes_are_swept() {
    let folder = Folder::new().with("splines.toml", SPLINES);
    run(&folder, &["splines.toml", "--out", "out"]);
    let mut found = Vec::new();
    for row in single_rows(&folder.path().join("out/runs")) {
        let text = |name: &str| row.column(name).unwrap().str().unwrap().get(0).map(str::to_owned);
        let count = |name: &str| row.column(name).unwrap().u64().unwrap().get(0);
        let coefficients = row.column("coefficients").unwrap().list().unwrap().get_as_series(0);
        found.push((
            text("instance").unwrap(),
            text("family").unwrap(),
            [count("terms"), count("pieces"), count("degree")],
            coefficients.unwrap().len(),
        ));
    }
    found.sort();
    found.dedup();
    let expected = [
        ("family=sine-polynomial terms=2", "sine-polynomial", [Some(2), None, None], 12),
        ("family=spline pieces=4 degree=3", "spline", [None, Some(4), Some(3)], 6),
        ("family=spline pieces=6 degree=3", "spline", [None, Some(6), Some(3)], 18),
    ];
    let expected = expected.map(|(i, f, sizes, n)| (i.to_owned(), f.to_owned(), sizes, n));
    assert_eq!(found, expected);
    let best = fs::read_to_string(folder.path().join("out/tables/best.csv")).unwrap();
    assert!(best.lines().next().unwrap().contains(",family,terms,pieces,degree,"), "{best}");
    let dimensions = fs::read_to_string(folder.path().join("out/tables/dimensions.csv")).unwrap();
    assert!(dimensions.contains("\nspline degree = 3,scp/time-free,7,"), "{dimensions}");
    assert!(dimensions.contains("\nspline degree = 3,de/scaled,19,"), "{dimensions}");
    assert!(!dimensions.contains("sine-polynomial"), "{dimensions}");
    for chart in ["dimensions", "pieces-sweep"] {
        assert!(folder.path().join(format!("out/figures/{chart}.svg")).exists(), "{chart}");
    }
}

/// What stands in the folder of results runs again, and nothing is done twice.
#[test]
fn experiments_over_splines_resume() {
    let folder = Folder::new().with("splines.toml", SPLINES);
    run(&folder, &["splines.toml", "--out", "out", "--shard", "0/2"]);
    run(&folder, &["splines.toml", "--out", "out"]);
    let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
    assert!(stderr(&again).contains("12 of 12 runs are stored already"), "{}", stderr(&again));
    run(&folder, &["out/experiment.toml", "--out", "other", "--jobs", "1"]);
    let costs = |out: &str| {
        let rows = single_rows(&folder.path().join(out).join("runs"));
        let cell = |row: &polars::prelude::DataFrame| {
            let key = row.column("key").unwrap().str().unwrap().get(0).unwrap().to_owned();
            (key, row.column("certified_j").unwrap().f64().unwrap().get(0).unwrap().to_bits())
        };
        let mut costs: Vec<_> = rows.iter().map(cell).collect();
        costs.sort();
        costs
    };
    assert_eq!(costs("out"), costs("other"));
}

/// A stored motion, written down as `plan --json` and the table `runs` have it, is evaluated to the same bits.
#[test]
fn motions_of_runs_replay_and_are_exported() {
    let text = "name = 'one'\nseeds = 1\nbudget = { evaluations = 400 }\n\
        [trajectory]\nfamily = 'spline'\npieces = 6\ndegree = 5\n[[optimiser]]\npso = { population = 20 }\n";
    let folder = Folder::new().with("one.toml", text);
    run(&folder, &["one.toml", "--out", "out"]);
    let rows = single_rows(&folder.path().join("out/runs"));
    let real = |name: &str| rows[0].column(name).unwrap().f64().unwrap().get(0).unwrap();
    let list = rows[0].column("coefficients").unwrap().list().unwrap().get_as_series(0).unwrap();
    let coefficients: Vec<f64> = list.f64().unwrap().into_no_null_iter().collect();
    let motion = format!(
        "[trajectory]\nfamily = 'spline'\ndegree = 5\n[motion]\nt_f = {:?}\ncoefficients = {:?}\n",
        real("t_f"),
        coefficients.chunks(5).collect::<Vec<_>>()
    );
    let folder = folder.with("motion.toml", motion);
    let output = folder.run(&["replay", "motion.toml", "--json", "--motion", "replayed.csv"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let replay: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let [physics] = &replay["readings"].as_array().unwrap()[..] else {
        panic!("the paper's reading is of its own family")
    };
    assert_eq!(physics["residual_deg"].as_f64().unwrap().to_bits(), real("residual_deg").to_bits());
    assert_eq!(physics["t_f"].as_f64().unwrap().to_bits(), real("t_f").to_bits());
    assert!(replay["published"].get("alpha6").is_none());
    let checked = folder.run(&["check", "motion.toml"]);
    assert!(stdout(&checked).contains("pieces = 6\n"), "{}", stdout(&checked));
    for format in ["csv", "parquet", "yaml"] {
        let output = folder.run(&["export", "out", "--format", format, "--out", format]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(folder.path().join(format!("{format}/best.{format}")).exists());
    }
    let read = |file: &str| fs::read(folder.path().join(file)).unwrap();
    assert!(read("csv/best.csv") == read("replayed.csv"));
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("snapshots"));
}

/// Robots with another number of joints do with random poses, and are kept with the results.
#[test]
fn robots_are_instances() {
    let arm = |joints: usize| {
        let robot = include_str!("../../src/robot/shipped/xiao2023.toml");
        let parts: Vec<&str> = robot.split("[[joint]]").take(joints + 1).collect();
        parts.join("[[joint]]")
    };
    let text = "name = 'robots'\nseeds = 1\nbudget = { evaluations = 20 }\n\
        task.limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n[sweep]\n\
        robot = ['xiao2023', 'arms/five.toml', 'arms/three.toml']\nrandom_poses = { count = 2 }\n\
        [[optimiser]]\nrandom = {}\n";
    let folder = Folder::new().with("robots.toml", text);
    fs::create_dir(folder.path().join("arms")).unwrap();
    let folder = folder.with("arms/five.toml", arm(5)).with("arms/three.toml", arm(3));
    run(&folder, &["robots.toml", "--out", "out"]);
    fs::remove_dir_all(folder.path().join("arms")).unwrap();
    let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
    assert!(stderr(&again).contains("6 of 6 runs are stored already"), "{}", stderr(&again));
    let mut labels: Vec<String> = single_rows(&folder.path().join("out/runs"))
        .iter()
        .map(|row| row.column("instance").unwrap().str().unwrap().get(0).unwrap().to_owned())
        .collect();
    labels.sort();
    let robots = ["five", "three", "xiao2023"];
    let expected = robots.map(|robot| [1, 2].map(|pose| format!("robot={robot} pose={pose}")));
    assert_eq!(labels, expected.concat());
}

/// Files of tasks are instances, too, each with its own robot.
#[test]
fn tasks_are_instances() {
    let robot = include_str!("../../src/robot/shipped/xiao2023.toml");
    let three: Vec<&str> = robot.split("[[joint]]").take(4).collect();
    let task = "[task]\nrobot = 'three.toml'\n\
        start = { joints_deg = [0, 0, 0], base_zyx_deg = [6, 15, 7] }\n\
        goal = { joints_deg = [10, 20, 30], base_zyx_deg = [0, 0, 0] }\n\
        limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";
    let text = "name = 'tasks'\nseeds = 1\nbudget = { evaluations = 20 }\n\
        [sweep]\ntask = ['hold.toml', 'own/small.toml']\n[[optimiser]]\nrandom = {}\n";
    let folder = Folder::new().with("tasks.toml", text).with("hold.toml", "[task]\n");
    fs::create_dir(folder.path().join("own")).unwrap();
    let folder =
        folder.with("own/three.toml", three.join("[[joint]]")).with("own/small.toml", task);
    run(&folder, &["tasks.toml", "--out", "out"]);
    fs::remove_dir_all(folder.path().join("own")).unwrap();
    let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
    assert!(stderr(&again).contains("2 of 2 runs are stored already"), "{}", stderr(&again));
    let best = fs::read_to_string(folder.path().join("out/tables/best.csv")).unwrap();
    assert!(best.contains("\ntask=hold,") && best.contains("\ntask=small,"), "{best}");
}
