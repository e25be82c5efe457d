//! Plans a task of several motions, one after the other.

use nalgebra::UnitQuaternion;
use serde::Serialize;

use super::planned::{Asked, Planned, PlannedJson, Spent};
use super::{PlanError, Planner, Search};
use crate::reorientation::excursions::PathLimit;
use crate::reorientation::export::{Record, intervals};
use crate::reorientation::json::{ExcursionsJson, PeaksJson};
use crate::reorientation::motion::Motion;
use crate::reorientation::reach::Reach;
use crate::reorientation::replayed::Replayed;
use crate::reorientation::sampling::{Sampling, TooManySamples};
use crate::search::Watch;
use crate::straight::StraightPath;
use crate::task::{Posture, Standing, Task, end_of};
use crate::trajectory::Points;

/// What came of a task of several motions.
#[derive(Debug, Clone)]
pub struct PlannedMission {
    /// The task from its start to its goal.
    pub ends: Task,
    /// The motions, one after the other.
    pub legs: Vec<PlannedLeg>,
    /// Whether all stops were come to.
    pub is_complete: bool,
    /// Whether the user ended the search.
    pub interrupted: bool,
}

/// One of several motions.
#[derive(Debug, Clone)]
pub struct PlannedLeg {
    /// What it is for.
    pub name: String,
    /// The motion.
    pub motion: LegMotion,
}

/// A motion.
#[derive(Debug, Clone)]
pub enum LegMotion {
    /// One that was searched.
    Planned(Box<Planned>),
    /// The tool goes along a straight line.
    Straight {
        /// From where to where.
        task: Box<Task>,
        /// The way of the joints.
        points: Points,
        /// How far the tool goes \[m\].
        distance: f64,
    },
}

/// How finely a straight motion is sampled for other tools.
const STRAIGHT_INTERVALS: usize = 100;

impl Planner {
    /// Plans one motion after the other, each by at most an equal share of `budget` evaluations. Each starts where the one before has
    /// ended. Where one does not reach its goal, the rest is left out.
    pub fn plan_mission(
        &self,
        seed: u64,
        budget: u64,
        watch: &Watch,
    ) -> Result<PlannedMission, PlanError> {
        let mission = self.mission.as_ref().ok_or(PlanError::Several)?;
        let search = Search { seed, budget: (budget / mission.stops() as u64).max(1), watch };
        let mut at = mission.start();
        let mut found = PlannedMission {
            ends: mission.ends.clone(),
            legs: Vec::new(),
            is_complete: false,
            interrupted: false,
        };
        if let Some(path) = mission.leaving_start()? {
            let task = straight_task(mission.task_at(&at)?, &path);
            at = found.go("retreat from start".to_owned(), straight(task, &path), &at);
        }
        for stop in 0..mission.stops() {
            let name = mission.name(stop);
            let choices = mission.legs(stop, &at)?;
            let is_there = choices.iter().position(|leg| leg.task.already_there().is_some());
            let chosen = if let Some(leg) = is_there {
                leg
            } else {
                let tasks = choices.iter().map(|leg| leg.task.clone()).collect();
                let (leg, planned) = match self.plan_one_of(tasks, search) {
                    Err(PlanError::Interrupted) if !found.legs.is_empty() => {
                        return Ok(PlannedMission { interrupted: true, ..found });
                    }
                    planned => planned?,
                };
                found.interrupted = planned.interrupted;
                let is_over = planned.interrupted || planned.reach != Reach::Reached;
                at = found.go(name.to_owned(), LegMotion::Planned(Box::new(planned)), &at);
                if is_over {
                    return Ok(found);
                }
                leg
            };
            if let Some((path, task)) = &choices[chosen].approach {
                let task = Task { start: at.posture.clone(), ..task.clone() };
                at = found.go(format!("approach of {name}"), straight(task, path), &at);
            }
            at = mission.loaded(stop, &at)?;
            if let Some(path) = mission.leaving(stop, &at)? {
                let task = straight_task(mission.task_at(&at)?, &path);
                at = found.go(format!("retreat from {name}"), straight(task, &path), &at);
            }
        }
        Ok(PlannedMission { is_complete: true, ..found })
    }
}

