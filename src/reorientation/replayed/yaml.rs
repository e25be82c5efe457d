//! ROS `trajectory_msgs/JointTrajectory` as YAML: what `ros2 topic echo` prints, also nested in a goal of an action.

use std::fmt;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::marker::PhantomData;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_saphyr::{Error, Options, Spanned};

use super::collect::{MOST_BYTES, MOST_POINTS, Track, checked, missing_joints, unknown};
use super::error::{Source, TrajectoryError, cut};
use crate::robot::Robot;
use crate::trajectory::Points;

/// Most joints of a message, and most trajectories in a file.
const MOST_JOINTS: usize = 1000;

/// Scalars, lists and tables of the longest trajectory of thirty joints; what anchors repeat counts again.
const MOST_NODES: usize = MOST_POINTS * 100;

/// A list of so many items at most.
#[derive(Debug)]
struct Few<T, const MOST: usize>(Vec<T>);

impl<'de, T: Deserialize<'de>, const MOST: usize> Deserialize<'de> for Few<T, MOST> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct List<T, const MOST: usize>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>, const MOST: usize> Visitor<'de> for List<T, MOST> {
            type Value = Vec<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Vec<T>, A::Error> {
                let mut all = Vec::new();
                while let Some(item) = items.next_element()? {
                    if all.len() == MOST {
                        let message = format!("found more than {MOST} items, expected fewer");
                        return Err(A::Error::custom(message));
                    }
                    all.push(item);
                }
                Ok(all)
            }
        }

        deserializer.deserialize_seq(List::<T, MOST>(PhantomData)).map(Self)
    }
}

/// The message, or one that has it in a field.
#[derive(Debug, Deserialize)]
struct Message {
    joint_names: Option<Spanned<Few<String, MOST_JOINTS>>>,
    points: Option<Spanned<Few<Spanned<Point>, MOST_POINTS>>>,
    trajectory: Option<Box<Message>>,
    joint_trajectory: Option<Box<Message>>,
    goal: Option<Box<Message>>,
}

#[derive(Debug, Deserialize)]
struct Point {
    positions: Few<f64, MOST_JOINTS>,
    velocities: Option<Few<f64, MOST_JOINTS>>,
    accelerations: Option<Few<f64, MOST_JOINTS>>,
    time_from_start: Clock,
}

/// A time; of ROS 2, or of ROS 1.
#[derive(Debug, Deserialize)]
struct Clock {
    #[serde(alias = "secs")]
    sec: i64,
    #[serde(alias = "nsecs")]
    nanosec: i64,
}

impl Clock {
    fn seconds(&self) -> f64 {
        self.sec as f64 + self.nanosec as f64 * 1e-9
    }
}

/// The points of the only trajectory in a file.
pub(super) fn read(
    file: File,
    robot: &Robot,
    source: Source<'_>,
) -> Result<Points, TrajectoryError> {
    let mut found = None;
    let mut file = file.take(MOST_BYTES);
    for message in serde_saphyr::read_with_options::<_, Message>(&mut file, options()) {
        let message = message.map_err(|error| wrong(error, source))?;
        let message = innermost(message);
        if message.joint_names.is_none() && message.points.is_none() {
            return Err(source.error(
                "found neither `joint_names` nor `points`, expected a ROS JointTrajectory",
            ));
        }
        if found.replace(message).is_some() {
            return Err(source.error("found more than one trajectory, expected one"));
        }
    }
    let Some(Message { joint_names, points, .. }) = found else {
        return Err(source.error("found an empty file, expected a ROS JointTrajectory"));
    };
    let Some(names) = joint_names else {
        return Err(source.error("found no `joint_names`, expected those of the robot's joints"));
    };
    let Some(points) = points else {
        return Err(source.error("found no `points`, expected a list"));
    };
    let places = places(&names, robot, source)?;
    let mut track = Track::default();
    for point in points.value.0 {
        add(&mut track, &point, &places, source)?;
    }
    track.finish(places.len(), source)
}

