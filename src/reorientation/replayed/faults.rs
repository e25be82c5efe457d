//! What of a motion through points is not as it should be.

use std::f64::consts::PI;

use serde::Serialize;

use crate::reorientation::excursions::{PathLimit, ToolEnd, Used};
use crate::robot::{Follow, JointKind};
use crate::task::Task;
use crate::trajectory::{Extent, Jump, Peaks, PointPath};

/// What is wrong with a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// A joint starts elsewhere than the task says.
    Start,
    /// A joint ends elsewhere than the task's goal says.
    End,
    /// The base ends too far from its goal.
    Goal,
    /// A limit on a rate is broken.
    RateLimit,
    /// A limit on an acceleration is broken.
    AccelerationLimit,
    /// A limit on a jerk is broken.
    JerkLimit,
    /// A joint leaves its range.
    Range,
    /// A joint is not where it follows another one to.
    Follow,
    /// A joint is not at rest at the start.
    StartRate,
    /// A joint is not at rest at the end.
    EndRate,
    /// Rates jump at points.
    RateJump,
    /// Accelerations jump at points, or where the motion starts or ends.
    AccelerationJump,
    /// Positions go nearly once round between two points.
    Wrapped,
    /// A limit on the way is broken.
    PathLimit,
    /// The tool ends too far from its goal.
    Tool,
    /// The tool ends turned too far from its goal.
    ToolTurn,
}

/// Something of a motion that is not as it should be. Angles in degrees, as for people.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Fault {
    /// What it is.
    pub kind: FaultKind,
    /// Of which joint, or of which joint most; none where it is the base's.
    pub joint: Option<String>,
    /// When, since the first point \[s\].
    pub at: f64,
    /// By how much.
    pub by: f64,
    /// In which unit.
    pub unit: &'static str,
    /// At how many points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<usize>,
    /// Which limit on the way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<PathLimit>,
}

/// By how much a share of a limit may exceed one, as elsewhere.
const KEPT: f64 = 1e-6;

/// A position that is the task's or within its range \[rad or m\].
const SAME_POSITION: f64 = 1e-6;

/// A rate that is none, and a jump that is none, as shares of the limits on rate and acceleration.
const NO_RATE: f64 = 1e-5;

/// How positions of joints are told.
pub(super) struct Shown<'a> {
    pub(super) name: &'a str,
    pub(super) kind: JointKind,
}

impl Shown<'_> {
    /// All of a task's joints.
    pub(super) fn all(task: &Task) -> Vec<Shown<'_>> {
        let joints = task.robot.joints();
        joints.map(|joint| Shown { name: joint.name, kind: joint.kind }).collect()
    }

    /// The unit of a position or one of its derivatives.
    fn unit(&self, order: usize) -> &'static str {
        match self.kind {
            JointKind::Revolute => ["°", "°/s", "°/s²", "°/s³"][order],
            JointKind::Prismatic => ["m", "m/s", "m/s²", "m/s³"][order],
        }
    }

    /// A position or one of its derivatives in its unit.
    pub(super) fn value(&self, value: f64) -> f64 {
        self.kind.to_file_units(value)
    }

    fn fault(&self, kind: FaultKind, order: usize, at: f64, by: f64) -> Fault {
        Fault {
            kind,
            joint: Some(self.name.to_owned()),
            at,
            by: self.value(by),
            unit: self.unit(order),
            points: None,
            limit: None,
        }
    }
}

