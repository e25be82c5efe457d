//! Grippers: planned, exported and replayed with joints that follow others.

use std::fs;

use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};

/// A satellite with an arm and a gripper, whose right finger follows the left one.
const GRIPPER: &str = "<robot name='servicer'>
<link name='body'><inertial><mass value='100'/><inertia ixx='10' iyy='12' izz='14'/></inertial></link>
<link name='upper'><inertial><origin xyz='0 0 0.4'/><mass value='8'/><inertia ixx='0.4' iyy='0.4' izz='0.1'/></inertial></link>
<link name='hand'><inertial><origin xyz='0 0.2 0.3'/><mass value='5'/><inertia ixx='0.2' iyy='0.2' izz='0.1'/></inertial></link>
<link name='right_finger'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01'/></inertial></link>
<link name='left_finger'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01'/></inertial></link>
<joint name='turn' type='revolute'><parent link='body'/><child link='upper'/><origin xyz='0 0.5 0.3'/><axis xyz='1 0 0'/><limit lower='-1.5' upper='1.5' velocity='1' effort='9'/></joint>
<joint name='bend' type='revolute'><parent link='upper'/><child link='hand'/><origin xyz='0 0 0.8'/><axis xyz='0 1 1'/><limit lower='-2' upper='2' velocity='1' effort='9'/></joint>
<joint name='right' type='prismatic'><parent link='hand'/><child link='right_finger'/><origin xyz='0 0 0.5'/><axis xyz='0 1 0'/><limit lower='-0.1' upper='0' velocity='0.2' effort='9'/><mimic joint='left' multiplier='-0.5' offset='-0.01'/></joint>
<joint name='left' type='prismatic'><parent link='hand'/><child link='left_finger'/><origin xyz='0 0 0.5'/><axis xyz='0 1 0'/><limit lower='0' upper='0.15' velocity='0.2' effort='9'/></joint>
</robot>";

const TASK: &str = "[task]
robot = 'gripper.urdf'
start = { joints = { turn = 10, bend = -20, left = 0.02 }, base_zyx_deg = [1, 1, -1] }
goal = { joints = [20, 30, 0.1], base_zyx_deg = [0, 0, 0] }
limits = { rate = [50, 50, 0.15], acceleration = [70, 70, 0.1, 0.3], jerk = [80, 80, 0.3] }
";

fn gripper() -> Folder {
    Folder::new().with("gripper.urdf", GRIPPER).with("task.toml", TASK)
}

