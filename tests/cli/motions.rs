//! Files of motions: when they are sampled, what stands in them, and that each format is the same motion.

use std::collections::BTreeMap;
use std::fs;

use nalgebra::{Quaternion, UnitQuaternion};
use serde_json::Value;

use crate::folder::{Folder, stderr};
use crate::replays::{json, near, number, said};
use crate::robots::servicer;

/// A robot with a joint that slides, one with two arms, the paper's, and one that is a URDF's chain.
const TASKS: [&str; 4] = ["task.toml", "dual_arm", "xiao2023", "panda"];

/// Plans any motion of a task into a file.
fn plan(folder: &Folder, task: &str, more: &[&str]) -> Value {
    let quick = ["--optimiser", "random", "--budget", "50", "--family", "spline", "--pieces", "12"];
    json(folder, &[&["plan", task, "--json"], &quick[..], more].concat())
}

/// The columns of a table by name.
fn columns(folder: &Folder, file: &str) -> BTreeMap<String, Vec<f64>> {
    let mut reader = csv::Reader::from_path(folder.path().join(file)).unwrap();
    let names: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let column = |k: usize| rows.iter().map(|row| row[k].parse().unwrap()).collect();
    names.into_iter().enumerate().map(|(k, name)| (name, column(k))).collect()
}

fn largest_difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// `plan` is the other source of all values.
#[test]
fn each_format_is_replayed_as_planned() {
    let folder = servicer();
    let parquet = cfg!(feature = "harness").then_some("motion.parquet");
    let files = ["motion.csv", "motion.wide.csv", "motion.yaml", "motion.goal.yaml"];
    for task in TASKS {
        for file in files.into_iter().chain(parquet) {
            let planned = plan(&folder, task, &["--motion", file]);
            let found = json(&folder, &["replay", file, "--task", task, "--json"]);
            assert_eq!(found["ignored_columns"], Value::Array(Vec::new()), "{task} {file}");
            near(&found["t_f"], number(&planned["t_f"]), 1e-9);
            near(&found["residual_deg"], number(&planned["residual_deg"]), 1e-6);
            for (k, joint) in found["joints"].as_array().unwrap().iter().enumerate() {
                for (order, unit) in [("rate", "s"), ("acceleration", "s2"), ("jerk", "s3")] {
                    let peaks = &planned["peaks"];
                    let peak = peaks.get(order).unwrap_or(&peaks[format!("{order}_deg_{unit}")]);
                    let peak = number(&peak[k]);
                    near(&joint[order]["peak"], peak, 1e-5 * peak);
                }
            }
        }
    }
}

#[test]
fn samples_are_at_multiples_of_the_step_and_at_the_end() {
    let folder = servicer();
    for task in TASKS {
        let planned = plan(&folder, task, &["--motion", "a.wide.csv", "--dt", "0.05"]);
        plan(&folder, task, &["--motion", "b.wide.csv", "--rate", "20"]);
        let [a, b] = ["a", "b"]
            .map(|name| fs::read(folder.path().join(name.to_owned() + ".wide.csv")).unwrap());
        assert!(a == b);
        let time = &columns(&folder, "a.wide.csv")["time [s]"];
        let (last, before) = time.split_last().unwrap();
        near(&planned["t_f"], *last, 0.0);
        for (k, time) in before.iter().enumerate() {
            assert_eq!(*time, k as f64 / 20.0);
        }
        let rest = last - before[before.len() - 1];
        assert!((0.005..0.055).contains(&rest), "{rest}");
    }
    // Longer than the motion: its ends.
    plan(&folder, "xiao2023", &["--motion", "ends.wide.csv", "--dt", "1e6"]);
    assert_eq!(columns(&folder, "ends.wide.csv")["time [s]"].len(), 2);
}

