//! What sweeps promise: every combination, under a name of its own, once.

use std::collections::BTreeMap;
use std::path::Path;

use crate::experiments::{run, single_rows};
use crate::folder::{Folder, stderr, stdout};

const SWEEPS: &str = "name = 'sweeps'\nseeds = 2\nbudget = { evaluations = 400 }\n[sweep]\n\
    jerk_limit_deg_s3 = [40, 80]\n\
    pose = [{ start = { joints_deg = [0, 0, 0, 0, 0, 0] } }, { goal = { base_zyx_deg = [1, 2, 3] } }]\n\
    [[optimiser]]\npso = { iterations = 10 }\nsweep = { population = [10, 20], social = [1, 2] }\n\
    [[optimiser]]\nhybrid = {}\nsweep = { search = { pso = { population = [10, 20] } } }\n\
    [[optimiser]]\nrandom = {}\nlabel = 'luck'\nseeds = 3\nbudget = { evaluations = 500 }\n";

/// The label of every run in a folder's table, with its number of runs.
fn labels(folder: &Path, column: &str) -> BTreeMap<String, usize> {
    let mut labels = BTreeMap::new();
    for runs in single_rows(folder) {
        let label = runs.column(column).unwrap().str().unwrap().get(0).unwrap();
        *labels.entry(label.to_owned()).or_default() += 1;
    }
    labels
}

/// Settings, poses and limits make one cross product; instances that differ in the pose alone are
/// summarised together; what an optimiser has of its own holds for it alone.
#[test]
fn sweeps_cover_poses_and_settings() {
    let folder = Folder::new().with("sweeps.toml", SWEEPS);
    let check = folder.run(&["check", "sweeps.toml"]);
    let text = stdout(&check);
    assert!(text.contains("# 60 runs: 4 instances × 7 optimisers × 2 to 3 seeds"), "{text}");
    assert!(text.lines().any(|line| line.starts_with("# about ")), "{text}");
    assert!(stderr(&check).contains("warning: budgets differ within the field"));
    let summary = run(&folder, &["sweeps.toml", "--out", "out"]);
    let found = labels(&folder.path().join("out/runs"), "optimiser");
    let pso = |settings: &str| (format!("pso/time-free {settings}"), 8);
    let hybrid = |settings: &str| (format!("pso+scp/time-free {settings}"), 8);
    let expected = [
        pso("population=10 iterations=10 social=1.0"),
        pso("population=20 iterations=10 social=1.0"),
        pso("population=10 iterations=10"),
        pso("population=20 iterations=10"),
        hybrid("population=10"),
        hybrid("population=20"),
        ("luck".to_owned(), 12),
    ];
    let shown: Vec<String> = found.keys().cloned().collect();
    assert_eq!(found, BTreeMap::from(expected), "{shown:?}");
    let rows = summary.lines().filter(|line| line.trim_start().starts_with("jerk_limit_deg_s3="));
    assert_eq!(rows.count(), 14, "{summary}");
    assert!(!summary.contains("=40 pose=1  "), "{summary}");
    let instances = labels(&folder.path().join("out/runs"), "instance");
    let expected = ["40 pose=1", "40 pose=2", "80 pose=1", "80 pose=2"];
    assert_eq!(
        instances,
        BTreeMap::from(expected.map(|label| (format!("jerk_limit_deg_s3={label}"), 15)))
    );
    // The resolved file is the same experiment: there is nothing left to do.
    let output = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
    assert!(stderr(&output).contains("60 of 60 runs are stored already"), "{}", stderr(&output));
    assert_eq!(stdout(&output), summary);
    // One budget and one number of seeds for all, from the command line.
    run(&folder, &["sweeps.toml", "--out", "short", "--budget", "50", "--seeds", "1"]);
    let short = single_rows(&folder.path().join("short/runs"));
    let budgets = short.iter().map(|runs| runs.column("budget").unwrap().u64().unwrap().get(0));
    assert_eq!(budgets.collect::<Vec<_>>(), [Some(50); 28]);
}