fn json(folder: &Folder, args: &[&str]) -> Value {
    let output = folder.run(args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// In each family every sample has the right finger where it follows the left one, at −½ of it and 1 cm less.
#[test]
fn motions_have_all_joints() {
    let folder = gripper();
    for family in ["spline", "sine-polynomial"] {
        let args = [
            "plan",
            "task.toml",
            "--json",
            "--budget",
            "2000",
            "--motion",
            "m.csv",
            "--family",
            family,
        ];
        let plan = json(&folder, &args);
        assert_eq!(plan["coefficients"].as_array().unwrap().len(), 3);
        let peaks = &plan["peaks"];
        // Of the right finger's acceleration, 0.1 m/s², the left one would take 0.3 m/s² otherwise.
        for (key, limits) in [
            ("rate", [50.0, 50.0, 0.075, 0.15]),
            ("acceleration", [70.0, 70.0, 0.1, 0.2]),
            ("jerk", [80.0, 80.0, 0.15, 0.3]),
        ] {
            let found = numbers(&peaks[key]);
            let shares = found.iter().zip(limits).map(|(peak, limit)| peak / limit);
            assert!(shares.fold(0.0, f64::max) < 1.0 + 1e-6, "{key}: {found:?}");
        }
        let mut reader = csv::Reader::from_path(folder.path().join("m.csv")).unwrap();
        let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
        let names: Vec<&str> = rows[..4].iter().map(|row| &row[1]).collect();
        assert_eq!(names, ["turn", "bend", "right", "left"]);
        for sample in rows.chunks(4) {
            let value = |row: usize, column: usize| sample[row][column].parse::<f64>().unwrap();
            assert!((value(2, 3) + 0.5 * value(3, 3) + 0.01).abs() < 1e-9, "{sample:?}");
            assert!((value(2, 4) + 0.5 * value(3, 4)).abs() < 1e-9, "{sample:?}");
        }
        let replay = json(&folder, &["replay", "m.csv", "--task", "task.toml", "--json"]);
        let miss = |key: &str| replay[key].as_f64().unwrap() - plan[key].as_f64().unwrap();
        assert!(miss("residual_deg").abs() < 1e-6, "{:e}", miss("residual_deg"));
        assert!(miss("t_f").abs() < 1e-6, "{:e}", miss("t_f"));
        let faults = replay["faults"].as_array().unwrap();
        assert!(!faults.iter().any(|fault| fault["kind"] == "follow"), "{faults:?}");
    }
}

/// The goal is reached, and the same motion has the same end when it is read again from its coefficients.
#[test]
fn plans_reach_their_goal_and_are_read_again() {
    let folder = gripper();
    let plan = json(&folder, &["plan", "task.toml", "--json", "--require"]);
    let motion = |rows: &Value| {
        format!(
            "{TASK}[trajectory]\nfamily = 'spline'\ndegree = 4\n[motion]\ncoefficients = {rows}\nt_f = {}\n",
            plan["t_f"]
        )
    };
    let mut short = plan["coefficients"].clone();
    short.as_array_mut().unwrap().pop();
    let folder =
        folder.with("again.toml", motion(&plan["coefficients"])).with("short.toml", motion(&short));
    let again = json(&folder, &["replay", "again.toml", "--json"]);
    let physics = &again["readings"][0];
    let miss = |key: &str| physics[key].as_f64().unwrap() - plan[key].as_f64().unwrap();
    assert!(miss("j").abs() < 1e-9 && miss("residual_deg").abs() < 1e-9, "{physics}");
    let error = stderr(&folder.run(&["replay", "short.toml"]));
    assert!(error.contains("expected 3 rows, one per joint that follows no other"), "{error}");
}

/// The right finger, at −½ of the left one's 0.1 m and 1 cm less, is said to be 5 mm off.
#[test]
fn trajectories_that_do_not_follow_are_told() {
    let table = "time,turn_deg,bend_deg,right,left\n0,10,-20,-0.02,0.02\n1,15,0,-0.055,0.1\n2,20,30,-0.06,0.1\n";
    let folder = gripper().with("m.csv", table);
    let replay = json(&folder, &["replay", "m.csv", "--task", "task.toml", "--json"]);
    let faults = replay["faults"].as_array().unwrap();
    let found: Vec<&Value> = faults.iter().filter(|fault| fault["kind"] == "follow").collect();
    assert_eq!(found.len(), 1, "{faults:?}");
    assert_eq!((&found[0]["joint"], &found[0]["at"]), (&"right".into(), &1.0.into()));
    assert!((found[0]["by"].as_f64().unwrap() - 0.005).abs() < 1e-12, "{}", found[0]);
    let told = stdout(&folder.run(&["replay", "m.csv", "--task", "task.toml"]));
    assert!(
        told.contains("right is +0.005000 m from where its leader puts it at 1.000000 s"),
        "{told}"
    );
}

#[test]
fn checks_print_what_follows() {
    let folder = gripper();
    let checked = stdout(&folder.run(&["check", "gripper.urdf"]));
    assert!(
        checked.contains("mimic = { joint = \"left\", multiplier = -0.5, offset_m = -0.01 }")
            || checked.contains(
                "[link.joint.mimic]\njoint = \"left\"\nmultiplier = -0.5\noffset_m = -0.01\n"
            ),
        "{checked}"
    );
    for (from, to) in [("gripper.urdf", "a.toml"), ("a.toml", "b.urdf"), ("b.urdf", "c.toml")] {
        let output = folder.run(&["robot", "convert", from, "--out", to]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let urdf = fs::read_to_string(folder.path().join("b.urdf")).unwrap();
    assert!(
        urdf.contains("<mimic joint=\"left\" multiplier=\"-0.5\" offset=\"-0.01\"/>"),
        "{urdf}"
    );
    let follow = "follow = { bend = 'turn' }\n";
    let task = TASK.replace("start =", &format!("{follow}start ="));
    let task = task.replace("[50, 50, 0.15]", "[50, 50, 0.1, 0.15]");
    let task = task.replace("[80, 80, 0.3]", "[80, 80, 0.2, 0.3]");
    let folder = folder.with("task.toml", task);
    let wrong = folder.run(&["check", "task.toml"]);
    assert_eq!(wrong.status.code(), Some(2));
    let message = stderr(&wrong);
    assert!(message.contains("found -20° for joint `bend`, which follows joint"), "{message}");
    assert!(message.contains("leave `bend` out"), "{message}");
}