/// From the family's curves, and from polynomials of fifth degree through other samples of them, with the base's attitude by
/// other steps.
#[test]
fn samples_are_those_of_another_evaluation() {
    let folder = servicer();
    for task in TASKS {
        plan(&folder, task, &["--motion", "fine.csv"]);
        plan(&folder, task, &["--motion", "direct.wide.csv", "--dt", "0.07"]);
        let again =
            ["replay", "fine.csv", "--task", task, "--motion", "again.wide.csv", "--dt", "0.07"];
        let output = folder.run(&again);
        assert!(output.status.success(), "{}", stderr(&output));
        let [direct, again] = ["direct.wide.csv", "again.wide.csv"].map(|f| columns(&folder, f));
        assert!(direct.keys().eq(again.keys()));
        for (name, values) in &direct {
            let size = values.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
            let off = largest_difference(&again[name], values) / size;
            // The base's attitude is sampled to 1e-8 rad, and jerks of quintics between close samples are made of rounding.
            let allowed = if name.contains("_jerk") { 1e-4 } else { 3e-8 };
            assert!(off < allowed, "{task} {name}: {off:e}");
        }
    }
}

/// Slopes of columns by differences of fourth order, and angles by nalgebra's product of three turns.
#[test]
fn columns_agree_with_each_other() {
    let folder = servicer();
    for task in TASKS {
        plan(&folder, task, &["--motion", "m.wide.csv", "--rate", "500"]);
        let table = columns(&folder, "m.wide.csv");
        let slope = |values: &[f64]| -> Vec<f64> {
            let at = |w: &[f64]| (w[0] - 8.0 * w[1] + 8.0 * w[3] - w[4]) * (500.0 / 12.0);
            // The last step has another width.
            values[..values.len() - 1].windows(5).map(at).collect()
        };
        for (name, values) in &table {
            let Some((joint, unit)) = name.split_once("_position [") else { continue };
            if joint == "base" {
                continue;
            }
            let unit = unit.trim_end_matches(']');
            let rate = &table[&format!("{joint}_rate [{unit}/s]")];
            let acceleration = &table[&format!("{joint}_acceleration [{unit}/s^2]")];
            let torque = format!("{joint}_torque [{}]", if unit == "m" { "N" } else { "N m" });
            assert!(table[&torque].iter().any(|torque| *torque != 0.0), "{torque}");
            for (values, slopes) in [(values, rate), (rate, acceleration)] {
                let off = largest_difference(&slope(values), &slopes[2..slopes.len() - 3]);
                assert!(off < 1e-6, "{task} {name}: {off:e}");
            }
        }
        let base = |key: &str| &table[key];
        let attitudes: Vec<Quaternion<f64>> = (0..base("base_w").len())
            .map(|i| {
                let [w, x, y, z] = ["base_w", "base_x", "base_y", "base_z"].map(|key| base(key)[i]);
                Quaternion::new(w, x, y, z)
            })
            .collect();
        for (i, attitude) in attitudes.iter().enumerate() {
            let [yaw, pitch, roll] =
                ["yaw", "pitch", "roll"].map(|key| base(&format!("base_{key} [rad]"))[i]);
            let expected = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let same = attitude.dot(&expected.into_inner()).abs();
            assert!((same - 1.0).abs() < 1e-12, "{same}");
        }
        // In base axes: ω = 2 q* q̇.
        for (k, key) in ["x", "y", "z"].into_iter().enumerate() {
            let parts: [Vec<f64>; 4] =
                [0, 1, 2, 3].map(|c| slope(&attitudes.iter().map(|q| q[c]).collect::<Vec<_>>()));
            let rates: Vec<f64> = (0..parts[0].len())
                .map(|i| {
                    let [x, y, z, w] = [0, 1, 2, 3].map(|c| parts[c][i]);
                    let product = attitudes[i + 2].conjugate() * Quaternion::new(w, x, y, z);
                    2.0 * product.imag()[k]
                })
                .collect();
            let expected = &base(&format!("base_rate_{key} [rad/s]"))[2..];
            let off = largest_difference(&rates, &expected[..rates.len()]);
            assert!(off < 1e-4, "{task} base_rate_{key}: {off:e}");
            let place = base(&format!("base_position_{key} [m]"));
            assert!(place[0] == 0.0 && place.iter().any(|place| *place != 0.0));
        }
    }
}

