//! Trajectories that cannot be replayed: one clear error each, exit status 2, no panic.

#[cfg(feature = "harness")]
use std::fs;

use crate::folder::{Folder, stderr};
use crate::replays::{JOINTS, message, said};

const ROW_0: &str = "0,0,0,0,0,0,0\n";
const ROW_1: &str = "1,0.1,0.1,0.1,0.1,0.1,0.1\n";
const ZEROS: &str = "[0, 0, 0, 0, 0, 0]";

/// A wide table in radians.
fn table(rows: &str) -> String {
    format!("time,joint1_rad,{}\n{rows}", JOINTS[1..].join(","))
}

/// A message with one text replaced by another, once.
fn changed(from: &str, to: &str) -> String {
    let two = message(&[0.0, 1.0], "");
    assert!(two.contains(from), "{from:?} is not in the message");
    two.replacen(from, to, 1)
}

fn refuses(file: &str, content: impl AsRef<[u8]>, expected: &str) {
    let output = Folder::new().with(file, content).run(&["replay", file]);
    let text = said(&stderr(&output));
    assert_eq!(output.status.code(), Some(2), "{expected}: {text}");
    assert!(!text.contains("panicked"), "{expected}: {text}");
    assert!(output.stdout.is_empty(), "{expected}: printed a result");
    assert!(text.contains(&format!("{file}{expected}")), "{expected}: {text}");
}

#[test]
fn numbers_of_messages() {
    let with = |more: &str| message(&[0.0, 1.0], &format!("  {more}: {ZEROS}\n"));
    let cut_short = with("velocities").replacen(ZEROS, "[]", 2).replacen("[]", ZEROS, 1);
    let late = with("velocities").replacen(ZEROS, "[]", 1);
    for (content, expected) in [
        (
            message(&[0.0, 1.0, 1.0], ""),
            ":7: found the time 1 s after 1 s, expected times that grow",
        ),
        (changed("0.1", ".nan"), ":3: found the number NaN, expected a finite one"),
        (changed("0.1", "-.inf"), ":3: found the number -inf, expected a finite one"),
        (changed("0.1", "1e300"), ":3: found the number 1e300, expected a smaller one"),
        (changed("0.1", "much"), ":3: expected a ROS JointTrajectory: invalid floating point"),
        (changed("0.1, ", ""), ":3: found 5 positions, expected 6, one for each joint"),
        (cut_short, ":6: found 0 velocities, expected 6, as at the first point"),
        (late, ":6: found 6 velocities, expected 0, as at the first point"),
        (with("accelerations"), ": found accelerations without rates, expected both or neither"),
        (message(&[0.0], ""), ": found one point, expected at least two"),
    ] {
        refuses("t.yaml", content, expected);
    }
}

#[test]
fn names_and_keys_of_messages() {
    let no_points = format!("joint_names: [{}]\n", JOINTS.join(", "));
    let many = format!("joint_names: [{}]\n", "a, ".repeat(1001));
    let two = message(&[0.0, 1.0], "");
    for (content, expected) in [
        (format!("{no_points}points: []\n"), ": found no points, expected at least two"),
        (no_points, ": found no `points`, expected a list"),
        (changed("joint2", "joint1"), ":1: found the joint `joint1` twice, expected it once"),
        (
            changed("joint_names", "names"),
            ": found no `joint_names`, expected those of the robot's joints",
        ),
        (
            changed("joint6", "elbow"),
            ":1: found the unknown joint `elbow`, expected those of robot `xiao2023`: `joint1`, `joint2`,",
        ),
        (
            changed(", joint6", ""),
            ":1: found nothing of `joint6`, expected all joints of robot `xiao2023`",
        ),
        (
            "task: {}\n".to_owned(),
            ": found neither `joint_names` nor `points`, expected a ROS JointTrajectory",
        ),
        (many, ":1: expected a ROS JointTrajectory: found more than 1000 items, expected fewer"),
        (
            changed("time_from_start", "time"),
            ":4: expected a ROS JointTrajectory: missing field `time_from_start`",
        ),
        (changed("nanosec", "ns"), ":4: expected a ROS JointTrajectory: missing field `nanosec`"),
        (format!("{two}joint_names: [a]\n"), ":7: found a key twice, expected it once"),
        (format!("{two}---\n{two}"), ": found more than one trajectory, expected one"),
    ] {
        refuses("t.yaml", content, expected);
    }
}