/// All that is wrong with a motion.
pub(super) fn faults(
    task: &Task,
    path: &PointPath<'_>,
    residual: f64,
    peaks: &Peaks,
    extents: &[Extent],
) -> Vec<Fault> {
    let joints = Shown::all(task);
    let (points, duration) = (path.points(), path.points().duration());
    let mut faults = Vec::new();
    let ends = [
        (FaultKind::Start, points.positions(0), &task.start.joints, 0.0),
        (FaultKind::End, points.positions(points.count() - 1), &task.goal.joints, duration),
    ];
    // Where the goal is the tool's, joints may end anywhere that brings it there.
    let stated = if task.tool.is_some() { 1 } else { 2 };
    for (kind, found, expected, at) in ends.into_iter().take(stated) {
        let misses = found.iter().zip(expected).map(|(found, expected)| found - expected);
        let misses = joints.iter().zip(misses).filter(|(_, miss)| miss.abs() > SAME_POSITION);
        faults.extend(misses.map(|(joint, miss)| joint.fault(kind, 0, at, miss)));
    }
    if residual > task.goal_tolerance {
        let by = (residual - task.goal_tolerance).to_degrees();
        let (kind, joint, unit) = (FaultKind::Goal, None, "°");
        faults.push(Fault { kind, joint, at: duration, by, unit, points: None, limit: None });
    }
    for ((joint, peaks), limits) in joints.iter().zip(&peaks.0).zip(&task.limits.0) {
        let kinds = [FaultKind::RateLimit, FaultKind::AccelerationLimit, FaultKind::JerkLimit];
        for (order, kind) in kinds.into_iter().enumerate() {
            let (peak, limit) = (peaks[order], limits[order]);
            if peak.value > limit * (1.0 + KEPT) {
                let at = peak.tau * duration;
                faults.push(joint.fault(kind, order + 1, at, peak.value - limit));
            }
        }
    }
    for ((joint, extent), own) in joints.iter().zip(extents).zip(task.robot.joints()) {
        let beyond = [own.range[0] - extent.position[0], extent.position[1] - own.range[1]];
        let side = usize::from(beyond[1] > beyond[0]);
        if beyond[side] > SAME_POSITION {
            faults.push(joint.fault(FaultKind::Range, 0, extent.at[side], beyond[side]));
        }
    }
    faults.extend(astray(task, path, &joints));
    faults.extend(jumps(task, path, &joints));
    faults.extend(wrapped(path, &joints));
    faults
}

/// Limits on the way that are broken, by so much of each.
pub(super) fn on_the_way(used: &[Used]) -> impl Iterator<Item = Fault> + '_ {
    let broken = used.iter().filter(|used| used.share > 1.0 + KEPT);
    broken.map(|used| Fault {
        kind: FaultKind::PathLimit,
        joint: None,
        at: used.at,
        by: 100.0 * (used.share - 1.0),
        unit: "%",
        points: None,
        limit: Some(used.limit),
    })
}

/// What the tool misses its goal by, beyond what the base's tolerance leaves it.
pub(super) fn of_tool(task: &Task, end: Option<&ToolEnd>, at: f64) -> Vec<Fault> {
    let (Some(goal), Some(ToolEnd { miss, .. })) = (&task.tool, end) else { return Vec::new() };
    let lever = goal.target.position.map_or(0.0, |position| position.norm());
    let tolerance = task.goal_tolerance;
    let fault =
        |kind, by, unit| Fault { kind, joint: None, at, by, unit, points: None, limit: None };
    let place = (miss.position > SAME_POSITION + tolerance * lever)
        .then(|| fault(FaultKind::Tool, miss.position, "m"));
    let turn = (miss.angle > SAME_POSITION + tolerance)
        .then(|| fault(FaultKind::ToolTurn, miss.angle.to_degrees(), "°"));
    place.into_iter().chain(turn).collect()
}

/// Joints that do not follow others as they have to, each where it is furthest from there.
fn astray(task: &Task, path: &PointPath<'_>, joints: &[Shown<'_>]) -> Vec<Fault> {
    let points = path.points();
    let furthest = |(joint, follow): (usize, &Option<Follow>)| {
        let follow = follow.as_ref()?;
        let miss = |point: usize| {
            let positions = points.positions(point);
            (point, positions[joint] - follow.position(positions[follow.leader]))
        };
        let misses = (0..points.count()).map(miss);
        let (point, by) = misses.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
        let at = points.times()[point];
        (by.abs() > SAME_POSITION).then(|| joints[joint].fault(FaultKind::Follow, 0, at, by))
    };
    task.robot.follows().iter().enumerate().filter_map(furthest).collect()
}

/// What is not at rest at the ends, and what jumps.
fn jumps(task: &Task, path: &PointPath<'_>, joints: &[Shown<'_>]) -> Vec<Fault> {
    let last = path.segments();
    let mut rest = Vec::new();
    // Of rates and of accelerations the largest, as a share of the limit, and how many points have one.
    let mut worst: [Option<(f64, Jump)>; 2] = [None; 2];
    let mut counts = [0; 2];
    let mut counted = [usize::MAX; 2];
    path.jumps(|jump| {
        let limits = &task.limits.0[jump.joint];
        for order in 0..2 {
            let share = jump.by[order].abs() / limits[order];
            if share <= NO_RATE {
                continue;
            }
            if order == 0 && (jump.point == 0 || jump.point == last) {
                rest.push(jump);
                continue;
            }
            if counted[order] != jump.point {
                (counted[order], counts[order]) = (jump.point, counts[order] + 1);
            }
            if worst[order].is_none_or(|(most, _)| share > most) {
                worst[order] = Some((share, jump));
            }
        }
    });
    let at = |jump: &Jump| path.points().times()[jump.point];
    let rest = rest.iter().map(|jump| {
        let (kind, by) = if jump.point == 0 {
            (FaultKind::StartRate, jump.by[0])
        } else {
            (FaultKind::EndRate, -jump.by[0])
        };
        joints[jump.joint].fault(kind, 1, at(jump), by)
    });
    let kinds = [FaultKind::RateJump, FaultKind::AccelerationJump].into_iter().enumerate();
    let jumps = kinds.filter_map(|(order, kind)| {
        let (_, jump) = worst[order]?;
        let fault = joints[jump.joint].fault(kind, order + 1, at(&jump), jump.by[order]);
        Some(Fault { points: Some(counts[order]), ..fault })
    });
    rest.chain(jumps).collect()
}