fn options() -> Options {
    let mut options = Options::default();
    options.with_snippet = false;
    if let Some(budget) = &mut options.budget {
        budget.max_reader_input_bytes = Some(MOST_BYTES as usize);
        budget.max_events = 2 * MOST_NODES;
        budget.max_nodes = MOST_NODES;
        budget.max_total_scalar_bytes = MOST_BYTES as usize;
        // Python's writer shares lists that are the same, such as empty efforts, among all points.
        budget.max_aliases = 3 * MOST_POINTS;
        budget.enforce_alias_anchor_ratio = false;
    }
    options.alias_limits.max_total_replayed_events = MOST_NODES;
    options.alias_limits.max_alias_expansions_per_anchor = 3 * MOST_POINTS;
    options
}

fn innermost(mut message: Message) -> Message {
    while message.joint_names.is_none() && message.points.is_none() {
        let Message { trajectory, joint_trajectory, goal, .. } = &mut message;
        match trajectory.take().or(joint_trajectory.take()).or(goal.take()) {
            Some(inner) => message = *inner,
            None => break,
        }
    }
    message
}

/// For every joint of the robot its place in the message.
fn places(
    names: &Spanned<Few<String, MOST_JOINTS>>,
    robot: &Robot,
    source: Source<'_>,
) -> Result<Vec<usize>, TrajectoryError> {
    let line = names.referenced.line();
    let names: Vec<&str> = names.value.0.iter().map(String::as_str).collect();
    let twin = (1..names.len()).find(|&i| names[..i].contains(&names[i]));
    if let Some(twin) = twin {
        let message = format!("found the joint `{}` twice, expected it once", cut(names[twin]));
        return Err(source.error_at(line, message));
    }
    let known: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
    let mut others = names.iter().copied().filter(|name| !known.contains(name)).peekable();
    if others.peek().is_some() {
        return Err(source.error_at(line, unknown(others, robot)));
    }
    let missing: Vec<&str> = known.iter().copied().filter(|name| !names.contains(name)).collect();
    if !missing.is_empty() {
        return Err(source.error_at(line, missing_joints(missing, robot)));
    }
    Ok(known.iter().filter_map(|known| names.iter().position(|name| name == known)).collect())
}

/// Adds a point, in the robot's order.
fn add(
    track: &mut Track,
    point: &Spanned<Point>,
    places: &[usize],
    source: Source<'_>,
) -> Result<(), TrajectoryError> {
    let line = point.referenced.line();
    let Point { positions, velocities, accelerations, time_from_start } = &point.value;
    let is_first = track.times.is_empty();
    track.push_time(time_from_start.seconds(), line, source)?;
    let lists = [Some(positions), velocities.as_ref(), accelerations.as_ref()];
    for (order, list) in lists.into_iter().enumerate() {
        let list = list.map_or(&[][..], |list| &list.0);
        let what = ["positions", "velocities", "accelerations"][order];
        let values = &mut track.values[order];
        let is_used = order == 0 || if is_first { !list.is_empty() } else { !values.is_empty() };
        let expected = if is_used { places.len() } else { 0 };
        if list.len() != expected {
            let why = if order == 0 || is_used && !list.is_empty() {
                "one for each joint"
            } else {
                "as at the first point"
            };
            let message = format!("found {} {what}, expected {expected}, {why}", list.len());
            return Err(source.error_at(line, message));
        }
        if is_used {
            for &place in places {
                values.push(checked(list[place], line, source)?);
            }
        }
    }
    Ok(())
}

/// What is wrong, and where, in the reader's words.
fn wrong(error: serde_saphyr::Error, source: Source<'_>) -> TrajectoryError {
    let line = error.location().map(|place| place.line());
    let text = error.to_string();
    let message = match error {
        Error::IOError { cause } if cause.kind() == ErrorKind::InvalidData => {
            "found bytes that are not text, expected UTF-8".to_owned()
        }
        Error::IOError { cause } => return source.unreadable(cause),
        // What the reader says of its own limits is for programmers.
        _ if text.starts_with("budget breached") || text.contains("alias") => {
            "found lists that repeat others without end, expected a ROS JointTrajectory".to_owned()
        }
        Error::DuplicateMappingKey { .. } => "found a key twice, expected it once".to_owned(),
        _ => {
            let text = text.split(" at line ").next().unwrap_or_default();
            format!("expected a ROS JointTrajectory: {}", cut(text))
        }
    };
    match line {
        Some(line) => source.error_at(line, message),
        None => source.error(message),
    }
}