#[test]
fn files_that_are_no_message() {
    let two = message(&[0.0, 1.0], "");
    let mut bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n".to_owned();
    for (before, c) in ('a'..'j').zip('b'..) {
        let nine = vec![format!("*{before}"); 9].join(", ");
        bomb = [bomb, format!("{c}: &{c} [{nine}]\n")].concat();
    }
    for (content, expected) in [
        (Vec::new(), ": found an empty file, expected a ROS JointTrajectory"),
        (b"---\n".to_vec(), ": found an empty file, expected a ROS JointTrajectory"),
        ([two.as_bytes(), b"# \xe9\n"].concat(), ": found bytes that are not text, expected UTF-8"),
        (two.as_bytes()[..two.len() - 8].to_vec(), ":6: expected a ROS JointTrajectory: "),
        (b"- 1\n- 2\n".to_vec(), ":1: expected a ROS JointTrajectory: expected mapping start"),
        ((0..=255).cycle().take(5000).collect(), ":1: expected a ROS JointTrajectory: "),
        (vec![b'['; 100_000], ":1: expected a ROS JointTrajectory: recursion limit exceeded"),
        (
            (bomb + &two).into_bytes(),
            ":7: found lists that repeat others without end, expected a ROS JointTrajectory",
        ),
    ] {
        refuses("t.yaml", content, expected);
    }
}

#[test]
fn numbers_of_tables() {
    let second = |from: &str, to: &str| table(&[ROW_0, &ROW_1.replacen(from, to, 1)].concat());
    for (content, expected) in [
        (
            table(&[ROW_0, ROW_1, ROW_0].concat()),
            ":4: found the time 0 s after 1 s, expected times that grow",
        ),
        (
            second("1", "1e-10"),
            ":3: found a point less than a nanosecond after 0 s, expected times further apart",
        ),
        (second("0.1", "NaN"), ":3: found the number NaN, expected a finite one"),
        (second("0.1", "much"), ":3: found `much` in the column `joint1_rad`, expected a number"),
        (second("0.1", ""), ":3: found `` in the column `joint1_rad`, expected a number"),
        (
            second("", "").replace(',', ";").replace('.', ","),
            ":3: found `0,1` in the column `joint1_rad`, expected a number with a decimal point",
        ),
        (second("0.1,", ""), ":3: found 6 fields, expected 7 as in the first line"),
        (table(""), ": found no points, expected at least two"),
        (table(ROW_0), ": found one point, expected at least two"),
    ] {
        refuses("t.csv", content, expected);
    }
    let mut rows = String::new();
    for i in 0..=1_000_000 {
        rows += &i.to_string();
        rows += ",0,0,0,0,0,0\n";
    }
    let expected = ":1000002: found more than 1000000 points, expected fewer";
    refuses("t.csv", table(&rows), expected);
}

