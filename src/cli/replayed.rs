//! What `replay` says of a trajectory.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::motion::residual;
use super::{CliError, say_json};
use crate::reorientation::{PointReading, ReadPath, Replayed, ReplayedJson};
use crate::words::plural;

/// A trajectory, and the names of its file and its task.
pub(super) struct Trajectory<'a> {
    pub(super) file: &'a Path,
    pub(super) task: &'a str,
    pub(super) replayed: &'a Replayed<'a>,
}

impl PointReading {
    /// What it is, for people.
    fn meaning(self) -> &'static str {
        match self {
            Self::Linear => "linear, since points have positions alone",
            Self::Cubic => "cubic, since points have positions and rates",
            Self::Quintic => "quintic, since points have positions, rates and accelerations",
            Self::Spline => "a cubic spline, smooth and at rest at both ends",
        }
    }

    /// The same of one that is not played.
    fn otherwise(self) -> &'static str {
        match self {
            Self::Linear => "linear, by positions alone",
            Self::Cubic => "cubic, by positions and rates",
            Self::Quintic => "quintic",
            Self::Spline => "smooth, a cubic spline through positions alone, at rest at both ends",
        }
    }
}

impl Trajectory<'_> {
    pub(super) fn say_json(&self, ignored: &[String]) -> Result<(), CliError> {
        #[derive(Serialize)]
        struct Named<'a> {
            trajectory: String,
            task: &'a str,
            #[serde(flatten)]
            replayed: ReplayedJson<'a>,
        }

        let replayed = ReplayedJson::new(self.replayed, ignored);
        let trajectory = self.file.display().to_string();
        say_json(&Named { trajectory, task: self.task, replayed })
    }
}

/// For people: where the base ends, what joints do, how it would be otherwise, and what is wrong.
impl fmt::Display for Trajectory<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, task, replayed } = self;
        let (points, played) = (replayed.points(), &replayed.played);
        let duration = points.duration();
        writeln!(f, "{} for {task}", file.display())?;
        writeln!(f, "  points         {} of {}", points.count(), plural(points.joints(), "joint"))?;
        write!(f, "  duration       {duration:.6} s")?;
        if points.start() != 0.0 {
            write!(f, " from {} s on", points.start())?;
        }
        writeln!(f)?;
        writeln!(f, "  played         {}", played.reading.meaning())?;
        let [x, y, z, w]: [f64; 4] = played.end.coords.into();
        let (roll, pitch, yaw) = played.end.euler_angles();
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(f64::to_degrees);
        writeln!(f, "  base ends at   w {w:.9}, x {x:.9}, y {y:.9}, z {z:.9}")?;
        writeln!(f, "                 yaw {yaw:.6}°, pitch {pitch:.6}°, roll {roll:.6}°")?;
        writeln!(f, "  base residual  {}", residual(played.residual, Some(played.residual_error)))?;
        write_joints(f, replayed)?;
        let (turn, rate) = (replayed.base_turn, replayed.base_rate);
        writeln!(
            f,
            "  on the way     the base is up to {:.3}° from its start (at {:.4} s), turning at up to {:.3} °/s (at {:.4} s)",
            turn.value.to_degrees(),
            turn.tau * duration,
            rate.value.to_degrees(),
            rate.tau * duration
        )?;
        let [linear, angular] = replayed.momentum;
        let expected = if replayed.task().angular_momentum.is_some() {
            "beside the task's own"
        } else {
            "expected zero"
        };
        writeln!(
            f,
            "  check          the momentum of all is at most {linear:.1e} N·s and {angular:.1e} N·m·s, {expected}"
        )?;
        if let Some(rate) = replayed.excursions.end_rate {
            let rate = rate.norm().to_degrees();
            writeln!(f, "  drift          at the end the base keeps turning at {rate:.4} °/s")?;
        }
        for other in &replayed.others {
            write_other(f, other, replayed)?;
        }
        if replayed.is_as_asked() {
            return write!(f, "  verdict        reaches the goal and keeps all limits and ranges");
        }
        if replayed.faults.is_empty() {
            return write!(f, "  verdict        it is not sure whether it reaches the goal");
        }
        write!(f, "  verdict        not as it should be:")?;
        for fault in &replayed.faults {
            write!(f, "\n    {fault}")?;
        }
        Ok(())
    }
}

/// Peaks joint by joint, with their times and shares of the limits.
fn write_joints(f: &mut fmt::Formatter<'_>, replayed: &Replayed<'_>) -> fmt::Result {
    let joints = replayed.joints();
    let name = |name: &str, unit: &str| {
        if unit == "m" { format!("{name} [m]") } else { name.to_owned() }
    };
    let names: Vec<String> = joints.iter().map(|joint| name(joint.name, joint.unit)).collect();
    let width = names.iter().map(|name| name.chars().count()).max().unwrap_or_default().max(12);
    let heads = if joints.iter().any(|joint| joint.unit == "m") {
        ["rate [unit/s]", "acceleration [unit/s²]", "jerk [unit/s³]"]
    } else {
        ["rate [°/s]", "acceleration [°/s²]", "jerk [°/s³]"]
    };
    write!(f, "  {:<width$}", "joint")?;
    let [rate, acceleration, jerk] = heads;
    writeln!(f, "   {rate:<29}   {acceleration:<29}   {jerk}")?;
    for (joint, name) in joints.iter().zip(names) {
        write!(f, "  {name:<width$}")?;
        for peak in [joint.rate, joint.acceleration, joint.jerk] {
            let share = 100.0 * peak.share;
            write!(f, "   {:>9.4} ({share:>4.0} %) at {:>7.3} s", peak.peak, peak.at)?;
        }
        writeln!(f)?;
    }
    Ok(())
}

/// What the motion comes to where it is read in another way.
fn write_other(
    f: &mut fmt::Formatter<'_>,
    other: &ReadPath,
    replayed: &Replayed<'_>,
) -> fmt::Result {
    let [rate, acceleration, jerk] =
        [0, 1, 2].map(|order| 100.0 * other.largest_share(replayed.task(), order));
    writeln!(f, "  read otherwise {}:", other.reading.otherwise())?;
    writeln!(
        f,
        "                 residual {}, and up to {rate:.0} % of the limits on rates, {acceleration:.0} % on accelerations, \
         {jerk:.0} % on jerks",
        residual(other.residual, Some(other.residual_error))
    )
}
