//! ROS `trajectory_msgs/JointTrajectory`.

use serde::Serialize;

use super::ExportError;
use crate::reorientation::motion::Motion;

#[derive(Serialize)]
struct JointTrajectory<'a> {
    header: Header,
    joint_names: Vec<&'a str>,
    points: Vec<Point>,
}

#[derive(Serialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}

#[derive(Serialize)]
struct Time {
    sec: u32,
    nanosec: u32,
}

#[derive(Serialize)]
struct Point {
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
    effort: Vec<f64>,
    time_from_start: Time,
}

/// The motion as YAML; the message has no place for jerks and for the base.
pub(super) fn motion(motion: &Motion) -> Result<Vec<u8>, ExportError> {
    // The message counts seconds in 32 bits with a sign.
    if motion.time.iter().any(|&time| !(0.0..=f64::from(i32::MAX)).contains(&time)) {
        let reason = "the motion is too long for the message's clock".to_owned();
        return Err(ExportError::Format { format: "YAML", reason });
    }
    let points = motion.time.iter().enumerate().map(|(i, &time)| {
        let all = |order: usize| motion.joints.iter().map(|j| j.derivatives[i][order]).collect();
        Point {
            positions: all(0),
            velocities: all(1),
            accelerations: all(2),
            effort: Vec::new(),
            time_from_start: duration(time),
        }
    });
    let message = JointTrajectory {
        header: Header { stamp: duration(0.0), frame_id: String::new() },
        joint_names: motion.joints.iter().map(|joint| joint.name.as_str()).collect(),
        points: points.collect(),
    };
    let text = serde_yaml_ng::to_string(&message)
        .map_err(|e| ExportError::Format { format: "YAML", reason: e.to_string() })?;
    Ok(text.into_bytes())
}

fn duration(seconds: f64) -> Time {
    let nanoseconds = (seconds * 1e9).round() as u64;
    Time {
        sec: u32::try_from(nanoseconds / 1_000_000_000).unwrap_or(u32::MAX),
        nanosec: (nanoseconds % 1_000_000_000) as u32,
    }
}