/// A sweep of budgets; without weight on the base, or on time, there is still something to search.
#[test]
fn sweeps_cover_budgets_and_extreme_weights() {
    let text = "name = 'x'\nseeds = 1\n[sweep]\nweight_base = [0, 1]\nbudget = [30, 60]\n\
        random_poses = { count = 2, seed = 3 }\n[[optimiser]]\nscp = {}\n[[optimiser]]\nde = {}\n";
    let folder = Folder::new().with("x.toml", text);
    run(&folder, &["x.toml", "--out", "out"]);
    let runs = single_rows(&folder.path().join("out/runs"));
    assert_eq!(runs.len(), 16);
    for row in runs {
        let budget = row.column("budget").unwrap().u64().unwrap().get(0).unwrap();
        let instance = row.column("instance").unwrap().str().unwrap().get(0).unwrap();
        assert!(instance.contains(&format!("budget={budget} pose=")), "{instance}");
        assert_eq!(row.column("evaluations").unwrap().u64().unwrap().get(0), Some(budget));
        assert!(row.column("certified_j").unwrap().f64().unwrap().get(0).unwrap() >= 0.0);
    }
    let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
    assert!(stderr(&again).contains("16 of 16 runs are stored already"), "{}", stderr(&again));
}

/// The folder's stored runs, and the values of a column by instance.
fn values(folder: &Path, column: &str) -> BTreeMap<String, Option<f64>> {
    let runs = single_rows(folder).into_iter().map(|runs| {
        let instance = runs.column("instance").unwrap().str().unwrap().get(0).unwrap().to_owned();
        (instance, runs.column(column).unwrap().f64().unwrap().get(0))
    });
    runs.collect()
}

/// Every setting of the way is swept, is stored with its runs, and changes the recipe of a run.
#[test]
fn sweeps_cover_limits_on_the_way() {
    for (key, values_of_key, column) in [
        ("base_turn_deg", [20.0, 40.0], "base_turn_limit_deg"),
        ("base_cone_deg", [60.0, 90.0], "base_cone_deg"),
        ("base_rate_deg_s", [1.5, 3.0], "base_rate_limit_deg_s"),
        ("tool_speed_m_s", [0.25, 0.5], "tool_speed_limit_m_s"),
        ("torque_n_m", [5.0, 10.0], "torque_limit_n_m"),
        ("clearance_m", [0.0, 0.01], "clearance_limit_m"),
        ("weight_largest_turn", [0.01, 0.02], "weight_largest_turn"),
        ("weight_mean_turn", [0.01, 0.02], "weight_mean_turn"),
    ] {
        let [low, high] = values_of_key;
        let cone = if key == "base_cone_deg" {
            "[task.limits]\nbase_cone = { axis = [1, 0, 0], from = [1, 0, 0], within_deg = 80 }\n"
        } else {
            ""
        };
        let text = format!(
            "name = 'x'\nseeds = 1\nbudget = {{ evaluations = 5 }}\n{cone}\
             [sweep]\n{key} = [{low}, {high}]\n[[optimiser]]\nrandom = {{}}\n"
        );
        let folder = Folder::new().with("x.toml", text);
        run(&folder, &["x.toml", "--out", "out"]);
        let runs = folder.path().join("out/runs");
        let expected = values_of_key.map(|value| (format!("{key}={value}"), Some(value)));
        assert_eq!(values(&runs, column), BTreeMap::from(expected), "{key}");
        assert!(values(&runs, "largest_base_turn_deg").values().all(|turn| *turn > Some(0.0)));
        assert!(values(&runs, "path_excess").values().all(|excess| *excess >= Some(0.0)));
    }
}

/// What a task does not ask for is not worked out, and says nothing.
#[test]
fn nothing_on_the_way_is_told_where_nothing_is_asked_for() {
    let text = "name = 'x'\nseeds = 1\nbudget = { evaluations = 5 }\n[[optimiser]]\nrandom = {}\n";
    let folder = Folder::new().with("x.toml", text);
    run(&folder, &["x.toml", "--out", "out"]);
    let runs = folder.path().join("out/runs");
    for column in ["base_turn_limit_deg", "largest_base_turn_deg", "clearance_m", "path_excess"] {
        assert_eq!(values(&runs, column), BTreeMap::from([(String::new(), None)]), "{column}");
    }
    let best = std::fs::read_to_string(folder.path().join("out/tables/best.csv")).unwrap();
    assert!(!best.contains("base_turn_limit_deg"), "{best}");
}