/// From where the task is, along a line.
fn straight_task(task: Task, path: &StraightPath) -> Task {
    Task { goal: end_of(path), ..task }
}

/// The straight motion in the shortest time within all limits.
fn straight(task: Task, path: &StraightPath) -> LegMotion {
    let points = path.timed(&task.limits);
    let used = Replayed::new(&task, &points).excursions.used;
    // Speeds are as one over the duration, torques as one over its square.
    let stretch = used.iter().map(|used| match used.limit {
        PathLimit::BaseRate | PathLimit::ToolSpeed => used.share,
        PathLimit::Torque => used.share.sqrt(),
        PathLimit::BaseTurn | PathLimit::BaseCone | PathLimit::Clearance => 1.0,
    });
    let stretch = stretch.fold(1.0, f64::max);
    let points = if stretch > 1.0 { path.points(points.duration() * stretch) } else { points };
    LegMotion::Straight { task: Box::new(task), points, distance: path.distance() }
}

impl LegMotion {
    /// From where to where it goes, as it was meant to.
    pub fn task(&self) -> &Task {
        match self {
            Self::Planned(found) => found.problem.task(),
            Self::Straight { task, .. } => task,
        }
    }

    /// How long it takes \[s\].
    pub fn duration(&self) -> f64 {
        match self {
            Self::Planned(found) => found.assessment.duration,
            Self::Straight { points, .. } => points.duration(),
        }
    }

    /// Whether it reaches its goal and keeps all limits and ranges.
    pub fn is_reached(&self) -> bool {
        match self {
            Self::Planned(found) => found.reach == Reach::Reached,
            Self::Straight { task, points, .. } => Replayed::new(task, points).is_as_asked(),
        }
    }

    /// Whether it keeps all limits and ranges.
    fn keeps_limits(&self) -> bool {
        match self {
            Self::Planned(found) => Reach::keeps_limits(&found.assessment),
            Self::Straight { task, points, .. } => Replayed::new(task, points).keeps_limits(),
        }
    }

    /// The motion, sampled.
    pub fn sample(&self, sampling: impl Into<Sampling>) -> Motion {
        let sampling = sampling.into();
        match self {
            Self::Planned(found) => {
                found.problem.sample_at(&found.coefficients, found.assessment.duration, sampling)
            }
            Self::Straight { task, points, .. } => Replayed::new(task, points).sample(sampling),
        }
    }

    /// In how many intervals other tools are given it.
    pub fn intervals(&self) -> usize {
        match self {
            Self::Planned(found) => intervals(found.problem.spec()),
            Self::Straight { .. } => STRAIGHT_INTERVALS,
        }
    }

    fn end(&self) -> Posture {
        let base = self.sample(1).base;
        let base = base.last().copied().unwrap_or_else(UnitQuaternion::identity);
        Posture { joints: self.task().goal.joints.clone(), base }
    }
}

impl PlannedMission {
    /// How long all takes \[s\].
    pub fn duration(&self) -> f64 {
        self.legs.iter().map(|leg| leg.motion.duration()).sum()
    }

    /// Whether all motions were planned, reach their goals and keep all limits and ranges.
    pub fn is_reached(&self) -> bool {
        self.is_complete && self.legs.iter().all(|leg| leg.motion.is_reached())
    }

    /// Goes on with a motion; gives where that ends.
    fn go(&mut self, name: String, motion: LegMotion, from: &Standing) -> Standing {
        let there = from.moved(motion.end());
        self.legs.push(PlannedLeg { name, motion });
        there
    }

