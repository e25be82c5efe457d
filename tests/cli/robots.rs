//! Robots from URDF, robots that come with the program, and joints that slide.

use std::fs;

use serde_json::Value;

use crate::folder::{Folder, stderr, stdout};

/// A satellite with a turning and a sliding joint on either side.
const SERVICER: &str = "<robot name='servicer'>
<link name='body'><inertial><mass value='100'/><inertia ixx='10' iyy='12' izz='14'/></inertial></link>
<link name='left'><inertial><origin xyz='0 0 0.4'/><mass value='8'/><inertia ixx='0.4' iyy='0.4' izz='0.1'/></inertial></link>
<link name='left_slider'><inertial><origin xyz='0 0 0.3'/><mass value='5'/><inertia ixx='0.2' iyy='0.2' izz='0.1'/></inertial></link>
<link name='right'><inertial><origin xyz='0 0 0.4'/><mass value='8'/><inertia ixx='0.4' iyy='0.4' izz='0.1'/></inertial></link>
<link name='right_wrist'><inertial><origin xyz='0 0.2 0.3'/><mass value='5'/><inertia ixx='0.2' iyy='0.2' izz='0.1'/></inertial></link>
<joint name='left_turn' type='revolute'><parent link='body'/><child link='left'/><origin xyz='0 0.5 0.3'/><axis xyz='1 0 0'/><limit lower='-1.5' upper='1.5' velocity='1' effort='9'/></joint>
<joint name='left_slide' type='prismatic'><parent link='left'/><child link='left_slider'/><origin xyz='0 0 0.5'/><axis xyz='0 1 1'/><limit lower='0' upper='0.6' velocity='0.2' effort='9'/></joint>
<joint name='right_turn' type='continuous'><parent link='body'/><child link='right'/><origin xyz='0 -0.5 0.3'/><axis xyz='0 1 0'/></joint>
<joint name='right_bend' type='revolute'><parent link='right'/><child link='right_wrist'/><origin xyz='0 0 0.8'/><axis xyz='0 0 1'/><limit lower='-2' upper='2' velocity='1' effort='9'/></joint>
</robot>";

const TASK: &str = "[task]
robot = 'servicer.urdf'
start = { joints = { left_turn = 10, left_slide = 0.1, right_turn = 0, right_bend = -20 }, base_zyx_deg = [1, 1, -1] }
goal = { joints = [20, 0.3, 30, 20], base_zyx_deg = [0, 0, 0] }
limits = { rate = [50, 0.15, 50, 50], acceleration = [70, 0.2, 70, 70], jerk = [80, 0.3, 80, 80] }
";

pub(crate) fn servicer() -> Folder {
    Folder::new().with("servicer.urdf", SERVICER).with("task.toml", TASK)
}

