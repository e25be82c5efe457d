//! Trajectories of other programs, replayed.

use std::fs;

use serde::Deserialize;
use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};

pub(crate) const JOINTS: [&str; 6] = ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6"];

/// The base of a test bed and a planar arm; the other two tasks are those of `tests/robots/`.
const PLANAR: &str = "[task]\nrobot = '../../experiments/robots/sc3dof.toml'\n\
    start = { joints_deg = [20, -40, 30], base_zyx_deg = [0, 0, 3] }\n\
    goal = { joints_deg = [-10, 35, 60], base_zyx_deg = [0, 0, 0] }\n\
    limits = { rate_deg_s = 60, acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }\n";

/// The object that the command prints.
pub(crate) fn json(folder: &Folder, args: &[&str]) -> Value {
    let output = folder.run(args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

pub(crate) fn near(found: &Value, expected: f64, tolerance: f64) {
    let found = number(found);
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

/// What an error says, without the breaks of its lines.
pub(crate) fn said(text: &str) -> String {
    let words = text.split_whitespace().filter(|word| *word != "│" && *word != "×");
    words.collect::<Vec<_>>().join(" ")
}

/// A message of the default robot with points at these times, and more lines in each.
pub(crate) fn message(times: &[f64], more: &str) -> String {
    let point = |time: &f64| {
        format!(
            "- positions: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]\n{more}  time_from_start: {{sec: {}, nanosec: {}}}\n",
            time.floor(),
            (time.fract() * 1e9).round()
        )
    };
    let points: String = times.iter().map(point).collect();
    format!("joint_names: [{}]\npoints:\n{points}", JOINTS.join(", "))
}

/// A motion that is planned, exported and replayed is the same motion: `plan` is the other source of all values.
#[test]
fn exports_are_replayed_as_planned() {
    let root = env!("CARGO_MANIFEST_DIR");
    let tasks = format!("{root}/tests/robots");
    let formats =
        if cfg!(feature = "harness") { &["yaml", "csv", "parquet"][..] } else { &["yaml", "csv"] };
    let folder = Folder::new();
    let planar = PLANAR.replace("../..", root);
    let folder = folder.with("planar.toml", planar).with("paper.toml", "");
    for task in [
        "paper.toml",
        &format!("{tasks}/iiwa-turn.toml"),
        &format!("{tasks}/ur5-turn.toml"),
        "planar.toml",
    ] {
        for format in formats {
            let motion = format!("motion.{format}");
            // The default motion, and for others any.
            let quick = ["--optimiser", "random", "--budget", "50", "--family", "spline"];
            let quick = if task == "paper.toml" { &[][..] } else { &quick };
            let plan = [&["plan", task, "--json", "--motion", &motion], quick].concat();
            let plan = json(&folder, &plan);
            let replay = json(&folder, &["replay", &motion, "--task", task, "--json"]);
            println!("{task} {format}: {} {}", plan["residual_deg"], replay["residual_deg"]);
            near(&replay["residual_deg"], number(&plan["residual_deg"]), 1e-8);
            near(&replay["t_f"], number(&plan["t_f"]), 1e-9);
            let turn = number(&plan["largest_base_turn_deg"]);
            near(&replay["largest_base_turn_deg"], turn, 1e-4 * turn);
            for (k, joint) in replay["joints"].as_array().unwrap().iter().enumerate() {
                for (order, unit) in [("rate", "s"), ("acceleration", "s2"), ("jerk", "s3")] {
                    let planned = number(&plan["peaks"][format!("{order}_deg_{unit}")][k]);
                    near(&joint[order]["peak"], planned, 1e-5 * planned);
                }
            }
            assert_eq!(
                (&replay["interpolation"], &replay["within_limits"]),
                (&"quintic".into(), &plan["within_limits"])
            );
            assert_eq!(replay["reached"], plan["reached"], "{replay}");
            for momentum in ["largest_momentum", "largest_angular_momentum"] {
                assert!(number(&replay[momentum]) < 1e-12, "{replay}");
            }
        }
    }
}

/// Of a file what `tests/reference/make_replay.py` found.
#[derive(Deserialize)]
struct Reference {
    points: usize,
    played: String,
    readings: std::collections::BTreeMap<String, Expected>,
}

#[derive(Deserialize)]
struct Expected {
    base_quaternion: [f64; 4],
    residual_deg: f64,
    /// Of rates, accelerations and jerks.
    peaks: [Vec<f64>; 3],
    /// Of rates and accelerations, standing still before and behind.
    jumps: [Vec<f64>; 2],
    base_rate_deg_s: f64,
}

/// Against SciPy and Pinocchio, which know nothing of Magnus steps: where the base ends by lines, cubics, quintics and the smooth
/// spline, peaks, jumps.
#[test]
fn readings_are_those_of_an_independent_integrator() {
    let reference: std::collections::BTreeMap<String, Reference> =
        serde_json::from_str(include_str!("../reference/replay.json")).unwrap();
    assert_eq!(reference.len(), 5);
    let folder = Folder::new();
    let files = format!("{}/tests/reference/replay", env!("CARGO_MANIFEST_DIR"));
    for (file, expected) in &reference {
        let path = format!("{files}/{file}");
        let found = json(&folder, &["replay", &path, "--json"]);
        assert_eq!(found["points"], expected.points);
        assert_eq!(found["interpolation"], *expected.played);
        let readings = found["readings"].as_array().unwrap();
        assert_eq!(readings.len(), expected.readings.len());
        for reading in readings {
            let name = reading["interpolation"].as_str().unwrap();
            let expected = &expected.readings[name];
            println!("{file} {name}: {} {}", reading["residual_deg"], expected.residual_deg);
            near(&reading["residual_deg"], expected.residual_deg, 1e-9);
            let found = reading["base_quaternion"].as_array().unwrap();
            for (found, expected) in found.iter().zip(expected.base_quaternion) {
                near(found, expected, 1e-11);
            }
            assert!(number(&reading["residual_error_deg"]) < 1e-10_f64.to_degrees());
            for (order, limit) in [("rate", 60.0), ("acceleration", 70.0), ("jerk", 80.0)] {
                let k = ["rate", "acceleration", "jerk"].iter().position(|o| *o == order).unwrap();
                let largest = expected.peaks[k].iter().copied().fold(0.0, f64::max);
                // Theirs are sampled.
                near(&reading[format!("{order}_share")], largest / limit, 1e-6 * largest / limit);
            }
        }
        let played = &expected.readings[&expected.played];
        near(
            &found["largest_base_rate_deg_s"],
            played.base_rate_deg_s,
            1e-4 * played.base_rate_deg_s,
        );
        for (k, kind) in ["rate-jump", "acceleration-jump"].into_iter().enumerate() {
            let largest = played.jumps[k].iter().copied().fold(0.0, f64::max);
            let faults = found["faults"].as_array().unwrap();
            match faults.iter().find(|fault| fault["kind"] == kind) {
                Some(fault) => near(
                    &fault["by"],
                    fault["by"].as_f64().unwrap().signum() * largest,
                    1e-9 * largest,
                ),
                None => assert!(largest < 1e-3, "{file}: {kind} {largest}"),
            }
        }
    }
}

/// What interpolation does is told to people, too. 0.325689, 0.001963, 0.001847 and 0.000658 are the reference's.
#[test]
fn other_readings_are_told() {
    let files = format!("{}/tests/reference/replay", env!("CARGO_MANIFEST_DIR"));
    for (file, told) in [
        (
            "positions.yaml",
            &[
                "played linear, since points have positions alone",
                "base residual 0.325689°",
                "smooth, a cubic spline through positions alone, at rest at both ends: residual 0.001963°",
                "rates jump at 18 points, most on joint",
                "joint1 is not at rest at the start: 1.159675 °/s",
            ][..],
        ),
        (
            "rates.yaml",
            &["base residual 0.001847°", "linear, by positions alone: residual 0.325689°"],
        ),
        (
            "accelerations.yaml",
            &[
                "played quintic",
                "base residual 0.000658°",
                "cubic, by positions and rates: residual 0.001847°",
                "keeps all limits and ranges",
            ][..3],
        ),
    ] {
        let output = Folder::new().run(&["replay", &format!("{files}/{file}")]);
        let text = said(&stdout(&output));
        println!("{}", stdout(&output));
        for told in told {
            assert!(text.contains(told), "{file}: {told}: {text}");
        }
    }
}

/// The same points in all that other tools make of them.
#[test]
fn other_spellings_are_read() {
    let two = message(&[0.0, 1.5], "");
    let nested = two.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n");
    let wide = "time,joint1_rad,joint2,joint3,joint4,joint5,joint6\n0,0.1,0.2,0.3,0.4,0.5,0.6\n1.5,0.1,0.2,0.3,0.4,0.5,0.6\n";
    let by_time =
        |joint: usize, time: f64| format!("{time},joint{joint},{}\n", joint as f64 / 10.0);
    let by_joint: String =
        (1..=6).rev().flat_map(|joint| [0.0, 1.5].map(|time| by_time(joint, time))).collect();
    let logger = "__time,/joint_states/joint1/effort,/joint_states/joint6/position,/joint_states/joint5/position,\
        /joint_states/joint4/position,/joint_states/joint3/position,/joint_states/joint2/position,\
        /joint_states/joint1/position\n1700000000,9,0.6,0.5,0.4,0.3,0.2,0.1\n1700000001.5,9,0.6,0.5,0.4,0.3,0.2,0.1\n";
    let matlab =
        "t_ms,q_joint1_deg,q_joint2_deg,q_joint3_deg,q_joint4_deg,q_joint5_deg,q_joint6_deg\n";
    let degrees: Vec<String> =
        (1..=6).map(|k| (f64::from(k) / 10.0).to_degrees().to_string()).collect();
    let matlab = format!("{matlab}0,{0}\n1500,{0}\n", degrees.join(","));
    let points = two
        .lines()
        .skip(2)
        .collect::<Vec<_>>()
        .chunks(2)
        .map(|point| {
            let positions = point[0].trim_start_matches("- positions: ");
            let clock = point[1].trim_start_matches("  time_from_start: ");
            let clock = clock.replace("sec:", "\"sec\":").replace("nano\"sec\":", "\"nanosec\":");
            format!("{{\"positions\": {positions}, \"time_from_start\": {clock}}}")
        })
        .collect::<Vec<_>>()
        .join(", ");
    let object = format!("{{\"joint_names\": {JOINTS:?}, \"points\": [{points}]}}");
    for (name, file, content, args) in [
        ("echoed", "t.yaml", format!("{two}---\n"), &[][..]),
        ("goal", "t.yaml", format!("goal:\n  trajectory:\n{nested}"), &[]),
        ("ros1", "t.yml", two.replace("nanosec", "nsecs").replace("sec:", "secs:"), &[]),
        ("windows", "t.yaml", format!("\u{feff}{}", two.replace('\n', "\r\n")), &[]),
        ("json", "t.json", object, &[]),
        ("wide", "t.csv", wide.to_owned(), &[]),
        ("mark_and_returns", "t.csv", format!("\u{feff}{}", wide.replace('\n', "\r\n")), &[]),
        ("semicolons", "t.csv", wide.replace(',', ";"), &[]),
        ("tabs", "t.csv", wide.replace(',', "\t"), &[]),
        ("asked", "t.csv", wide.replace("_rad", ""), &["--unit", "rad"]),
        ("by_joint", "t.csv", format!("time,joint,position_rad\n{by_joint}"), &[]),
        ("logger", "t.csv", logger.to_owned(), &["--unit", "rad"]),
        ("matlab", "t.csv", matlab, &[]),
    ] {
        let folder = Folder::new().with(file, content);
        let found = json(&folder, &[&["replay", file, "--json"], args].concat());
        assert_eq!((&found["points"], &found["t_f"]), (&2.into(), &1.5.into()), "{name}");
        for (k, joint) in found["joints"].as_array().unwrap().iter().enumerate() {
            near(&joint["largest_position"], (0.1 * (k + 1) as f64).to_degrees(), 1e-12);
        }
    }
}

/// By hand: from rest, joint 2 at twice its limit of 60 °/s for a second, beyond its range of 250°, from another start; and joint 1
/// once round.
#[test]
fn faults_are_told_by_how_much() {
    let degrees = |row: &str| {
        let names: Vec<String> = JOINTS.iter().map(|joint| format!("{joint}_deg")).collect();
        format!("time,{}\n{row}", names.join(","))
    };
    let rows = "0,10,131,45,-20,-25,40\n1,10,251,45,-20,-25,40\n2,10,251,45,-20,-25,40\n";
    let folder = Folder::new()
        .with("t.csv", degrees(rows))
        .with("round.csv", degrees("0,179,30,45,-20,-25,40\n1,-179,30,45,-20,-25,40\n"));
    let found = json(&folder, &["replay", "t.csv", "--json"]);
    let faults = found["faults"].as_array().unwrap();
    let fault = |kind: &str| {
        let found = faults.iter().find(|fault| fault["kind"] == kind && fault["joint"] == "joint2");
        found.unwrap_or_else(|| panic!("no {kind}: {faults:?}"))
    };
    for (kind, at, by) in [
        ("start", 0.0, 101.0),
        ("end", 2.0, 191.0),
        ("rate-limit", 0.0, 60.0),
        ("range", 1.0, 1.0),
        ("start-rate", 0.0, 120.0),
        ("rate-jump", 1.0, -120.0),
    ] {
        near(&fault(kind)["at"], at, 1e-12);
        near(&fault(kind)["by"], by, 1e-9);
    }
    assert!(!faults.iter().any(|fault| fault["kind"] == "end-rate"));
    assert_eq!((&found["within_limits"], &found["reached"]), (&false.into(), &false.into()));
    let output = folder.run(&["replay", "round.csv"]);
    let told = "joint1 goes -358.000° between two points at 0.000000 s: are its angles cut to half a turn?";
    assert!(stdout(&output).contains(told), "{}", stdout(&output));
}

/// A replayed trajectory can be written as other motions are, and is then the same: at its own points, as it has accelerations, or
/// sampled anew.
#[test]
fn replayed_motions_are_written() {
    let file = format!("{}/tests/reference/replay/accelerations.yaml", env!("CARGO_MANIFEST_DIR"));
    let folder = Folder::new();
    let first = json(&folder, &["replay", &file, "--json", "--motion", "again.csv"]);
    let again = json(&folder, &["replay", "again.csv", "--json"]);
    assert_eq!(again["points"], first["points"]);
    near(&again["residual_deg"], number(&first["residual_deg"]), 1e-9);
    for (joint, again) in
        first["joints"].as_array().unwrap().iter().zip(again["joints"].as_array().unwrap())
    {
        near(&again["jerk"]["peak"], number(&joint["jerk"]["peak"]), 1e-6);
    }
    let fine = ["replay", &file, "--json", "--motion", "fine.csv", "--dt", "0.01"];
    json(&folder, &fine);
    let fine = json(&folder, &["replay", "fine.csv", "--json"]);
    assert!(number(&fine["points"]) > 500.0, "{}", fine["points"]);
    near(&fine["residual_deg"], number(&first["residual_deg"]), 1e-6);
    let text = fs::read_to_string(folder.path().join("again.csv")).unwrap();
    let last: Vec<f64> = text
        .lines()
        .last()
        .unwrap()
        .split(',')
        .skip(6)
        .map(|field| field.parse().unwrap())
        .collect();
    for (found, expected) in last.iter().zip(first["base_quaternion"].as_array().unwrap()) {
        near(expected, *found, 1e-9);
    }
}

/// What no number of steps can follow is told as such, and soon.
#[test]
fn wild_motions_are_uncertain() {
    let names: Vec<String> = JOINTS.iter().map(|joint| format!("{joint}_rad")).collect();
    let rows = "0,0,0,0,0,0,0\n1,1e9,1e9,1e9,1e9,1e9,1e9\n";
    let folder = Folder::new().with("t.csv", format!("time,{}\n{rows}", names.join(",")));
    let found = json(&folder, &["replay", "t.csv", "--json", "--motion", "wild.csv"]);
    assert!(found["residual_error_deg"].is_null(), "{found}");
    assert_eq!(found["reached"], false);
    let told = stdout(&folder.run(&["replay", "t.csv"]));
    assert!(told.contains("(uncertain: the motion swings too often)"), "{told}");
}