    /// All motions as one; `intervals` tells in how many each is cut.
    pub fn sample(&self, intervals: impl Fn(&LegMotion) -> usize) -> Motion {
        let mut whole: Option<Motion> = None;
        for leg in &self.legs {
            let next = leg.motion.sample(intervals(&leg.motion));
            match &mut whole {
                None => whole = Some(next),
                Some(whole) => whole.go_on(next),
            }
        }
        whole.unwrap_or_default()
    }

    /// All motions as one for other tools. Each is sampled from its own start to its end; without a sampling, as suits it.
    pub fn record(&self, sampling: Option<Sampling>) -> Result<Record<'_>, TooManySamples> {
        sampling.unwrap_or_default().check(self.duration())?;
        let sampled = |leg: &PlannedLeg| {
            leg.motion.sample(sampling.unwrap_or_else(|| leg.motion.intervals().into()))
        };
        let mut legs = self.legs.iter();
        let Some(first) = legs.next() else {
            let nothing = Motion::default();
            return Ok(Record::new(&self.ends.robot, nothing));
        };
        let mut record = Record::new(&first.motion.task().robot, sampled(first));
        for leg in legs {
            record.go_on(&leg.motion.task().robot, sampled(leg));
        }
        Ok(record)
    }

    /// As JSON.
    pub fn json<'a>(&'a self, asked: &Asked<'a>) -> MissionJson<'a> {
        let legs = self.legs.iter().map(|leg| leg.json(asked)).collect();
        let spent = self.legs.iter().fold(Spent::default(), |all, leg| match &leg.motion {
            LegMotion::Planned(found) => all.and(found.spent),
            LegMotion::Straight { .. } => all,
        });
        let end = self.legs.last().map(|leg| leg.motion.end().base);
        MissionJson {
            asked: asked.clone(),
            reached: self.is_reached(),
            within_limits: self.legs.iter().all(|leg| leg.motion.keeps_limits()),
            t_f: self.duration(),
            residual_deg: end.map(|end| end.angle_to(&self.ends.goal.base).to_degrees()),
            interrupted: self.interrupted,
            legs,
            spent,
        }
    }
}

/// The object that `plan --json` prints of a task of several motions.
#[derive(Debug, Serialize)]
pub struct MissionJson<'a> {
    #[serde(flatten)]
    asked: Asked<'a>,
    reached: bool,
    within_limits: bool,
    t_f: f64,
    residual_deg: Option<f64>,
    interrupted: bool,
    legs: Vec<LegJson<'a>>,
    #[serde(flatten)]
    spent: Spent,
}

#[derive(Debug, Serialize)]
struct LegJson<'a> {
    leg: &'a str,
    #[serde(flatten)]
    motion: LegMotionJson<'a>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum LegMotionJson<'a> {
    Planned(Box<PlannedJson<'a>>),
    Straight(Box<StraightJson>),
}

#[derive(Debug, Serialize)]
struct StraightJson {
    t_f: f64,
    distance_m: f64,
    reached: bool,
    peaks: PeaksJson,
    #[serde(flatten)]
    excursions: ExcursionsJson,
}

impl PlannedLeg {
    fn json<'a>(&'a self, asked: &Asked<'a>) -> LegJson<'a> {
        let motion = match &self.motion {
            LegMotion::Planned(found) => {
                LegMotionJson::Planned(Box::new(found.json(asked.clone())))
            }
            LegMotion::Straight { task, points, distance } => {
                let replayed = Replayed::new(task, points);
                let peaks = &replayed.played.peaks;
                LegMotionJson::Straight(Box::new(StraightJson {
                    t_f: points.duration(),
                    distance_m: *distance,
                    reached: replayed.is_as_asked(),
                    peaks: PeaksJson::new(peaks, &task.robot),
                    excursions: ExcursionsJson::new(&replayed.excursions, task, peaks),
                }))
            }
        };
        LegJson { leg: &self.name, motion }
    }
}
