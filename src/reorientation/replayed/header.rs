//! What the columns of a table are, by their names.
//!
//! Joints are found by name, also within what loggers make of names: `elbow_vel`, `qd_elbow`, `elbow [deg/s]`,
//! `/joint_states/elbow/position`.

use super::error::{Source, TrajectoryError, cut, listed};
use super::units::{AngleUnit, Measure, UNREAD, split_unit};
use crate::input::nearest;
use crate::reorientation::export;
use crate::robot::{JointKind, Robot};

/// What a column has: of a joint or, in a long table, of the row's joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Values {
    /// The joint of a wide table; zero in a long one.
    pub(super) joint: usize,
    /// 0 for positions, 1 for rates, 2 for accelerations.
    pub(super) order: usize,
    pub(super) column: usize,
}

/// The columns of a table.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub(super) time: usize,
    /// How many seconds one of the column's is.
    pub(super) seconds: f64,
    /// The column with joints' names, of a long table.
    pub(super) joint: Option<usize>,
    pub(super) values: Vec<Values>,
    /// Whether rates and accelerations are there, besides positions.
    pub(super) has: [bool; 3],
    /// How much of a radian, or of a metre, the number 1 is, for each joint of the robot.
    pub(super) scales: Vec<f64>,
    /// Names of columns that have nothing to do with the joints' motion.
    pub(super) ignored: Vec<String>,
}

/// Columns of an exported table with a row for each time and joint, but for its `unit`; those after them may be missing.
const LEAST_OWN: usize = 10;

const TIMES: [&str; 6] = ["time", "t", "__time", "timestamp", "time_from_start", "%time"];

const JOINTS: [&str; 5] = ["joint", "joint_name", "jointname", "name", "variable"];

/// What columns call positions, rates and accelerations, and what else they have of joints.
const WORDS: [&[&str]; 4] = [
    &["position", "positions", "pos", "angle", "q", "theta"],
    &["velocity", "velocities", "vel", "rate", "speed", "qd", "dq", "dot", "qdot"],
    &["acceleration", "accelerations", "acc", "accel", "qdd", "ddq", "ddot", "qddot"],
    &["jerk", "effort", "efforts", "torque", "tau", "current"],
];

/// The column of exported tables that tells radians from metres.
pub(super) const UNIT: &str = "unit";

const SEPARATORS: [char; 6] = ['_', '.', '/', '-', ':', ' '];

/// What a column is by its name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Time(Option<f64>),
    Joint,
    /// Of a joint, or of the row's where none is named.
    Of {
        joint: Option<usize>,
        order: usize,
        unit: Option<Measure>,
    },
    Other,
}

impl Header {
    /// The columns with these names; `unit` is that of angles where no name states one.
    pub(super) fn read(
        names: &[String],
        robot: &Robot,
        unit: Option<AngleUnit>,
        source: Source<'_>,
    ) -> Result<Self, TrajectoryError> {
        Self::of(names, robot, unit).map_err(|message| {
            if source.is_text { source.error_at(1, message) } else { source.error(message) }
        })
    }