#[test]
fn columns_of_tables() {
    let named = |from: &str, to: &str| table(&[ROW_0, ROW_1].concat()).replacen(from, to, 1);
    for (content, expected) in [
        (
            named("joint1_rad", "joint1"),
            ":1: found no unit of angles in the names of the columns, such as `elbow [deg]`, expected `--unit rad` or `--unit deg`",
        ),
        (
            named("joint2", "joint2_deg"),
            ":1: found two units in the columns `joint1_rad`, `joint2_deg`, expected one for all angles",
        ),
        (
            named("joint1_rad", "joint1 [m]"),
            ":1: found the column `joint1 [m]` of a joint that turns, expected radians or degrees",
        ),
        (
            named("time", "tick"),
            ":1: found the columns `tick`, `joint1_rad`, `joint2`, `joint3`, `joint4`, `joint5`, `joint6`, expected one called `time`",
        ),
        (
            named("joint6", "jiont6"),
            ":1: found no position of `joint6`, expected a column for each joint of robot `xiao2023`; is `jiont6` meant for `joint6`?",
        ),
        (
            named("joint6", "joint5_pos"),
            ":1: found the columns `joint5`, `joint5_pos`, expected one of them",
        ),
        (
            named("joint6", "joint6,joint1_vel"),
            ":1: found no rate of `joint2`, `joint3`, `joint4`, `joint5`, `joint6`, expected a column for each joint",
        ),
        (String::new(), ": found an empty file, expected a line with the columns' names"),
    ] {
        refuses("t.csv", content, expected);
    }
    let not_text = [table(ROW_0).as_bytes(), b"\xe9,1,1,1,1,1,1\n"].concat();
    refuses("t.csv", not_text, ":3: found bytes that are not text, expected UTF-8");
    let garbage: Vec<u8> = (0..=255).cycle().take(5000).collect();
    refuses("t.csv", garbage, ":1: found the columns ");
}

#[test]
fn long_tables() {
    let long = |rows: &[String]| format!("time,joint,angle_rad\n{}", rows.concat());
    let each = |time: &str| JOINTS.map(|joint| format!("{time},{joint},0.1\n")).concat();
    let row = |text: &str| format!("{text},1\n");
    for (content, expected) in [
        (
            long(&[row("0,joint1"), row("1,joint1")]),
            ": found nothing of `joint2`, `joint3`, `joint4`, `joint5`, `joint6`, expected all joints",
        ),
        (
            long(&[row("0,elbow")]),
            ":2: found the unknown joint `elbow`, expected those of robot `xiao2023`: `joint1`,",
        ),
        (long(&[each("0"), row("0,joint2")]), ":8: found `joint2` twice at 0 s, expected it once"),
        (
            long(&[each("0"), each("1").replace("1,joint3", "1.5,joint3")]),
            ":10: found times of `joint3` that differ from those of `joint1` from 1 s on, expected all joints at each time",
        ),
        (
            "time,joint,speed\n0,joint1,1\n".to_owned(),
            ":1: found the columns `time`, `joint`, `speed`, expected one called `position`",
        ),
    ] {
        refuses("t.csv", content, expected);
    }
}

#[cfg(feature = "harness")]
#[test]
fn files_that_are_no_parquet() {
    let folder = Folder::new();
    assert!(folder.run(&["replay", "--motion", "t.parquet"]).status.success());
    let sound = fs::read(folder.path().join("t.parquet")).unwrap();
    let (first, second) = sound.split_at(sound.len() / 2);
    let garbage: Vec<u8> = (0..=255).cycle().take(5000).collect();
    let text = table(&[ROW_0, ROW_1].concat());
    for content in [&[][..], &garbage, first, second, text.as_bytes()] {
        let expected = ": found a damaged file or another format, expected Parquet";
        refuses("t.parquet", content, expected);
    }
}

#[test]
fn arguments() {
    let two = message(&[0.0, 1.0], "");
    let folder = Folder::new().with("t.yaml", two).with("t.toml", "[motion]\nt_f = 6\n");
    for (args, expected) in [
        (
            &["replay", "t.yaml", "--unit", "deg"][..],
            "found `--unit`, which is for tables: a JointTrajectory is in radians",
        ),
        (
            &["replay", "--task", "t.toml"],
            "found --task, which is for a trajectory in .yaml, .json, .csv or .parquet",
        ),
        (&["replay", "t.toml", "--unit", "rad"], "found --unit, which is for a trajectory"),
        (
            &["replay", "t.yaml", "--task", "t.toml"],
            "t.toml is a motion file, expected a task file",
        ),
        (&["replay", "none.yaml"], "cannot read none.yaml"),
        (&["replay", "t.csv", "--task", "none.toml"], "cannot read none.toml"),
    ] {
        let output = folder.run(args);
        let text = said(&stderr(&output));
        assert_eq!(output.status.code(), Some(2), "{args:?}: {text}");
        assert!(text.contains(expected), "{args:?}: {text}");
    }
}
