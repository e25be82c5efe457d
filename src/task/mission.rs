//! Tasks of several motions, one after the other: a robot comes to rest at every stop.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use toml::Spanned;

use super::file::{TaskTable, efforts, robust};
use super::keep_out::KeepOut;
use super::pose::ViaTable;
use super::reader::Reader;
use super::tool_goal::ToolTable;
use super::uncertainty::{RobustTable, UncertaintyTable};
use super::{ClearanceLimit, Posture, Task};
use crate::input::{Document, InputError};
use crate::robot::{Outfit, PayloadTable, Robot};
use crate::straight::{Straight, StraightError, StraightPath};

/// A task of several motions.
#[derive(Debug, Clone)]
pub struct Mission {
    document: Document,
    /// From its start to its goal, whatever lies between.
    pub ends: Task,
    keep_out: KeepOut,
    uncertainty: Option<UncertaintyTable>,
    robust: Option<Spanned<RobustTable>>,
    /// How the tool leaves the start.
    retreat: Option<(Straight, Range<usize>)>,
    stops: Vec<Stop>,
}

/// Where the robot comes to rest.
#[derive(Debug, Clone)]
struct Stop {
    name: String,
    place: Place,
    base: UnitQuaternion<f64>,
    span: Range<usize>,
    load: Load,
}

/// What becomes of the tool's load at a stop.
#[derive(Debug, Clone, Default)]
enum Load {
    #[default]
    Same,
    /// What it catches, and the angular momentum of that about its own centre of mass, inertial axes \[N·m·s\].
    Capture(Box<Spanned<PayloadTable>>, Vector3<f64>),
    /// What it has caught is let go of; where the file says so.
    Release(Range<usize>),
}

/// Where a mission stands.
#[derive(Debug, Clone)]
pub struct Standing {
    /// The robot, with what it carries.
    robot: Arc<Robot>,
    /// Where it is at rest.
    pub posture: Posture,
    /// The base's centre of mass in inertial axes, whose origin is where that is at the very start \[m\].
    position: Vector3<f64>,
    /// Total angular momentum, as [`Task::angular_momentum`].
    angular_momentum: Option<Vector3<f64>>,
}

impl Standing {
    /// At rest at another posture.
    #[must_use]
    pub fn moved(&self, posture: Posture) -> Self {
        let by = posture.base_position(&self.robot) - self.posture.base_position(&self.robot);
        Self { posture, position: self.position + by, ..self.clone() }
    }

    /// The origin of inertial axes from the system's centre of mass \[m\].
    fn origin(&self) -> Vector3<f64> {
        self.posture.base_position(&self.robot) - self.position
    }
}

#[derive(Debug, Clone)]
enum Place {
    /// The joints' positions \[rad or m\].
    Joints(Vec<f64>),
    Tool(Box<ToolTable>),
    /// Where the joints are before.
    Stay,
}

/// One way to do a leg of a mission.
#[derive(Debug, Clone)]
pub struct Leg {
    /// The motion to be planned.
    pub task: Task,
    /// How the tool comes straight to its goal after that, from where that motion ends.
    pub approach: Option<(StraightPath, Task)>,
}

impl TaskTable {
    /// Whether it takes several motions, and if so where the file says so.
    fn several(&self) -> Option<(&'static str, Range<usize>)> {
        let tool = self.goal.tool.as_ref();
        let straight = tool.filter(|tool| tool.get_ref().straights().iter().any(Option::is_some));
        let retreat = self.start.retreat_m.as_ref();
        let cycles = self.cycles.as_ref();
        (!self.via.is_empty())
            .then(|| ("via", self.via[0].span()))
            .or_else(|| straight.map(|tool| ("approach_m", tool.span())))
            .or_else(|| retreat.map(|retreat| ("retreat_m", retreat.span())))
            .or_else(|| cycles.map(|cycles| ("cycles", cycles.span())))
    }

    /// Whether it takes several motions.
    pub fn is_mission(&self) -> bool {
        self.several().is_some()
    }

    pub(super) fn check_single(&self, document: &Document) -> Result<(), InputError> {
        let Some((key, span)) = self.several() else { return Ok(()) };
        let message =
            format!("found `{key}`: a task of several motions is for `plan` and `replay`");
        Err(document.error_at(span, message, None))
    }

