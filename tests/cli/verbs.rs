//! What the verbs promise.

use crate::folder::{Folder, stderr, stdout};
use driftless::lanes::Width;
use serde_json::Value;

fn json(folder: &Folder, args: &[&str]) -> Value {
    let output = folder.run(args);
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_str(&stdout(&output)).unwrap()
}

fn near(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().unwrap();
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

/// The paper's claim: J* = 3.223. What the motion gives as physics: Pinocchio, in
/// `reference/xiao2023.json`; as published: an independent computation in Python.
#[test]
fn replay_gives_both_readings() {
    let replay = json(&Folder::new(), &["replay", "--json"]);
    near(&replay["published"]["t_f"], 6.3304, 0.0);
    near(&replay["published"]["j"], 3.223, 0.0);
    near(&replay["published"]["alpha6"][5], 9.9397e-5, 1e-17);
    near(&replay["published"]["alpha7"][0], -1.1520e-5, 1e-17);
    let [physics, published] = &replay["readings"].as_array().unwrap()[..] else {
        panic!("expected two readings")
    };
    assert_eq!(physics["reading"], "physics");
    near(&physics["residual_deg"], 13.2907, 0.001);
    near(&physics["peaks"]["jerk_deg_s3"][3], 80.6665, 0.0005);
    assert_eq!(published["reading"], "as-published");
    near(&published["residual_deg"], 2.049, 0.003);
    near(&published["penalty"], 0.752, 0.001);
    near(&published["j"], 3.230, 0.004);
}

#[test]
fn replay_reads_what_plan_found() {
    let folder = Folder::new();
    let plan =
        json(&folder, &["plan", "--json", "--optimiser", "pso", "--budget", "3000", "--seed", "4"]);
    let text =
        format!("[motion]\nt_f = {}\ncoefficients = {}\n", plan["t_f"], plan["coefficients"]);
    let replay = json(&folder.with("motion.toml", text), &["replay", "motion.toml", "--json"]);
    near(&replay["readings"][0]["j"], plan["j"].as_f64().unwrap(), 1e-9);
    near(&replay["readings"][0]["residual_deg"], plan["residual_deg"].as_f64().unwrap(), 1e-9);
}

/// A robot that stands at its goal has nothing to do; beyond the goal's tolerance, or with a joint elsewhere, it has.
#[test]
fn plan_says_where_nothing_is_to_be_done() {
    let joints = "joints_deg = [0, 10, 20, 30, 40, 50]\n";
    let task = |turn: &str, goal: &str| {
        format!("[task.start]\n{joints}base_zyx_deg = [{turn}, 0, 0]\n[task.goal]\n{goal}")
    };
    let folder = Folder::new()
        .with("there.toml", task("5e-4", joints))
        .with("turned.toml", task("0.5", joints))
        .with("moved.toml", task("0", "joints_deg = [0, 10, 20, 30, 40, 51]\n"));
    let output = folder.run(&["plan", "there.toml"]);
    assert!(output.status.success() && stdout(&output).contains("already there"));
    let there = json(&folder, &["plan", "there.toml", "--json"]);
    assert_eq!((&there["already_there"], &there["status"]), (&true.into(), &"reached".into()));
    near(&there["residual_deg"], 5e-4, 1e-12);
    for file in ["turned.toml", "moved.toml"] {
        let plan = json(&folder, &["plan", file, "--pieces", "10", "--json"]);
        assert!(plan["already_there"].is_null() && plan["t_f"].as_f64().unwrap() > 0.1, "{plan}");
    }
}

/// A task with nothing to do and one that cannot be done in finite time are no reason to panic.
#[test]
fn plan_survives_degenerate_tasks() {
    let still = "[task.start]\njoints_deg = [0, 0, 0, 0, 0, 0]\nbase_zyx_deg = [0, 0, 0]\n\
                 [task.goal]\njoints_deg = [0, 0, 0, 0, 0, 0]\n";
    let stuck = "[task.limits]\nrate_deg_s = 1e-308\n";
    for (text, code) in [(still, 0), (stuck, 2)] {
        for optimiser in ["scp", "pso"] {
            let folder = Folder::new().with("task.toml", text);
            let args = ["plan", "task.toml", "--optimiser", optimiser, "--budget", "300"];
            let output = folder.run(&args);
            assert_eq!(output.status.code(), Some(code), "{optimiser}: {}", stderr(&output));
        }
    }
}

#[test]
fn plan_promises_its_fields() {
    let folder = Folder::new();
    let plan = json(
        &folder,
        &["plan", "--optimiser", "random", "--seed", "7", "--budget", "500", "--json"],
    );
    let keys: Vec<&str> = plan.as_object().unwrap().keys().map(String::as_str).collect();
    insta::assert_snapshot!("plan_fields", keys.join("\n"));
    assert_eq!(plan["evaluations"], 500);
    assert_eq!(plan["coefficients"].as_array().unwrap().len(), 6);
    let again = json(
        &folder,
        &["plan", "--optimiser", "random", "--seed", "7", "--budget", "500", "--json"],
    );
    assert_eq!(plan["coefficients"], again["coefficients"]);
}

/// 5.6150 s: see `tests/splines.rs`.
#[test]
fn plan_finds_free_form_motions() {
    let folder = Folder::new();
    let args = ["plan", "--family", "spline", "--pieces", "20", "--degree", "3", "--json"];
    let plan = json(&folder, &args);
    assert_eq!(
        (&plan["family"], &plan["pieces"], &plan["degree"]),
        (&"spline".into(), &20.into(), &3.into())
    );
    assert!(plan.get("terms").is_none() && plan["best_known_j"].is_null());
    assert!(plan["t_f"].as_f64().unwrap() <= 5.6363, "{}", plan["t_f"]);
    assert!(plan["residual_deg"].as_f64().unwrap() < 1e-6, "{}", plan["residual_deg"]);
    let rows = plan["coefficients"].as_array().unwrap();
    assert_eq!((rows.len(), rows[0].as_array().unwrap().len()), (6, 17));
    let output = folder.run(&["plan", "--pieces", "20", "--family", "sine-polynomial"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--family spline"), "{}", stderr(&output));
}

/// Without a family, splines of degree 4 and 80 pieces: faster than the best of degree 3 and 40, 5.61012 s. Sine
/// polynomials, of which 7.81849 s are the best known, are for comparison, and for the file that names them.
#[test]
fn plan_is_free_form_unless_told_otherwise() {
    let folder = Folder::new().with("three.toml", "[trajectory]\nterms = 3\n");
    let plan = json(&folder, &["plan", "--json"]);
    assert_eq!(
        (&plan["family"], &plan["pieces"], &plan["degree"]),
        (&"spline".into(), &80.into(), &4.into())
    );
    assert!(plan["t_f"].as_f64().unwrap() < 5.6101, "{}", plan["t_f"]);
    assert_eq!(plan["status"], "reached");
    near(&plan["tolerance_deg"], 0.001, 1e-15);
    let other = &plan["sine_polynomial"];
    assert_eq!((&other["terms"], &other["status"]), (&2.into(), &"reached".into()));
    assert!(other["t_f"].as_f64().unwrap() > 7.8184, "{other}");
    let three = json(&folder, &["plan", "three.toml", "--json", "--budget", "300"]);
    assert_eq!((&three["family"], &three["terms"]), (&"sine-polynomial".into(), &3.into()));
    assert!(three["sine_polynomial"].is_null());
}

/// A goal that is out of reach is said to be, and so is one that a wider tolerance takes in.
#[test]
fn plan_says_whether_the_goal_is_reached() {
    let robot = include_str!("../../src/robot/shipped/xiao2023.toml");
    let one: Vec<&str> = robot.split("[[joint]]").take(2).collect();
    let task = "[task]\nrobot = 'one.toml'\n\
        start = { joints_deg = [10], base_zyx_deg = [6, 15, 7] }\n\
        limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n\
        [task.goal]\njoints_deg = [40]\nbase_zyx_deg = [0, 0, 0]\n";
    let folder = Folder::new()
        .with("one.toml", one.join("[[joint]]"))
        .with("task.toml", task)
        .with("wide.toml", format!("{task}tolerance_deg = 30\n"))
        .with("start.toml", "[task.start]\ntolerance_deg = 1\n");
    let plan = json(&folder, &["plan", "task.toml", "--json"]);
    assert_eq!(plan["status"], "out-of-reach");
    assert!(plan["residual_deg"].as_f64().unwrap() > 1.0 && plan["least_time"].is_null());
    let output = folder.run(&["plan", "task.toml"]);
    assert!(stderr(&output).contains("however they go there"), "{}", stderr(&output));
    assert!(!stderr(&output).contains("--seed"), "{}", stderr(&output));
    let wide = json(&folder, &["plan", "wide.toml", "--json"]);
    assert_eq!(wide["status"], "reached");
    for (plan, is_reached) in [(&plan, false), (&wide, true)] {
        assert_eq!((&plan["reached"], &plan["within_limits"]), (&is_reached.into(), &true.into()));
    }
    for (file, code) in [("task.toml", 3), ("wide.toml", 0)] {
        let output = folder.run(&["plan", file, "--require"]);
        assert_eq!(output.status.code(), Some(code), "{}", stderr(&output));
        assert!(stdout(&output).contains("the goal (within"), "{}", stdout(&output));
    }
    near(&wide["tolerance_deg"], 30.0, 1e-12);
    // The goal is a demand, whatever it weighs, and the cost that is told is the task's own: here the duration.
    let folder = folder.with("weightless.toml", "[task.weights]\nbase = 0\n");
    let weightless = json(&folder, &["plan", "weightless.toml", "--pieces", "20", "--json"]);
    assert_eq!(weightless["status"], "reached");
    near(&weightless["j"], weightless["t_f"].as_f64().unwrap(), 1e-9);
    let output = folder.run(&["plan", "start.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("goal alone"), "{}", stderr(&output));
}

/// 0.7818485825 is the entry for the paper's task in `results/best-known.toml`.
#[test]
fn plan_compares_with_the_best_known() {
    let folder = Folder::new().with("other.toml", "[task.weights]\nbase = 0.5\n");
    let args = ["plan", "--optimiser", "random", "--budget", "50"];
    let plan = json(&folder, &[&args[..], &["--json"]].concat());
    near(&plan["best_known_j"], 0.781_848_582_5, 0.0);
    let output = folder.run(&[&args[..], &["--entry"]].concat());
    let percent = 100.0 * (plan["j"].as_f64().unwrap() / 0.781_848_582_5 - 1.0);
    assert!(stdout(&output).contains(&format!("{percent:.0} % above the best known, 0.781849")));
    let entry = stderr(&output);
    assert!(entry.contains("[[motion]]") && entry.contains("[motion.task.limits]"), "{entry}");
    assert!(!entry.contains("below the best known"), "{entry}");
    let other = [&args[..], &["other.toml"]].concat();
    assert!(json(&folder, &[&other[..], &["--json"]].concat())["best_known_j"].is_null());
    let output = folder.run(&other);
    assert!(!stdout(&output).contains("best known") && !stderr(&output).contains("[[motion]]"));
}

/// Any arm: three joints, another mount, limits of their own, four terms.
#[test]
fn plan_takes_another_robot() {
    let link =
        "mass = 4\ncentre_of_mass = [0, 0, 0.2]\ninertia = { xx = 0.1, yy = 0.1, zz = 0.02 }\n";
    let joint = |alpha: i32| {
        format!(
            "[[joint]]\ndh = {{ d = 0.4, a = 0.1, alpha_deg = {alpha} }}\nrange_deg = [-170, 170]\n{link}"
        )
    };
    let arm = format!(
        "name = 'small'\n[base]\nmass = 50\nmount = [0, 0, 0.5]\nmount_zyx_deg = [0, 90, 0]\n\
         inertia = {{ xx = 5, yy = 5, zz = 5 }}\n{}{}{}",
        joint(90),
        joint(-90),
        joint(0)
    );
    let task = "[task]\nrobot = 'arm.toml'\n[task.start]\njoints_deg = [0, 0, 0]\nbase_zyx_deg = [3, 0, -4]\n\
                [task.goal]\njoints_deg = [0, 0, 0]\nbase_zyx_deg = [0, 0, 0]\n\
                [task.limits]\nrate_deg_s = [30, 20, 40]\nacceleration_deg_s2 = 70\njerk_deg_s3 = 80\n\
                [trajectory]\nterms = 4\n";
    let folder = Folder::new().with("arm.toml", arm).with("task.toml", task);
    let plan = json(&folder, &["plan", "task.toml", "--json", "--budget", "6000"]);
    assert_eq!(plan["peaks"]["rate_deg_s"].as_array().unwrap().len(), 3);
    assert_eq!(plan["coefficients"][0].as_array().unwrap().len(), 4);
    assert!(plan.get("alpha6").is_none());
    assert!(plan["residual_deg"].as_f64().unwrap() < 5.0, "no better than doing nothing");
    for (rate, limit) in
        plan["peaks"]["rate_deg_s"].as_array().unwrap().iter().zip([30.0, 20.0, 40.0])
    {
        assert!(rate.as_f64().unwrap() <= limit * (1.0 + 1e-6));
    }
}

/// A base of 90 t: ending a degree nearer costs more time than it gains. That is said, and the weight that is advised brings it there.
#[test]
fn a_weight_that_is_too_small_is_told() {
    let robot = include_str!("../../src/robot/shipped/xiao2023.toml").replacen(
        "mass = 600",
        "mass = 90000",
        1,
    );
    let inertia = "xx = 75, yy = 74, zz = 74, xy = 0.25, xz = 0.32, yz = 0.19";
    let robot = robot.replacen(inertia, "xx = 11250, yy = 11100, zz = 11100", 1);
    let task = "[task]\nrobot = 'heavy.toml'\n\
        start = { joints_deg = [10, 30, 45, -20, -25, 40], base_zyx_deg = [0.5, 0, 0] }\n\
        goal = { joints_deg = [40, 60, 90, -10, -30, 60], base_zyx_deg = [0, 0, 0] }\n\
        limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";
    let folder = Folder::new()
        .with("heavy.toml", robot)
        .with("task.toml", task)
        .with("weighed.toml", format!("{task}weights.base = 0.9999\n"))
        .with("untimed.toml", "[task]\nweights.base = 1\n");
    let output = folder.run(&["plan", "task.toml", "--family", "sine-polynomial"]);
    assert!(stdout(&output).contains("not stated     weights.base"), "{}", stdout(&output));
    assert!(stderr(&output).contains("Raise `weights.base` above 0.9"), "{}", stderr(&output));
    assert!(!stderr(&output).contains("more terms"), "{}", stderr(&output));
    // Of a search that was cut off it is not known whether its end would have been nearer.
    let cut_off = ["plan", "task.toml", "--optimiser", "random", "--budget", "200"];
    let cut_off = stderr(&folder.run(&cut_off));
    assert!(cut_off.contains("a larger budget") && !cut_off.contains("Raise"), "{cut_off}");
    let untimed = ["plan", "untimed.toml", "--optimiser", "random", "--budget", "200"];
    let untimed = stderr(&folder.run(&untimed));
    assert!(untimed.contains("time weighs nothing"), "{untimed}");
    let plan = json(&folder, &["plan", "weighed.toml", "--family", "sine-polynomial", "--json"]);
    assert_eq!((&plan["reached"], &plan["inherited"]), (&true.into(), &serde_json::json!([])));
}

#[test]
fn motions_are_written() {
    let folder = Folder::new();
    for file in ["motion.csv", "motion.yaml"] {
        assert!(folder.run(&["replay", "--motion", file]).status.success());
    }
    let csv = std::fs::read_to_string(folder.path().join("motion.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 501 * 6);
    assert!(csv.starts_with(
        "time,joint,angle,rate,acceleration,jerk,base_w,base_x,base_y,base_z,torque,base_yaw,base_pitch,base_roll,base_position_x,\
         base_position_y,base_position_z,base_rate_x,base_rate_y,base_rate_z\n0.0,joint1,"
    ));
    let yaml = std::fs::read_to_string(folder.path().join("motion.yaml")).unwrap();
    let list = |line: &str, key: &str| -> Vec<serde_json::Value> {
        serde_json::from_str(line.trim_start().strip_prefix(key).unwrap()).unwrap()
    };
    let names = list(yaml.lines().nth(3).unwrap(), "joint_names: ");
    assert_eq!(names[5], "joint6");
    let points: Vec<&str> = yaml.split("\n- ").skip(1).collect();
    assert_eq!(points.len(), 501);
    assert!(points[500].contains("time_from_start: {sec: 6, nanosec: 330400000}"));
    let positions = list(points[500].lines().next().unwrap(), "positions: ");
    assert!((positions[0].as_f64().unwrap().to_degrees() - 40.0).abs() < 1e-9);
}

/// A motion that cannot be written is an error, not a loss: exit status 1.
#[test]
fn unwritable_motion_fails() {
    let output = Folder::new().run(&["replay", "--motion", "no/such/folder/motion.csv"]);
    assert_eq!(output.status.code(), Some(1));
    insta::assert_snapshot!("unwritable_motion", stderr(&output));
}

#[test]
fn list_shows_everything_with_its_settings() {
    let output = Folder::new().run(&["list"]);
    assert!(output.status.success());
    let text = stdout(&output);
    let (own, all): (Vec<&str>, Vec<&str>) =
        text.lines().partition(|line| line.starts_with("this processor"));
    let width = Width::widest();
    let expected = format!(
        "this processor evaluates {} places of a path at once ({})",
        width.lanes(),
        width.name()
    );
    assert_eq!(own, [expected]);
    insta::assert_snapshot!("list", all.join("\n"));
}

/// Last digits of what follows from sines differ between processors.
fn without_last_digits(text: &str) -> String {
    let mut digits = 0;
    let mut is_kept = |c: char| {
        digits = if c.is_ascii_digit() { digits + 1 } else { 0 };
        digits <= 8
    };
    text.chars().filter(|&c| is_kept(c)).collect()
}

/// A key that one family alone has names it, in files of tasks and of experiments.
#[test]
fn keys_imply_their_family() {
    let trajectory = "[trajectory]\npieces = 12\n";
    let experiment = format!("name = 'e'\nseeds = 1\n{trajectory}[[optimiser]]\nrandom = {{}}\n");
    let folder = Folder::new()
        .with("task.toml", trajectory)
        .with("experiment.toml", experiment)
        .with("sines.toml", "[trajectory]\nterms = 3\n")
        .with("both.toml", "[trajectory]\npieces = 12\nterms = 3\n");
    for (file, expected) in [
        ("task.toml", "family = \"spline\"\npieces = 12\n"),
        ("experiment.toml", "family = \"spline\"\npieces = 12\n"),
        ("sines.toml", "family = \"sine-polynomial\"\nterms = 3\n"),
    ] {
        let output = folder.run(&["check", file, "--no-estimate"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stdout(&output).contains(expected), "{}", stdout(&output));
    }
    let output = folder.run(&["check", "both.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let told = "found `pieces`, which is for `family = \"spline\"` alone";
    assert!(stderr(&output).contains(told), "{}", stderr(&output));
}

#[test]
fn check_prints_what_is_resolved() {
    let folder = Folder::new()
        .with("task.toml", "[task.limits]\njerk_deg_s3 = 40\n")
        .with("spline.toml", "[trajectory]\nfamily = 'spline'\n")
        .with("robot.toml", include_str!("../../src/robot/shipped/xiao2023.toml"));
    for name in ["task", "spline", "robot"] {
        let output = folder.run(&["check", &format!("{name}.toml")]);
        assert!(output.status.success(), "{}", stderr(&output));
        insta::assert_snapshot!(format!("check_{name}"), without_last_digits(&stdout(&output)));
        // What is printed is itself a file that says the same.
        let again = Folder::new().with("again.toml", stdout(&output)).run(&["check", "again.toml"]);
        assert_eq!(stdout(&again), stdout(&output));
    }
}