/// Joints that seem to have angles within half a turn only, which then go round between two points.
fn wrapped(path: &PointPath<'_>, joints: &[Shown<'_>]) -> Vec<Fault> {
    let points = path.points();
    let step = |joint: usize| {
        let ends = |i: usize| [i, i + 1].map(|point| points.positions(point)[joint]);
        let wraps = |&i: &usize| {
            let [from, to] = ends(i);
            (to - from).abs() > PI && from.abs().max(to.abs()) <= PI + SAME_POSITION
        };
        let place = (0..path.segments()).find(wraps)?;
        let [from, to] = ends(place);
        Some(joints[joint].fault(FaultKind::Wrapped, 0, points.times()[place], to - from))
    };
    let turning = (0..joints.len()).filter(|&joint| joints[joint].kind == JointKind::Revolute);
    turning.filter_map(step).collect()
}

impl FaultKind {
    /// Whether it breaks a limit or a range: jumps break limits, since no limit allows them.
    pub fn breaks_a_limit(self) -> bool {
        use FaultKind::{End, Goal, Start, Tool, ToolTurn, Wrapped};
        !matches!(self, Start | End | Goal | Tool | ToolTurn | Wrapped)
    }
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { kind, joint, at, by, unit, points, limit } = self;
        let joint = joint.as_deref().unwrap_or("the base");
        let size = by.abs();
        // Degrees stand at their number.
        let unit = if *unit == "°" { "°".to_owned() } else { format!(" {unit}") };
        match kind {
            FaultKind::Start => write!(f, "{joint} starts {by:+.6}{unit} from the task's start"),
            FaultKind::End => write!(f, "{joint} ends {by:+.6}{unit} from the task's goal"),
            FaultKind::Goal => write!(f, "{joint} ends {by:.6}{unit} beyond the goal's tolerance"),
            FaultKind::Tool => write!(f, "the tool ends {by:.6}{unit} from its goal"),
            FaultKind::ToolTurn => write!(f, "the tool ends turned by {by:.6}{unit} from its goal"),
            FaultKind::RateLimit | FaultKind::AccelerationLimit | FaultKind::JerkLimit => {
                let what = match kind {
                    FaultKind::RateLimit => "rate",
                    FaultKind::AccelerationLimit => "acceleration",
                    _ => "jerk",
                };
                write!(f, "the {what} of {joint} exceeds its limit by {size:.6}{unit} at {at:.6} s")
            }
            FaultKind::Range => {
                write!(f, "{joint} leaves its range by {size:.6}{unit} at {at:.6} s")
            }
            FaultKind::Follow => {
                write!(f, "{joint} is {by:+.6}{unit} from where its leader puts it at {at:.6} s")
            }
            FaultKind::StartRate => write!(f, "{joint} is not at rest at the start: {by:.6}{unit}"),
            FaultKind::EndRate => write!(f, "{joint} is not at rest at the end: {by:.6}{unit}"),
            FaultKind::RateJump | FaultKind::AccelerationJump => {
                let what = if *kind == FaultKind::RateJump { "rates" } else { "accelerations" };
                let points = points.unwrap_or_default();
                let s = if points == 1 { "" } else { "s" };
                write!(
                    f,
                    "{what} jump at {points} point{s}, most on {joint}: by {size:.6}{unit} at {at:.6} s"
                )
            }
            FaultKind::PathLimit => {
                let name = limit.map_or("a", PathLimit::name).replace('_', " ");
                if by.is_finite() {
                    write!(f, "the limit on the {name} is exceeded by {by:.4}{unit} at {at:.6} s")
                } else {
                    write!(f, "the limit on the {name} is broken at {at:.6} s: bodies touch")
                }
            }
            FaultKind::Wrapped => write!(
                f,
                "{joint} goes {by:+.3}{unit} between two points at {at:.6} s: are its angles cut to half a turn?"
            ),
        }
    }
}