    /// The task, of as many motions as it takes.
    pub fn mission(&self, document: &Document) -> Result<Mission, InputError> {
        let ends = self.build_ends(document)?;
        let reader = Reader { document, robot: &ends.robot };
        let mut stops = Vec::new();
        for (number, table) in (1..).zip(&self.via) {
            let name = format!("via {number}");
            let via = table.get_ref();
            let parts = via.parts();
            let base = parts.base().unwrap_or(ends.goal.base);
            let (place, span) = match (&parts.tool, parts.joints_span()) {
                (Some(tool), None) => (Place::Tool(Box::new(tool.get_ref().clone())), tool.span()),
                (None, Some(span)) => (Place::Joints(reader.joints(&parts)?), span),
                (None, None) => (Place::Stay, table.span()),
                (Some(_), Some(span)) => {
                    let message =
                        "found both `tool` and the joints' positions, expected one of them";
                    return Err(document.error_at(span, message, None));
                }
            };
            if matches!(place, Place::Stay) && parts.base().is_none() && !via.changes_load() {
                let message = format!(
                    "{name}: found an empty stop, expected joints, `tool`, `base_zyx_deg`, `capture` or `release`"
                );
                return Err(document.error_at(span, message, None));
            }
            let load = via.load(document)?;
            stops.push(Stop { name, place, base, span, load });
        }
        if let Some(cycles) = &self.cycles {
            if !self.via.is_empty() {
                let message = "found both `cycles` and `via`, expected one of them";
                return Err(document.error_at(cycles.span(), message, None));
            }
            let count = cycles.get_ref().0.get();
            let turn = (ends.start.base.inverse() * ends.goal.base).scaled_axis();
            stops.extend((1..count).map(|cycle| {
                let share = turn * (cycle as f64 / count as f64);
                let base = ends.start.base * UnitQuaternion::from_scaled_axis(share);
                let place = Place::Joints(ends.start.joints.clone());
                let (name, span) = (format!("cycle {cycle}"), cycles.span());
                Stop { name, place, base, span, load: Load::Same }
            }));
        }
        let (place, span) = match &self.goal.tool {
            Some(tool) => (Place::Tool(Box::new(tool.get_ref().clone())), tool.span()),
            None => {
                (Place::Joints(ends.goal.joints.clone()), self.goal.joints_span().unwrap_or(0..0))
            }
        };
        if let Place::Tool(tool) = &place
            && tool.straights()[1].is_some()
        {
            let message = "found `retreat_m` at the goal, expected the goal to be the end";
            let help = "a `[[task.via]]` may be left straight back".to_owned();
            return Err(document.error_at(span, message, Some(help)));
        }
        let (name, base) = ("goal".to_owned(), ends.goal.base);
        stops.push(Stop { name, place, base, span, load: Load::Same });
        let retreat = self.start.retreat_m.as_ref().map(|retreat| {
            let keeps_orientation = ends.robot.leading_count() >= 6;
            let (direction, distance) = (-Vector3::z(), retreat.get_ref().0);
            (Straight { direction, distance, keeps_orientation }, retreat.span())
        });
        let mission = Mission {
            document: document.clone(),
            ends,
            keep_out: self.keep_out.clone(),
            uncertainty: self.uncertainty.clone(),
            robust: self.robust.clone(),
            retreat,
            stops,
        };
        mission.check_load(self.payload.is_some())?;
        // What cannot be reached is told before anything is planned.
        let mut at = mission.start();
        if let Some(path) = mission.leaving_start()? {
            at = at.moved(end_of(&path));
        }
        for stop in 0..mission.stops.len() {
            let legs = mission.legs(stop, &at)?;
            at = mission.loaded(stop, &at.moved(legs[0].end()))?;
            if let Some(path) = mission.leaving(stop, &at)? {
                at = at.moved(end_of(&path));
            }
        }
        Ok(mission)
    }
}

impl ViaTable {
    /// What becomes of the load.
    fn load(&self, document: &Document) -> Result<Load, InputError> {
        let spin = self.angular_momentum.as_ref();
        if let (None, Some(spin)) = (&self.capture, spin) {
            let message =
                "found `angular_momentum` without `capture`: it is that of what is caught";
            return Err(document.error_at(spin.span(), message, None));
        }
        match (&self.capture, self.releases()) {
            (Some(capture), Some(_)) => {
                let message = "found both `capture` and `release`, expected one of them";
                Err(document.error_at(capture.span(), message, None))
            }
            (Some(capture), None) => {
                let spin = spin.map_or([0.0; 3], |spin| spin.get_ref().map(|n| n.0));
                Ok(Load::Capture(Box::new(capture.clone()), spin.into()))
            }
            (None, Some(span)) => Ok(Load::Release(span)),
            (None, None) => Ok(Load::Same),
        }
    }
}