/// The long table has the same numbers.
#[test]
fn both_tables_are_the_same() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.wide.csv"]);
    plan(&folder, "task.toml", &["--motion", "m.csv"]);
    let wide = columns(&folder, "m.wide.csv");
    let mut reader = csv::Reader::from_path(folder.path().join("m.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    assert_eq!(
        header.iter().collect::<Vec<_>>().join(","),
        "time,joint,unit,angle,rate,acceleration,jerk,base_w,base_x,base_y,base_z,torque,base_yaw,base_pitch,base_roll,\
         base_position_x,base_position_y,base_position_z,base_rate_x,base_rate_y,base_rate_z"
    );
    let (mut rows, mut places) = (0, BTreeMap::<String, usize>::new());
    for row in reader.records().map(Result::unwrap) {
        let (joint, unit) = (&row[1], &row[2]);
        let place = places.entry(joint.to_owned()).or_default();
        let force = if unit == "m" { "N" } else { "N m" };
        for (name, value) in
            header.iter().zip(&row).filter(|(name, _)| !["joint", "unit"].contains(name))
        {
            let own = match name {
                "time" => "time [s]".to_owned(),
                "angle" => format!("{joint}_position [{unit}]"),
                "rate" => format!("{joint}_rate [{unit}/s]"),
                "acceleration" => format!("{joint}_acceleration [{unit}/s^2]"),
                "jerk" => format!("{joint}_jerk [{unit}/s^3]"),
                "torque" => format!("{joint}_torque [{force}]"),
                _ if name.contains("position") => format!("{name} [m]"),
                _ if name.contains("rate") => format!("{name} [rad/s]"),
                "base_yaw" | "base_pitch" | "base_roll" => format!("{name} [rad]"),
                _ => name.to_owned(),
            };
            assert_eq!(value.parse::<f64>().unwrap(), wide[&own][*place], "{name}");
        }
        *place += 1;
        rows += 1;
    }
    assert_eq!(rows, 4 * wide["base_w"].len());
}

/// Tables that lack the columns behind the base's quaternion are read as well.
#[test]
fn the_first_columns_are_enough() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.csv"]);
    let text = fs::read_to_string(folder.path().join("m.csv")).unwrap();
    let first = text.lines().map(|line| line.split(',').take(11).collect::<Vec<_>>().join(","));
    let folder = folder.with("first.csv", first.collect::<Vec<_>>().join("\n"));
    let [all, first] = ["m.csv", "first.csv"].map(|file| {
        let mut found = json(&folder, &["replay", file, "--task", "task.toml", "--json"]);
        found["trajectory"] = Value::Null;
        found
    });
    assert_eq!(first, all);
}

#[test]
fn some_joints_are_written() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.wide.csv", "--joints", "left_*"]);
    let table = columns(&folder, "m.wide.csv");
    let joints: Vec<&String> = table.keys().filter(|name| name.contains("_torque")).collect();
    assert_eq!(joints, ["left_slide_torque [N]", "left_turn_torque [N m]"]);
    assert!(table.contains_key("base_rate_z [rad/s]"));
}

/// The goal has the same message within.
#[test]
fn a_goal_has_the_trajectory() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.goal.yaml"]);
    plan(&folder, "task.toml", &["--motion", "m.yaml"]);
    let [goal, message] =
        ["m.goal.yaml", "m.yaml"].map(|f| fs::read_to_string(folder.path().join(f)).unwrap());
    let within: Vec<String> = message.lines().map(|line| format!("  {line}")).collect();
    let within = within.join("\n");
    let rest =
        "path_tolerance: []\ngoal_tolerance: []\ngoal_time_tolerance: {sec: 0, nanosec: 0}\n";
    assert_eq!(goal, format!("trajectory:\n{within}\n{rest}"));
}

#[test]
fn a_mat_file_is_not_read() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.mat"]);
    let file = fs::read(folder.path().join("m.mat")).unwrap();
    assert!(file.starts_with(b"MATLAB 5.0 MAT-file") && file.len().is_multiple_of(8));
    let output = folder.run(&["replay", "m.mat", "--task", "task.toml"]);
    assert_eq!(output.status.code(), Some(2));
    let message = said(&stderr(&output));
    let expected = "m.mat: MAT-files are written, but not read, expected a name in .csv, .parquet, .yaml or .json";
    assert!(message.contains(expected), "{message}");
}