    fn of(names: &[String], robot: &Robot, unit: Option<AngleUnit>) -> Result<Self, String> {
        let joints: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
        let trimmed = || names.iter().map(|name| name.trim());
        let is_wide_own = trimmed().eq(export::header(robot.joints().map(|j| (j.name, j.kind))));
        let columns: Vec<Column> = if is_wide_own {
            (0..names.len()).map(|place| Column::of_wide(place, joints.len())).collect()
        } else {
            trimmed().map(|name| Column::of(name, &joints)).collect()
        };
        let find = |is: fn(&Column) -> bool| columns.iter().position(is);
        let Some(time) = find(|column| matches!(column, Column::Time(_))) else {
            let found = listed(names.iter().map(String::as_str));
            return Err(format!("found the columns {found}, expected one called `time`"));
        };
        let seconds = if let Column::Time(Some(unit)) = columns[time] { unit } else { 1.0 };
        let joint = find(|column| *column == Column::Joint);
        let mut values: Vec<Values> = Vec::new();
        let mut units: Vec<(Values, Measure)> = Vec::new();
        let mut ignored = Vec::new();
        for (place, column) in columns.iter().enumerate() {
            match *column {
                Column::Of { joint: own, order, unit }
                    if order != UNREAD && own.is_none() == joint.is_some() =>
                {
                    let own = Values { joint: own.unwrap_or(0), order, column: place };
                    let is_twin = |v: &&Values| (v.joint, v.order) == (own.joint, order);
                    if let Some(twin) = values.iter().find(is_twin) {
                        let twins = listed([&*names[twin.column], &*names[place]]);
                        return Err(format!("found the columns {twins}, expected one of them"));
                    }
                    units.extend(unit.map(|unit| (own, unit)));
                    values.push(own);
                }
                _ if place == time || Some(place) == joint || names[place].is_empty() => {}
                _ => ignored.push(names[place].clone()),
            }
        }
        let has = [0, 1, 2].map(|order| values.iter().any(|v| v.order == order));
        if joint.is_some() && !has[0] {
            let found = listed(names.iter().map(String::as_str));
            return Err(format!("found the columns {found}, expected one called `position`"));
        }
        if joint.is_none() {
            check_all_there(&values, has, robot, &ignored)?;
            check_kinds(&units, names, robot)?;
        }
        // Where joints slide, exported tables say the unit row by row, which is always SI.
        let own = [vec!["time", "joint"], export::number_columns()].concat();
        let found: Vec<&str> = trimmed().filter(|name| *name != UNIT).collect();
        let is_own = is_wide_own || found.len() >= LEAST_OWN && own.starts_with(&found);
        let has_units = joint.is_some() && trimmed().any(|name| name == UNIT);
        if has_units && !is_own {
            return Err("found a column `unit`, expected the unit of angles in the names of the columns, or by `--unit`".to_owned());
        }
        if is_own {
            // Jerks, torques and the base follow from the rest.
            ignored.clear();
        }
        let stated = if is_own { Some(AngleUnit::Rad) } else { stated_unit(&units, names)? };
        let scale = match (stated, unit) {
            (Some(stated), Some(asked)) if stated != asked => {
                let name = if stated == AngleUnit::Rad { "radians" } else { "degrees" };
                return Err(format!("found angles in {name}, expected another unit by `--unit`"));
            }
            (stated, unit) => match stated.or(unit) {
                Some(AngleUnit::Deg) => 1f64.to_radians(),
                None if robot_turns(robot).any(|turns| turns) => {
                    let message = "found no unit of angles in the names of the columns, such as `elbow [deg]`, expected \
                        `--unit rad` or `--unit deg`";
                    return Err(message.to_owned());
                }
                Some(AngleUnit::Rad) | None => 1.0,
            },
        };
        let scales = robot_turns(robot).map(|turns| if turns { scale } else { 1.0 }).collect();
        Ok(Self { time, seconds, joint, values, has, scales, ignored })
    }
}

/// Whether a wide table has positions of all joints, and rates and accelerations of all or none.
fn check_all_there(
    values: &[Values],
    has: [bool; 3],
    robot: &Robot,
    ignored: &[String],
) -> Result<(), String> {
    for (order, what) in ["position", "rate", "acceleration"].into_iter().enumerate() {
        let lacks = |joint: usize| !values.iter().any(|v| (v.joint, v.order) == (joint, order));
        let missing = robot.joints().enumerate().filter(|(joint, _)| lacks(*joint));
        let missing: Vec<&str> = missing.map(|(_, joint)| joint.name).collect();
        if missing.is_empty() || order > 0 && !has[order] {
            continue;
        }
        let near = ignored.iter().find_map(|name| Some((name, nearest(name, missing.clone())?)));
        let near = near.map_or_else(String::new, |(name, near)| {
            format!("; is `{}` meant for `{near}`?", cut(name))
        });
        return Err(format!(
            "found no {what} of {}, expected a column for each joint of robot `{}`{near}",
            listed(missing),
            robot.name()
        ));
    }
    Ok(())
}

/// Whether the units of a wide table are those of joints that turn, or slide, as theirs do.
fn check_kinds(units: &[(Values, Measure)], names: &[String], robot: &Robot) -> Result<(), String> {
    let turns: Vec<bool> = robot_turns(robot).collect();
    for (own, unit) in units {
        let is_of_angle = matches!(unit, Measure::Angle(_));
        if turns[own.joint] != is_of_angle {
            let name = cut(&names[own.column]);
            let (does, expected) =
                if is_of_angle { ("slides", "metres") } else { ("turns", "radians or degrees") };
            return Err(format!(
                "found the column `{name}` of a joint that {does}, expected {expected}"
            ));
        }
    }
    Ok(())
}

/// Whether each joint turns; the others slide.
fn robot_turns(robot: &Robot) -> impl Iterator<Item = bool> {
    robot.joints().map(|joint| joint.kind == JointKind::Revolute)
}

/// The unit of all angles, if their columns state one.
fn stated_unit(units: &[(Values, Measure)], names: &[String]) -> Result<Option<AngleUnit>, String> {
    let angles = units.iter().filter_map(|(own, unit)| match unit {
        Measure::Angle(unit) => Some((own.column, *unit)),
        _ => None,
    });
    let mut angles = angles.peekable();
    let Some(&(first, unit)) = angles.peek() else { return Ok(None) };
    match angles.find(|(_, other)| *other != unit) {
        Some((column, _)) => {
            let both = listed([&*names[first], &*names[column]]);
            Err(format!("found two units in the columns {both}, expected one for all angles"))
        }
        None => Ok(Some(unit)),
    }
}

impl Column {
    /// What stands there in an exported table with a row for each time.
    fn of_wide(place: usize, joints: usize) -> Self {
        match place.checked_sub(1) {
            None => Self::Time(Some(1.0)),
            Some(place) if place < UNREAD * joints => {
                Self::Of { joint: Some(place % joints), order: place / joints, unit: None }
            }
            Some(_) => Self::Other,
        }
    }