impl Leg {
    /// Where it ends if all goes as planned.
    pub fn end(&self) -> Posture {
        match &self.approach {
            None => self.task.goal.clone(),
            Some((_, task)) => task.goal.clone(),
        }
    }
}

/// Where the robot is at the end of a line.
pub(crate) fn end_of(path: &StraightPath) -> Posture {
    let [_, joints] = path.ends();
    Posture { joints: joints.to_vec(), base: path.base[1] }
}

impl Mission {
    /// Refuses a tool that is to catch something while it carries something, or to let go of nothing.
    fn check_load(&self, has_payload: bool) -> Result<(), InputError> {
        let mut carries = false;
        for Stop { name, load, .. } in &self.stops {
            match load {
                Load::Same => {}
                Load::Capture(capture, _) if carries || has_payload => {
                    let message = format!("{name}: the tool carries something already");
                    return Err(self.document.error_at(capture.span(), message, None));
                }
                Load::Release(span) if !carries => {
                    let message =
                        format!("{name}: found `release`, and the tool has caught nothing");
                    return Err(self.document.error_at(span.clone(), message, None));
                }
                Load::Capture(..) => carries = true,
                Load::Release(_) => carries = false,
            }
        }
        Ok(())
    }

    /// How many stops there are.
    pub fn stops(&self) -> usize {
        self.stops.len()
    }

    /// What a stop is called.
    pub fn name(&self, stop: usize) -> &str {
        &self.stops[stop].name
    }

    /// Where the file says so, if the robot's load changes on the way.
    pub fn load_change(&self) -> Option<Range<usize>> {
        self.stops.iter().find_map(|stop| match &stop.load {
            Load::Same => None,
            Load::Capture(capture, _) => Some(capture.span()),
            Load::Release(span) => Some(span.clone()),
        })
    }

    /// Where it begins.
    pub fn start(&self) -> Standing {
        let (robot, posture) = (self.ends.robot.clone(), self.ends.start.clone());
        Standing {
            robot,
            posture,
            position: Vector3::zeros(),
            angular_momentum: self.ends.angular_momentum,
        }
    }

    /// How the tool leaves the start, straight back, if it does.
    pub fn leaving_start(&self) -> Result<Option<StraightPath>, InputError> {
        let Some((straight, span)) = &self.retreat else { return Ok(None) };
        self.straight(straight, &self.start(), span, "retreat_m").map(Some)
    }

    /// At the same place once the tool has caught or let go of what it is to.
    pub fn loaded(&self, stop: usize, at: &Standing) -> Result<Standing, InputError> {
        let Stop { name, load, .. } = &self.stops[stop];
        match load {
            Load::Same => Ok(at.clone()),
            Load::Release(span) if at.angular_momentum.is_some() => {
                let message = format!(
                    "{name}: found `release`, expected none for a robot that has angular momentum"
                );
                Err(self.document.error_at(span.clone(), message, None))
            }
            Load::Release(_) => Ok(Standing { robot: self.ends.robot.clone(), ..at.clone() }),
            Load::Capture(payload, spin) => {
                let none = Outfit::none(&self.document);
                let outfit = Outfit { payload: Some(payload), ..none };
                let robot = Arc::new(outfit.load((*at.robot).clone())?);
                let sum = at.angular_momentum.unwrap_or_default() + spin;
                let angular_momentum = (sum.norm() > 0.0).then_some(sum);
                Ok(Standing { robot, angular_momentum, ..at.clone() })
            }
        }
    }

    /// A task of the robot as it is there, from there to the same posture.
    pub fn task_at(&self, at: &Standing) -> Result<Task, InputError> {
        let mut path = self.ends.path.clone();
        if let Some(limit) = &path.clearance {
            let solids = self.keep_out.solids(at.origin());
            path.clearance = Some(ClearanceLimit::new(&at.robot, solids, limit.least));
        }
        let reader = Reader { document: &self.document, robot: &at.robot };
        let uncertainty = self.uncertainty.as_ref().map(|table| reader.uncertainty(table));
        let mut task = Task {
            robot: at.robot.clone(),
            start: at.posture.clone(),
            goal: at.posture.clone(),
            tool: None,
            angular_momentum: at.angular_momentum,
            path,
            uncertainty: uncertainty.transpose()?,
            robust: None,
            ..self.ends.clone()
        };
        task.robust = robust(self.robust.as_ref(), &task, &self.document)?;
        Ok(task)
    }

