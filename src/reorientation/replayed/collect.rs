//! From rows, in whatever order a file has them, to points.

use super::error::{Source, TrajectoryError, listed};
use super::header::Header;
use crate::robot::Robot;
use crate::trajectory::Points;

/// Bytes of the largest file.
pub(super) const MOST_BYTES: u64 = 1 << 30;

/// Most points of a trajectory.
pub(super) const MOST_POINTS: usize = 1_000_000;

/// The largest time \[s\] and the largest position, rate and acceleration: beyond, it is a mistake.
const LARGEST: f64 = 1e12;

/// The shortest time between two points \[s\], since clocks of robots count nanoseconds.
const SHORTEST: f64 = 1e-9;

/// The points of one joint, or of all.
#[derive(Debug, Default)]
pub(super) struct Track {
    pub(super) times: Vec<f64>,
    /// Positions, rates and accelerations.
    pub(super) values: [Vec<f64>; 3],
    /// The rows that they stand in.
    pub(super) rows: Vec<u64>,
}

/// Rows of a table on their way to points.
pub(super) struct Collector<'a> {
    source: Source<'a>,
    header: &'a Header,
    robot: &'a Robot,
    names: Vec<&'a str>,
    /// One for all joints of a wide table, one for each of a long one.
    tracks: Vec<Track>,
}

impl<'a> Collector<'a> {
    pub(super) fn new(header: &'a Header, robot: &'a Robot, source: Source<'a>) -> Self {
        let names: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
        let count = if header.joint.is_some() { names.len() } else { 1 };
        let tracks = (0..count).map(|_| Track::default()).collect();
        Self { source, header, robot, names, tracks }
    }

    /// Takes a row; `number` gives the number in a column, `joint` the joint's name in a long table.
    pub(super) fn take(
        &mut self,
        row: u64,
        joint: Option<&str>,
        mut number: impl FnMut(usize) -> Result<f64, TrajectoryError>,
    ) -> Result<(), TrajectoryError> {
        let place = match joint {
            None => 0,
            Some(name) => self
                .names
                .iter()
                .position(|known| *known == name)
                .ok_or_else(|| self.source.error_at(row, unknown([name], self.robot)))?,
        };
        let time = number(self.header.time)? * self.header.seconds;
        let track = &mut self.tracks[place];
        if let Some(name) = joint.filter(|_| track.times.last() == Some(&time)) {
            let message = format!("found `{name}` twice at {time} s, expected it once");
            return Err(self.source.error_at(row, message));
        }
        track.push_time(time, row, self.source)?;
        let width = if joint.is_some() { 1 } else { self.names.len() };
        for (values, has) in track.values.iter_mut().zip(self.header.has) {
            values.resize(values.len() + if has { width } else { 0 }, 0.0);
        }
        for value in &self.header.values {
            let scale = self.header.scales[if joint.is_some() { place } else { value.joint }];
            let number = checked(number(value.column)?, row, self.source)? * scale;
            let values = &mut track.values[value.order];
            let at = values.len() - width + value.joint;
            values[at] = number;
        }
        Ok(())
    }

    /// The points.
    pub(super) fn finish(self) -> Result<Points, TrajectoryError> {
        let Self { source, robot, names, mut tracks, header } = self;
        if header.joint.is_none() {
            return tracks.remove(0).finish(names.len(), source);
        }
        let empty = names.iter().zip(&tracks).filter(|(_, track)| track.times.is_empty());
        let missing: Vec<&str> = empty.map(|(name, _)| *name).collect();
        if !missing.is_empty() && missing.len() < names.len() {
            return Err(source.error(missing_joints(missing, robot)));
        }
        let mut all = Track::default();
        let count = tracks[0].times.len();
        for (name, track) in names.iter().zip(&tracks) {
            for i in 0..count.max(track.times.len()) {
                let [first, own] = [&tracks[0], track].map(|track| track.times.get(i));
                if first != own {
                    let row =
                        track.rows.get(i).or(tracks[0].rows.get(i)).copied().unwrap_or_default();
                    let at = first.or(own).copied().unwrap_or_default();
                    let message = format!(
                        "found times of `{name}` that differ from those of `{}` from {at} s on, expected all joints at each time",
                        names[0]
                    );
                    return Err(source.error_at(row, message));
                }
            }
        }
        for i in 0..count {
            for (order, values) in all.values.iter_mut().enumerate().filter(|(k, _)| header.has[*k])
            {
                values.extend(tracks.iter().map(|track| track.values[order][i]));
            }
        }
        all.times = std::mem::take(&mut tracks[0].times);
        all.rows = std::mem::take(&mut tracks[0].rows);
        all.finish(names.len(), source)
    }
}

impl Track {
    /// The next time \[s\], in its row.
    pub(super) fn push_time(
        &mut self,
        time: f64,
        row: u64,
        source: Source<'_>,
    ) -> Result<(), TrajectoryError> {
        checked(time, row, source)?;
        if let Some(&before) = self.times.last().filter(|before| time - **before < SHORTEST) {
            let message = if time > before {
                format!(
                    "found a point less than a nanosecond after {before} s, expected times further apart"
                )
            } else {
                format!("found the time {time} s after {before} s, expected times that grow")
            };
            return Err(source.error_at(row, message));
        }
        if self.times.len() == MOST_POINTS {
            let message = format!("found more than {MOST_POINTS} points, expected fewer");
            return Err(source.error_at(row, message));
        }
        self.times.push(time);
        self.rows.push(row);
        Ok(())
    }

    /// The points.
    pub(super) fn finish(
        self,
        joints: usize,
        source: Source<'_>,
    ) -> Result<Points, TrajectoryError> {
        let [_, rates, accelerations] = &self.values;
        if !accelerations.is_empty() && rates.is_empty() {
            return Err(source.error("found accelerations without rates, expected both or neither"));
        }
        match self.times.len() {
            0 => Err(source.error("found no points, expected at least two")),
            1 => Err(source.error("found one point, expected at least two")),
            _ => Ok(Points::new(self.times, joints, self.values)),
        }
    }
}

/// A number that a motion can have.
pub(super) fn checked(value: f64, row: u64, source: Source<'_>) -> Result<f64, TrajectoryError> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    let expected = if value.is_finite() { "a smaller one" } else { "a finite one" };
    Err(source.error_at(row, format!("found the number {value:?}, expected {expected}")))
}

/// That there are joints which the robot has not.
pub(super) fn unknown<'a>(names: impl IntoIterator<Item = &'a str>, robot: &Robot) -> String {
    format!(
        "found the unknown joint {}, expected those of robot `{}`: {}",
        listed(names),
        robot.name(),
        listed(robot.joints().map(|joint| joint.name))
    )
}

/// That there are joints which have no motion.
pub(super) fn missing_joints<'a>(
    names: impl IntoIterator<Item = &'a str>,
    robot: &Robot,
) -> String {
    format!("found nothing of {}, expected all joints of robot `{}`", listed(names), robot.name())
}
