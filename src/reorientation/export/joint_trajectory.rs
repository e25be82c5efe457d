//! ROS `trajectory_msgs/JointTrajectory`, and the goal of the action that plays it.

use std::fmt::Write as _;

use super::ExportError;
use super::record::{JointRecord, Record};

/// The goal of a `control_msgs/action/FollowJointTrajectory` as YAML, with the controller's own tolerances. Only fields that all
/// releases of ROS 2 have are there.
pub(super) fn goal(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    let mut goal = "trajectory:\n".to_owned();
    for line in text(record)?.lines() {
        let _ = writeln!(goal, "  {line}");
    }
    let _ =
        writeln!(goal, "path_tolerance: []\ngoal_tolerance: []\ngoal_time_tolerance: {}", clock(0));
    Ok(goal.into_bytes())
}

/// The motion as YAML, see [`text`].
pub(super) fn motion(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    Ok(text(record)?.into_bytes())
}

/// The motion as YAML; the message has no place for jerks and for the base.
///
/// Texts are quoted and numbers have a point, so that readers of YAML 1.1, which take `on` for a truth value and `1e-7` for a
/// text, read them as they are. The message's clock counts nanoseconds, and all values are those of its times: with those of
/// the motion's own times, quintics through the points have jerks that are wrong by a hundredth of usual limits.
fn text(record: &Record<'_>) -> Result<String, ExportError> {
    let error = |reason: &str| ExportError::Format { format: "YAML", reason: reason.to_owned() };
    // The message counts seconds in 32 bits with a sign.
    if record.time.iter().any(|&time| !(0.0..=f64::from(i32::MAX)).contains(&time)) {
        return Err(error("the motion is too long for the message's clock"));
    }
    let stamps: Vec<u64> = record.time.iter().map(|time| (time * 1e9).round() as u64).collect();
    if stamps.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(error(
            "samples are too close for the message's clock, which counts nanoseconds",
        ));
    }
    let names = record.joints.iter().map(|joint| quoted(&joint.motion.name));
    let mut text = format!(
        "header:\n  stamp: {}\n  frame_id: \"\"\njoint_names: {}\npoints:\n",
        clock(0),
        list(names)
    );
    for (i, stamp) in stamps.into_iter().enumerate() {
        // The end stays at rest.
        let is_end = i + 1 == record.time.len();
        let late = if is_end { 0.0 } else { stamp as f64 * 1e-9 - record.time[i] };
        let all = |order: usize| {
            let at = |joint: &JointRecord| {
                let here = joint.motion.derivatives[i];
                number(here[order] + late * here[order + 1])
            };
            list(record.joints.iter().map(at))
        };
        let _ = writeln!(
            text,
            "- positions: {}\n  velocities: {}\n  accelerations: {}\n  effort: []\n  time_from_start: {}",
            all(0),
            all(1),
            all(2),
            clock(stamp)
        );
    }
    Ok(text)
}

fn list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(", "))
}

/// As JSON writes it, which YAML reads.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// With all digits and a point.
fn number(value: f64) -> String {
    let digits = format!("{value:?}");
    match digits.split_once('e') {
        Some((mantissa, exponent)) if !mantissa.contains('.') => format!("{mantissa}.0e{exponent}"),
        _ => digits,
    }
}

fn clock(nanoseconds: u64) -> String {
    let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
    format!("{{sec: {sec}, nanosec: {nanosec}}}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reorientation::motion::JointMotion;
    use crate::robot::{JointKind, Robot};

    fn joint(name: &str, derivatives: Vec<[f64; 4]>) -> JointRecord {
        let (name, kind) = (name.to_owned(), JointKind::Revolute);
        JointRecord { motion: JointMotion { name, kind, derivatives }, torque: Vec::new() }
    }

    fn written(time: Vec<f64>, joints: Vec<JointRecord>) -> Result<String, ExportError> {
        let robot = Robot::from_document(&Robot::embedded("xiao2023").unwrap()).unwrap();
        text(&Record { robot: &robot, is_one_robot: true, time, joints, base: Vec::new() })
    }

    fn two(end: f64) -> Result<String, ExportError> {
        let with =
            |positions: [f64; 2]| positions.map(|position| [position, 1e-7, -2.5e20, 0.0]).to_vec();
        let joints = vec![joint("on", with([0.0, 1.0])), joint("a: \"b\"", with([-0.25, 3e-9]))];
        written(vec![0.0, end], joints)
    }

    /// What YAML 1.1 (yaml.org/type) takes for truth values and texts.
    #[test]
    fn names_are_quoted_and_numbers_have_a_point() {
        let text = two(1.5).unwrap();
        let expected = r#"header:
  stamp: {sec: 0, nanosec: 0}
  frame_id: ""
joint_names: ["on", "a: \"b\""]
points:
- positions: [0.0, -0.25]
  velocities: [1.0e-7, 1.0e-7]
  accelerations: [-2.5e20, -2.5e20]
  effort: []
  time_from_start: {sec: 0, nanosec: 0}
- positions: [1.0, 3.0e-9]
  velocities: [1.0e-7, 1.0e-7]
  accelerations: [-2.5e20, -2.5e20]
  effort: []
  time_from_start: {sec: 1, nanosec: 500000000}
"#;
        assert_eq!(text, expected);
    }

    /// Half a nanosecond at 4 rad/s.
    #[test]
    fn values_are_those_of_the_rounded_times() {
        let derivatives = vec![[1.0, 4.0, 0.0, 0.0]; 3];
        let text = written(vec![0.0, 0.5e-9 + 1.0, 2.0], vec![joint("a", derivatives)]).unwrap();
        assert!(text.contains("nanosec: 1}"), "{text}");
        let found = text.split("positions: [").nth(2).unwrap().split(']').next().unwrap();
        let found: f64 = found.parse().unwrap();
        assert!((found - (1.0 + 2e-9)).abs() < 1e-15, "{found}");
    }

    #[test]
    fn equal_time_stamps_are_refused() {
        assert!(two(1e-9).is_ok());
        let error = two(1e-10).unwrap_err().to_string();
        assert!(error.contains("counts nanoseconds"), "{error}");
    }
}