    /// How it leaves a stop.
    pub fn leaving(
        &self,
        stop: usize,
        from: &Standing,
    ) -> Result<Option<StraightPath>, InputError> {
        let Stop { place, span, .. } = &self.stops[stop];
        let Place::Tool(tool) = place else { return Ok(None) };
        let [_, Some(straight)] = tool.straights() else { return Ok(None) };
        self.straight(&straight, from, span, "retreat_m").map(Some)
    }

    fn straight(
        &self,
        straight: &Straight,
        from: &Standing,
        span: &Range<usize>,
        key: &str,
    ) -> Result<StraightPath, InputError> {
        if from.angular_momentum.is_some() {
            return Err(self.blocked(&StraightError::Drift, span, key));
        }
        let Posture { joints, base } = &from.posture;
        let path = straight.path(&from.robot, joints, *base);
        path.map_err(|error| self.blocked(&error, span, key))
    }

    fn blocked(&self, error: &StraightError, span: &Range<usize>, key: &str) -> InputError {
        self.document.error_at(span.clone(), format!("`{key}`: {error}"), None)
    }

    /// The ways to come to a stop, the nearest first.
    pub fn legs(&self, stop: usize, from: &Standing) -> Result<Vec<Leg>, InputError> {
        let Stop { place, base, span, name, .. } = &self.stops[stop];
        let failed = |message: String| {
            self.document.error_at(span.clone(), format!("{name}: {message}"), None)
        };
        let here = self.task_at(from)?;
        let to = |joints: &[f64], base: UnitQuaternion<f64>| Task {
            goal: Posture { joints: joints.to_vec(), base },
            ..here.clone()
        };
        let (tasks, approach) = match place {
            Place::Joints(joints) => (vec![to(joints, *base)], None),
            Place::Stay => (vec![to(&from.posture.joints, *base)], None),
            Place::Tool(tool) => {
                let (near, efforts) = (&from.posture.joints, efforts(&self.ends.limits.0));
                let goal = tool.build(&from.robot, from.origin(), base, near, &efforts);
                let goal = goal.map_err(failed)?;
                let chosen = tool.branch();
                let count = goal.branches.len();
                if let Some(branch) = chosen.filter(|branch| *branch > count) {
                    return Err(failed(format!(
                        "found `branch = {branch}`, expected one of 1 to {count}"
                    )));
                }
                let is_chosen = |i: &usize| chosen.is_none_or(|branch| branch == i + 1);
                let tasks = (0..count).filter(is_chosen).map(|i| {
                    let task = to(&goal.branches[i], *base);
                    Task { tool: Some(goal.clone()), ..task }
                });
                (tasks.collect(), tool.straights()[0].clone())
            }
        };
        let mut refused = None;
        let mut legs = Vec::new();
        for task in tasks {
            let leg = match &approach {
                None => Leg { task, approach: None },
                Some(straight) => match Leg::approached(task, straight) {
                    Ok(leg) => leg,
                    Err(error) => {
                        refused.get_or_insert_with(|| self.blocked(&error, span, "approach_m"));
                        continue;
                    }
                },
            };
            let at_its_end = || leg.approach.as_ref().and_then(|(_, task)| task.impossible());
            let too_far = || leg.task.impossible_turn();
            match leg.task.impossible().or_else(at_its_end).or_else(too_far) {
                None => legs.push(leg),
                Some(impossible) => {
                    refused.get_or_insert_with(|| failed(impossible.reason));
                }
            }
        }
        match refused {
            Some(refused) if legs.is_empty() => Err(refused),
            _ => Ok(legs),
        }
    }
}

impl Leg {
    /// One whose end is approached straight: the motion before ends where the way back from there leads.
    fn approached(task: Task, straight: &Straight) -> Result<Self, StraightError> {
        if task.angular_momentum.is_some() {
            return Err(StraightError::Drift);
        }
        let back = straight.path(&task.robot, &task.goal.joints, task.goal.base)?;
        let before = end_of(&back);
        let approach = Task { start: before.clone(), ..task.clone() };
        let task = Task { goal: before, tool: None, ..task };
        Ok(Self { task, approach: Some((back.reversed(), approach)) })
    }
}