/// A folder that is whole; what MuJoCo makes of it is for `tests/motions/`.
#[test]
fn a_folder_for_mujoco_is_written_once() {
    let folder = servicer();
    plan(&folder, "task.toml", &["--motion", "m.mujoco"]);
    let files = fs::read_dir(folder.path().join("m.mujoco")).unwrap();
    let mut names: Vec<String> =
        files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["motion.wide.csv", "play.py", "robot.xml"]);
    let robot = fs::read_to_string(folder.path().join("m.mujoco/robot.xml")).unwrap();
    assert!(robot.contains("<joint name=\"left_slide\" type=\"slide\" axis=\"0 0.707"), "{robot}");
    let again = folder.run(&["plan", "task.toml", "--motion", "m.mujoco"]);
    assert_eq!(again.status.code(), Some(1));
    assert!(said(&stderr(&again)).contains("cannot write m.mujoco"), "{}", stderr(&again));
    let some = folder.run(&["plan", "task.toml", "--motion", "n.mujoco", "--joints", "left_*"]);
    assert_eq!(some.status.code(), Some(2));
    assert!(
        stderr(&some).contains("a motion for MuJoCo always has all joints"),
        "{}",
        stderr(&some)
    );
}

/// Of a task of several motions each has its own samples; the base stays where it is when a target is caught, though the system's
/// centre of mass is elsewhere then.
#[test]
fn several_motions_are_one_file() {
    let mission = "[task]\nrobot = 'ur5e'\n[[task.via]]\njoints_deg = [20, -80, 80, -80, -60, 20]\n\
        capture = { mass = 40, centre_of_mass = [0, 0, 0.2] }\n\
        [task.goal]\njoints_deg = [30, -60, 70, -70, -60, 20]\n";
    let folder = Folder::new().with("mission.toml", mission);
    let plan = |file| {
        let args = ["plan", "mission.toml", "--json", "--family", "sine-polynomial", "--dt", "0.1"];
        folder.run(&[&args[..], &["--motion", file]].concat())
    };
    let output = plan("m.wide.csv");
    assert!(output.status.success(), "{}", stderr(&output));
    let planned: Value = serde_json::from_slice(&output.stdout).unwrap();
    let table = columns(&folder, "m.wide.csv");
    let time = &table["time [s]"];
    let first = number(&planned["legs"][0]["t_f"]);
    near(&planned["t_f"], time[time.len() - 1], 1e-9);
    let end = time.iter().position(|time| *time == first).unwrap();
    assert!(end > 2 && (time[end + 1] - first - 0.1).abs() < 1e-12);
    for key in ["x", "y", "z"] {
        let place = &table[&format!("base_position_{key} [m]")];
        assert!(place[0] == 0.0 && place.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02));
        let rest = (place[end + 1] - place[end]).abs();
        assert!(rest < 1e-3, "{rest}");
    }
    let refused = plan("m.mujoco");
    let message = said(&stderr(&refused));
    assert!(
        message.contains(
            "the robot's load changes during the motion, and a MuJoCo model has one load"
        ),
        "{message}"
    );
    assert!(!folder.path().join("m.mujoco").exists());
}

#[test]
fn senseless_samplings_are_refused() {
    let folder = Folder::new();
    let motion = ["plan", "--budget", "50", "--motion", "m.csv"];
    let above = "expected a number of seconds above zero";
    for (args, expected) in [
        (&["--dt", "0"][..], above),
        (&["--dt", "-0.01"], above),
        (&["--dt", "nan"], above),
        (&["--dt", "inf"], above),
        (&["--dt", "fine"], above),
        (&["--rate", "0"], "expected a number above zero"),
        (&["--rate", "-1"], "expected a number above zero"),
        (&["--rate", "inf"], "expected a number above zero"),
        (&["--dt", "0.1", "--rate", "10"], "cannot be used with '--rate <HZ>'"),
    ] {
        let output = folder.run(&[&motion[..], args].concat());
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(said(&stderr(&output)).contains(expected), "{args:?}: {}", stderr(&output));
    }
    let output = folder.run(&["plan", "--dt", "0.1"]);
    assert_eq!(output.status.code(), Some(2));
    let message = said(&stderr(&output));
    assert!(
        message.contains("--dt needs a motion to be written, expected --motion FILE"),
        "{message}"
    );
    let output = folder.run(&[&motion[..], &["--dt", "1e-9"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let message = said(&stderr(&output));
    assert!(message.contains("expected 1000000 samples or fewer"), "{message}");
    assert!(!folder.path().join("m.csv").exists());
}
