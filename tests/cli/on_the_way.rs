//! What a task asks for on the way, in what `check` prints, in charts and on the page.

use crate::folder::{Folder, stderr, stdout};

/// Everything that a task may ask for.
const ALL: &str = r#"[task]
robot = "iiwa"
[task.limits]
base_turn_deg = 40
base_cone = [
    { axis = [1, 0, 0], from = [1, 0, 0], within_deg = 80 },
    { axis = [0, 0, 1], from = [0, 0, -1], outside_deg = 20 },
]
base_rate_deg_s = 5
tool_speed_m_s = 0.8
torque_n_m = [100, 100, 100, 100, 100, 50, 50]
[task.weights]
largest_turn = 0.001
mean_turn = 0.002
[task.keep_out.camera]
frame = "base"
shapes = [{ box = { centre = [-1.2, 0, 0], size = [0.2, 0.3, 0.4], zyx_deg = [10, 20, 30] } }]
[task.keep_out.debris]
shapes = [
    { sphere = { centre = [0, 0, 3], radius = 0.2 } },
    { capsule = { from = [0, 3, 0], to = [0, 3, 1], radius = 0.1 } },
    { cylinder = { from = [0, -3, 0], to = [0, -3, 1], radius = 0.1 } },
]
"#;

fn check(text: &str) -> String {
    let output = Folder::new().with("task.toml", text).run(&["check", "task.toml"]);
    assert!(output.status.success(), "{}", stderr(&output));
    stdout(&output)
}

/// What is left out is told: turns are measured from the nearer of start and goal, and what is kept out of is not touched.
#[test]
fn a_task_is_told_with_all_its_limits() {
    let told = check(ALL);
    for line in [
        "base_turn_deg = 40.0",
        r#"base_turn_from = "nearer""#,
        "outside_deg = 20.0",
        "base_rate_deg_s = 5.0",
        "tool_speed_m_s = 0.8",
        "torque_n_m = [100.0, 100.0, 100.0, 100.0, 100.0, 50.0, 50.0]",
        "clearance_m = 0.0",
        "largest_turn = 0.001",
        "mean_turn = 0.002",
        r#"frame = "inertial""#,
        "zyx_deg = [10.0, 20.0, 30.0]",
    ] {
        assert!(told.lines().any(|own| own == line), "no {line} in\n{told}");
    }
    assert_eq!(check(&told), told);
    assert!(!check("[task]\nrobot = 'iiwa'\n").contains("base_turn_from"));
}

/// Only a task with limits on the way has their chart, and its page their gauges.
#[cfg(feature = "harness")]
#[test]
fn limits_on_the_way_are_shown() {
    for (text, has_limits) in [(ALL, true), ("[task]\nrobot = 'iiwa'\n", false)] {
        let text = format!(
            "name = 'x'\nseeds = 1\nbudget = {{ evaluations = 5 }}\n{text}[[optimiser]]\nrandom = {{}}\n"
        );
        let folder = Folder::new().with("x.toml", text);
        let output = folder.run(&["run", "x.toml", "--out", "out"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let chart = folder.path().join("out/figures/on-the-way.svg");
        assert_eq!(chart.exists(), has_limits);
        let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert_eq!(page.contains("Path limits</"), has_limits);
    }
}