    fn of(name: &str, joints: &[&str]) -> Self {
        let exact = |text: &str| joints.iter().position(|joint| *joint == text);
        if let Some(joint) = exact(name) {
            return Self::Of { joint: Some(joint), order: 0, unit: None };
        }
        let (stem, unit, unit_order) = split_unit(name);
        let lower = stem.to_ascii_lowercase();
        if TIMES.contains(&&*lower) {
            return match unit {
                Some(Measure::Time(seconds)) => Self::Time(Some(seconds)),
                // As `rostopic echo -p` has it, in nanoseconds.
                _ => Self::Time((lower == "%time").then_some(1e-9)),
            };
        }
        if JOINTS.contains(&&*lower) && unit.is_none() {
            return Self::Joint;
        }
        if let Some(order) = word_order(&lower) {
            return Self::Of { joint: None, order, unit };
        }
        let mut rest = stem;
        let mut order = None;
        loop {
            let own = exact(rest).or_else(|| {
                let (path, last) = rest.rsplit_once('/')?;
                let joint = exact(last)?;
                let of_path =
                    path.split('/').find_map(|part| word_order(&part.to_ascii_lowercase()));
                order = order.or(of_path);
                Some(joint)
            });
            if let Some(joint) = own {
                let order = order.or(unit_order).unwrap_or(0);
                return Self::Of { joint: Some(joint), order, unit };
            }
            let Some((shorter, found)) = stripped(rest) else { return Self::Other };
            rest = shorter;
            order = order.or(Some(found));
        }
    }
}

/// Which derivative a word stands for.
fn word_order(word: &str) -> Option<usize> {
    WORDS.iter().position(|words| words.contains(&word))
}

/// A name without the word at its end or its start that says which derivative it is.
fn stripped(name: &str) -> Option<(&str, usize)> {
    let end = name
        .rsplit_once(SEPARATORS)
        .and_then(|(rest, word)| Some((rest, word_order(&word.to_ascii_lowercase())?)));
    end.or_else(|| {
        let (word, rest) = name.split_once(SEPARATORS)?;
        Some((rest, word_order(&word.to_ascii_lowercase())?))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINTS: [&str; 3] = ["elbow", "wrist_pos", "rad"];

    fn of(name: &str) -> Option<(usize, usize, Option<AngleUnit>)> {
        match Column::of(name, &JOINTS) {
            Column::Of { joint: Some(joint), order, unit } => {
                let unit = match unit {
                    Some(Measure::Angle(unit)) => Some(unit),
                    _ => None,
                };
                Some((joint, order, unit))
            }
            _ => None,
        }
    }

    /// Names as they stand in files of `PlotJuggler`, MATLAB's `writetable` and hand-made scripts.
    #[test]
    fn columns_of_joints_are_found() {
        use AngleUnit::{Deg, Rad};
        for (name, expected) in [
            ("elbow", Some((0, 0, None))),
            ("wrist_pos", Some((1, 0, None))),
            ("wrist_pos_vel", Some((1, 1, None))),
            ("rad", Some((2, 0, None))),
            ("rad_rad", Some((2, 0, Some(Rad)))),
            ("elbow [deg]", Some((0, 0, Some(Deg)))),
            ("elbow (rad)", Some((0, 0, Some(Rad)))),
            ("elbow_deg", Some((0, 0, Some(Deg)))),
            ("elbow_deg_s2", Some((0, 2, Some(Deg)))),
            ("elbow [rad/s]", Some((0, 1, Some(Rad)))),
            ("elbow_velocity [°/s]", Some((0, 1, Some(Deg)))),
            ("q_elbow", Some((0, 0, None))),
            ("qdd_elbow", Some((0, 2, None))),
            ("elbow_dot", Some((0, 1, None))),
            ("elbow.Velocity", Some((0, 1, None))),
            ("/joint_states/elbow/position", Some((0, 0, None))),
            ("/joint_states/velocity/elbow", Some((0, 1, None))),
            ("/joint_states/elbow/effort", Some((0, UNREAD, None))),
            ("elbow [m]", Some((0, 0, None))),
            ("shoulder", None),
            ("elbow_grad", None),
            ("", None),
        ] {
            assert_eq!(of(name), expected, "{name}");
        }
        for (name, seconds) in
            [("time", None), ("Time [s]", Some(1.0)), ("t_ms", Some(1e-3)), ("%time", Some(1e-9))]
        {
            assert_eq!(Column::of(name, &JOINTS), Column::Time(seconds), "{name}");
        }
        assert_eq!(Column::of("joint", &JOINTS), Column::Joint);
        for (name, order) in [("angle_rad", 0), ("rate", 1), ("Acceleration", 2), ("jerk", UNREAD)]
        {
            let Column::Of { joint: None, order: found, .. } = Column::of(name, &JOINTS) else {
                panic!("{name}")
            };
            assert_eq!(found, order);
        }
    }
}