#[test]
fn a_urdf_is_checked_and_converted() {
    let folder = servicer();
    let check = folder.run(&["check", "servicer.urdf"]);
    assert!(check.status.success(), "{}", stderr(&check));
    assert!(
        stdout(&check).starts_with("# robot, with every default filled in\nname = \"servicer\"\n")
    );
    for (from, to) in [("servicer.urdf", "a.toml"), ("a.toml", "b.urdf"), ("b.urdf", "c.toml")] {
        let output = folder.run(&["robot", "convert", from, "--out", to]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let printed = folder.run(&["robot", "convert", "servicer.urdf"]);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(stdout(&printed).trim_end(), read("a.toml").trim_end());
    let check = folder.run(&["check", "c.toml"]);
    assert!(stdout(&check).contains("range_m = [0.0, 0.6]"), "{}", stdout(&check));
    let shipped = folder.run(&["robot", "convert", "canadarm2"]);
    assert!(stdout(&shipped).starts_with("<?xml version=\"1.0\"?>\n<robot name=\"canadarm2\">"));
    let unknown = folder.run(&["robot", "convert", "servicer.urdf", "--out", "a.txt"]);
    assert_eq!(unknown.status.code(), Some(2));
    let message = stderr(&unknown);
    assert!(message.contains("a.txt ends in neither .toml nor .urdf"), "{message}");
    assert!(!folder.path().join("a.txt").exists());
}

/// How many shapes each body has, where they come from, and what a URDF has as meshes.
#[test]
fn check_tells_of_shapes() {
    let mesh = "<collision><geometry><mesh filename='a.stl'/></geometry></collision></link>";
    let ball = "<collision><geometry><sphere radius='0.1'/></geometry></collision></link>";
    let folder = servicer()
        .with("mesh.urdf", SERVICER.replacen("</link>", mesh, 2))
        .with("ball.urdf", SERVICER.replacen("</link>", ball, 1).replacen("</link>", mesh, 2));
    for (file, derived, meshes) in
        [("servicer.urdf", true, 0), ("mesh.urdf", true, 2), ("ball.urdf", false, 1)]
    {
        let output = folder.run(&["check", file]);
        let text = stdout(&output);
        let shapes = text.lines().find(|line| line.starts_with("# shapes (")).unwrap();
        if derived {
            assert!(
                shapes.starts_with("# shapes (derived, since none are stated): base 1, "),
                "{text}"
            );
        } else {
            assert_eq!(shapes, "# shapes (stated): base 1");
        }
        let told = format!("# {meshes} of ");
        let has_line =
            text.lines().any(|line| line.starts_with(&told) && line.ends_with("is a mesh"));
        assert_eq!(has_line, meshes > 0, "{text}");
    }
}

/// Numbers of joints that slide are metres in every output, and no key says degrees of them.
#[test]
fn joints_that_slide_are_told_in_metres() {
    let folder = servicer();
    let output =
        folder.run(&["plan", "task.toml", "--json", "--budget", "300", "--motion", "m.csv"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let plan: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let peaks = &plan["peaks"];
    assert_eq!(peaks["unit"], serde_json::json!(["deg", "m", "deg", "deg"]));
    assert!(peaks.get("rate_deg_s").is_none());
    for (key, limits) in [("rate", [50.0, 0.15, 50.0, 50.0]), ("jerk", [80.0, 0.3, 80.0, 80.0])] {
        for (peak, limit) in peaks[key].as_array().unwrap().iter().zip(limits) {
            assert!(peak.as_f64().unwrap() < limit * (1.0 + 1e-6), "{key}: {peak} of {limit}");
        }
    }
    let mut reader = csv::Reader::from_path(folder.path().join("m.csv")).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(header[..4], ["time", "joint", "unit", "angle"]);
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let end = &rows[rows.len() - 4..];
    let found: Vec<(String, String, f64)> = end
        .iter()
        .map(|row| (row[1].to_owned(), row[2].to_owned(), row[3].parse().unwrap()))
        .collect();
    let expected = [("left_turn", "rad", 20.0_f64.to_radians()), ("left_slide", "m", 0.3)];
    for ((name, unit, value), (joint, own, goal)) in found.iter().zip(expected) {
        assert_eq!((name.as_str(), unit.as_str()), (joint, own));
        assert!((value - goal).abs() < 1e-9, "{name}: {value}");
    }
    let told = folder.run(&["plan", "task.toml", "--budget", "300", "--figures", "figures"]);
    let text = stdout(&told);
    assert!(text.contains(" m/s³ on left_slide at "), "{text}");
    assert!(text.contains("°/s³ on "), "{text}");
}

/// Units that a table states row by row are SI, or refused.
#[test]
fn other_units_are_refused() {
    let folder = servicer();
    assert!(
        folder.run(&["plan", "task.toml", "--budget", "50", "--motion", "m.csv"]).status.success()
    );
    let text = fs::read_to_string(folder.path().join("m.csv")).unwrap();
    let long = "time,joint,position,unit\n0,left_turn,10,deg\n";
    let folder = folder.with("deg.csv", text.replace(",rad,", ",deg,")).with("long.csv", long);
    for (file, expected) in [
        ("deg.csv", "deg.csv:2: found the unit `deg`, expected `rad` or `m`"),
        (
            "long.csv",
            "found a column `unit`, expected the unit of angles in the names of the columns",
        ),
    ] {
        let output = folder.run(&["replay", file, "--task", "task.toml"]);
        let message = stderr(&output).replace("\n  │ ", " ");
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn motions_of_some_joints() {
    let folder = servicer();
    let plan = |joints: &str| {
        folder.run(&[
            "plan",
            "task.toml",
            "--budget",
            "50",
            "--motion",
            "m.yaml",
            "--joints",
            joints,
        ])
    };
    assert!(plan("left_*").status.success());
    let yaml = fs::read_to_string(folder.path().join("m.yaml")).unwrap();
    assert!(yaml.contains("joint_names: [\"left_turn\", \"left_slide\"]\n"), "{}", &yaml[..200]);
    assert!(plan("right_bend,left_turn").status.success());
    let yaml = fs::read_to_string(folder.path().join("m.yaml")).unwrap();
    assert!(yaml.contains("joint_names: [\"left_turn\", \"right_bend\"]\n"), "{}", &yaml[..200]);
    let output = plan("middle_*");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("no joint `middle_*` of robot `servicer`"),
        "{}",
        stderr(&output)
    );
}

/// A robot that comes with the program is planned for by its name, with its own task and not the paper's.
#[test]
fn robots_come_with_tasks() {
    let folder = Folder::new().with("task.toml", "[task]\nrobot = 'ur5e'\n");
    let [by_file, by_name] = ["task.toml", "ur5e"].map(|task| {
        let output = folder.run(&["plan", task, "--budget", "100", "--json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let plan: Value = serde_json::from_str(&stdout(&output)).unwrap();
        plan["j"].clone()
    });
    assert_eq!(by_file, by_name);
    let told = folder.run(&["plan", "task.toml", "--budget", "100"]);
    let text = stdout(&told);
    assert!(
        text.contains("limits.jerk_deg_s3 (as in the robot's own task), weights.base (by default)"),
        "{text}"
    );
    let checked = folder.run(&["check", "task.toml"]);
    assert!(!stdout(&checked).contains("joints_deg = [10.0, 30.0, 45.0"), "{}", stdout(&checked));
}

#[cfg(feature = "harness")]
mod experiments {
    use super::*;
    use crate::experiments::run;

    /// A sweep over robots that come with the program: each does its own task.
    #[test]
    fn robots_are_swept() {
        let text = "name = 'robots'\nseeds = 1\nbudget = { evaluations = 50 }\n\
            [sweep]\nrobot = ['xiao2023', 'ur5e', 'dual_arm']\n[[optimiser]]\nrandom = {}\n";
        let folder = Folder::new().with("robots.toml", text);
        let summary = run(&folder, &["robots.toml", "--out", "out"]);
        assert!(summary.contains("robot=dual_arm"), "{summary}");
        let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
        assert!(stderr(&again).contains("3 of 3 runs are stored already"), "{}", stderr(&again));
        // A lone plan's task is the same instance.
        let own = "name = 'own'\nseeds = 1\nbudget = { evaluations = 50 }\n[task]\nrobot = 'dual_arm'\n\
            [[optimiser]]\nrandom = {}\n";
        let folder = folder.with("own.toml", own);
        run(&folder, &["own.toml", "--out", "own"]);
        let costs = |out: &str| {
            let table = folder.path().join(out).join("tables/summary.csv");
            let mut reader = csv::Reader::from_path(table).unwrap();
            let place = reader.headers().unwrap().iter().position(|name| name == "best J").unwrap();
            reader.records().map(|row| row.unwrap()[place].to_owned()).collect::<Vec<_>>()
        };
        assert_eq!(costs("out").last(), costs("own").first());
    }

    /// A robot from URDF is kept with the results: they are run again, and reported, without it.
    #[test]
    fn urdfs_are_kept() {
        let text = "name = 'kept'\nseeds = 2\nbudget = { evaluations = 50 }\n".to_owned()
            + TASK
            + "[[optimiser]]\nrandom = {}\n[[optimiser]]\nscp = { starts = 1 }\n";
        let folder = servicer().with("kept.toml", text);
        run(&folder, &["kept.toml", "--out", "out"]);
        fs::remove_file(folder.path().join("servicer.urdf")).unwrap();
        let again = folder.run(&["run", "out/experiment.toml", "--out", "out"]);
        assert!(stderr(&again).contains("4 of 4 runs are stored already"), "{}", stderr(&again));
        let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert!(page.contains("left_slide"));
        let folder = folder.with(
            "swept.toml",
            "name = 'swept'\nseeds = 1\nbudget = { evaluations = 50 }\n".to_owned()
                + &TASK.replace("servicer.urdf", "out/robot.toml")
                + "[sweep]\njerk_limit_deg_s3 = [40, 80]\n[[optimiser]]\nrandom = {}\n",
        );
        let output = folder.run(&["run", "swept.toml", "--out", "swept"]);
        assert_eq!(output.status.code(), Some(2));
        let message = stderr(&output);
        assert!(
            message
                .contains("`sweep.jerk_limit_deg_s3` is in degrees, and joint `left_slide` slides"),
            "{message}"
        );
        let torques = fs::read_to_string(folder.path().join("swept.toml")).unwrap();
        let torques = torques.replace("jerk_limit_deg_s3 = [40, 80]", "torque_n_m = [5]");
        let output = folder.with("torques.toml", torques).run(&["check", "torques.toml"]);
        let message = stderr(&output);
        assert!(
            message.contains("`sweep.torque_n_m` is in N·m, and joint `left_slide` slides"),
            "{message}"
        );
    }
}
