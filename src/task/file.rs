//! The `[task]` table.

use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::joints::JointValues;
use super::keep_out::KeepOut;
use super::path_limits::{ClearanceLimit, Impossible};
use super::pose::ViaTable;
use super::reader::Reader;
use super::tables::{
    Cycles, LIMIT_KEYS, LimitsTable, PostureTable, StatedTable, WeightsTable, placed, unplaced,
};
use super::tool_goal::ToolTable;
use super::uncertainty::{Robust, RobustTable, UncertaintyTable};
use super::way::Way;
use super::{PoseTable, Posture, PostureParts, Task, ToolGoal};
use crate::input::{Document, Finite, Fraction, InputError, NonNegative, Positive, nearest};
use crate::robot::{BaseTable, Follows, Locked, Outfit, PayloadTable, Robot, RobotFile};
use crate::trajectory::Limits;

/// The key of the base's weight.
const WEIGHT: &str = "weights.base";

/// How far from its goal the base may end where a file says nothing of it.
const TOLERANCE_DEG: f64 = 0.001;

/// The robot of a task that names none.
const PAPERS_ROBOT: &str = "xiao2023";

/// The `[task]` table. What a file leaves out is that of the task that its robot comes with, if it comes with the program.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(from = "StatedTable")]
pub struct TaskTable {
    robot: Spanned<String>,
    #[serde(skip_serializing_if = "Locked::is_empty")]
    locked: Locked,
    #[serde(skip_serializing_if = "Follows::is_empty")]
    follow: Follows,
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<Spanned<BaseTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) payload: Option<Spanned<PayloadTable>>,
    pub(super) start: PostureTable,
    pub(super) goal: PostureTable,
    pub(super) limits: LimitsTable,
    pub(super) weights: WeightsTable,
    #[serde(skip_serializing_if = "KeepOut::is_empty")]
    pub(super) keep_out: KeepOut,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) via: Vec<Spanned<ViaTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) cycles: Option<Spanned<Cycles>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) uncertainty: Option<UncertaintyTable>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) robust: Option<Spanned<RobustTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) angular_momentum: Option<Spanned<[Finite; 3]>>,
    /// Limits on rate, acceleration and jerk that a sweep states.
    #[serde(skip)]
    swept: [bool; 3],
}
impl From<StatedTable> for TaskTable {
    fn from(stated: StatedTable) -> Self {
        let StatedTable {
            robot,
            locked,
            follow,
            base,
            payload,
            start,
            goal,
            limits,
            weights,
            keep_out,
            via,
            cycles,
            uncertainty,
            robust,
            angular_momentum,
        } = stated;
        let robot = robot.unwrap_or_else(|| Spanned::new(0..0, PAPERS_ROBOT.to_owned()));
        let swept = [false; 3];
        Self {
            robot,
            locked,
            follow,
            base,
            payload,
            start,
            goal,
            limits,
            weights,
            keep_out,
            via,
            cycles,
            uncertainty,
            robust,
            angular_momentum,
            swept,
        }
        .filled()
    }
}
impl TaskTable {
    /// The same with what the robot's own task has where this states nothing.
    fn filled(mut self) -> Self {
        let robot = self.robot.get_ref();
        let default = StatedTable::of(robot).freed(robot, &self.locked, &self.follow);
        self.start.filled(&default.start);
        self.goal.filled(&default.goal);
        self.limits = self.limits.filled(&default.limits);
        let weight = || Some(Spanned::new(0..0, Fraction(super::BASE_WEIGHT)));
        self.weights.base =
            self.weights.base.or_else(|| unplaced(default.weights.base.as_ref())).or_else(weight);
        self
    }

    /// The same with what its file states alone.
    #[must_use]
    pub fn stated(&self) -> Self {
        Self {
            start: self.start.stated(),
            goal: self.goal.stated(),
            limits: self.limits.stated(),
            weights: WeightsTable {
                base: placed(self.weights.base.as_ref()),
                ..self.weights.clone()
            },
            ..self.clone()
        }
    }

    /// The robot's file, unless it comes with the program.
    pub fn robot_file(&self, document: &Document) -> Option<PathBuf> {
        let name = self.robot.get_ref();
        Robot::embedded(name).is_none().then(|| document.resolve(name))
    }

    /// The same task with another start or goal.
    #[must_use]
    pub fn with_pose(&self, pose: &PoseTable) -> Self {
        Self {
            start: self.start.with(&pose.start),
            goal: self.goal.with(&pose.goal),
            ..self.clone()
        }
    }

    /// The same with the joints' positions at the goal of a task, where this states where the tool is to be.
    #[must_use]
    pub fn ending_with(&self, task: &Task) -> Self {
        if self.goal.tool.is_none() {
            return self.clone();
        }
        let joints = task.robot.joints().zip(&task.goal.joints);
        let positions = joints.map(|(joint, at)| joint.kind.to_file_units(*at)).collect();
        let goal = PostureParts::of_joints(&task.robot, positions);
        self.with_pose(&PoseTable { goal, ..PoseTable::default() })
    }

    /// The same with the goal's tolerance, rates that are the robot's own and what limits on the way imply written out.
    #[must_use]
    pub fn resolved(mut self, task: &Task) -> Self {
        let default = || Spanned::new(0..0, Positive(TOLERANCE_DEG));
        self.goal.tolerance_deg.get_or_insert_with(default);
        if task.path.base_turn.is_some() || task.path.turn_weights != [0.0; 2] {
            self.limits.base_turn_from.get_or_insert_default();
        }
        if let Some(clearance) = &task.path.clearance {
            let least = || Spanned::new(0..0, NonNegative(clearance.least));
            self.limits.clearance_m.get_or_insert_with(least);
        }
        if self.limits.missing()[0] {
            let joints = || task.robot.joints().zip(&task.limits.0);
            let rates =
                joints().map(|(joint, limits)| Positive(joint.kind.to_file_units(limits[0])));
            let rates = Some(Spanned::new(0..0, JointValues::Each(rates.collect())));
            if task.robot.sliding_joint().is_none() {
                self.limits.rate_deg_s = rates;
            } else {
                self.limits.rate = rates;
            }
        }
        self
    }

    /// The robot, read from its file unless it comes with the program.
    pub fn robot(&self, document: &Document) -> Result<Robot, InputError> {
        let (file, text) = find_robot(&self.robot, document)?;
        file.build_for(
            &text,
            &Outfit {
                document,
                base: self.base.as_ref(),
                locked: &self.locked,
                follow: &self.follow,
                payload: self.payload.as_ref(),
            },
        )
    }

    /// The same task with another robot, and what that one's own task has where the file states nothing.
    #[must_use]
    pub fn with_robot(self, robot: Spanned<String>) -> Self {
        Self { robot, ..self.stated() }.filled()
    }

    /// The same task with its robot in another file.
    #[must_use]
    pub fn with_robot_file(self, robot: String) -> Self {
        Self { robot: Spanned::new(0..0, robot), ..self }
    }

    /// The same task where a sweep states these limits on rate, acceleration and jerk.
    #[must_use]
    pub fn with_swept_limits(self, swept: [bool; 3]) -> Self {
        Self { swept, ..self }
    }

    /// The keys that the file leaves to the task that its robot comes with.
    pub fn inherited(&self) -> Vec<&'static str> {
        let [start, goal] = [&self.start, &self.goal].map(PostureTable::own);
        let limits = self.limits.own();
        let swept = self.swept;
        let by_joint = self.limits.acceleration.is_some() || self.limits.jerk.is_some();
        let rate = if by_joint { "limits.rate" } else { "limits.rate_deg_s" };
        let is_weight_own = self.weights.base.as_ref().is_some_and(|base| !base.span().is_empty());
        let keys = [
            ("start.joints_deg", start[0]),
            ("start.base_zyx_deg", start[1]),
            ("goal.joints_deg", goal[0]),
            ("goal.base_zyx_deg", goal[1]),
            (rate, limits[0] || swept[0]),
            ("limits.acceleration_deg_s2", limits[1] || swept[1]),
            ("limits.jerk_deg_s3", limits[2] || swept[2]),
            (WEIGHT, is_weight_own),
        ];
        keys.into_iter().filter(|(_, is_own)| !is_own).map(|(key, _)| key).collect()
    }

    /// What the file leaves out and where it is taken from, in words, if it leaves out anything.
    pub fn inheritance(&self) -> Option<String> {
        let (robot, keys) = (self.robot.get_ref(), self.inherited());
        if keys.is_empty() {
            return None;
        }
        let source = |key: &str| match key {
            _ if robot == PAPERS_ROBOT => "as in the paper's task",
            WEIGHT => "by default",
            _ if Robot::embedded(robot).is_some() => "as in the robot's own task",
            _ => "as in the robot's file",
        };
        let told = keys.chunk_by(|a, b| source(a) == source(b));
        let told = told.map(|keys| format!("{} ({})", keys.join(", "), source(keys[0])));
        Some(told.collect::<Vec<_>>().join(", "))
    }

    /// Whether nothing is missing. Rates may be the robot's own.
    fn check_stated(&self, robot: &Robot, document: &Document) -> Result<(), InputError> {
        let slides = robot.sliding_joint().is_some();
        let key = |in_degrees: &str, by_joint: &str| {
            format!("`{}`", if slides { by_joint } else { in_degrees })
        };
        let mut missing = Vec::new();
        for (name, posture) in [("start", &self.start), ("goal", &self.goal)] {
            if posture.is_without_joints() {
                missing.push(key(&format!("{name}.joints_deg"), &format!("{name}.joints")));
            }
            if posture.base_zyx_deg.is_none() {
                missing.push(format!("`{name}.base_zyx_deg`"));
            }
        }
        let has_rates = robot.joints().all(|joint| joint.rate.is_some() || joint.follows.is_some());
        for (order, is_missing) in self.limits.missing().into_iter().enumerate() {
            if is_missing && !self.swept[order] && !(order == 0 && has_rates) {
                let [in_degrees, by_joint] = LIMIT_KEYS[order].map(|key| format!("limits.{key}"));
                missing.push(key(&in_degrees, &by_joint));
            }
        }
        if missing.is_empty() {
            return Ok(());
        }
        let message = format!(
            "the task does not state {}, which this robot has no defaults for",
            missing.join(", ")
        );
        let joints: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
        let help = format!(
            "only robots that come with the program come with a task; its joints are {}",
            joints.join(", ")
        );
        Err(document.error_at(self.robot.span(), message, Some(help)))
    }

    /// Whether the tool's goal moves while the robot does.
    pub fn moves(&self) -> bool {
        self.goal.tool.as_ref().is_some_and(|tool| tool.get_ref().moves())
    }

    /// Whether the file says how long the motion lasts at least.
    pub fn states_least_duration(&self) -> bool {
        self.limits.least_duration_s.is_some()
    }

    /// The same task where the motion lasts so long \[s\] at least, and meets a goal that moves then.
    #[must_use]
    pub fn with_least_duration(&self, seconds: f64) -> Self {
        let met =
            |tool: &Spanned<ToolTable>| Spanned::new(tool.span(), tool.get_ref().met_at(seconds));
        let goal = PostureTable { tool: self.goal.tool.as_ref().map(met), ..self.goal.clone() };
        let least_duration_s = Some(Spanned::new(0..0, Positive(seconds)));
        let limits = LimitsTable { least_duration_s, ..self.limits.clone() };
        Self { goal, limits, ..self.clone() }
    }

    /// The task. A robot that does not come with the program is a file, sought beside `document`.
    pub fn build(&self, document: &Document) -> Result<Task, InputError> {
        self.check_single(document)?;
        self.build_ends(document)
    }

    /// The task from its start to its goal, whatever lies between.
    pub fn build_ends(&self, document: &Document) -> Result<Task, InputError> {
        let robot = self.robot(document)?;
        self.check_stated(&robot, document)?;
        let reader = Reader { document, robot: &robot };
        let mut limits = vec![[0.0; 3]; robot.joint_count()];
        for (order, pair) in self.limits.pairs().into_iter().enumerate() {
            let values = reader.limit(pair, order)?;
            limits.iter_mut().zip(values).for_each(|(limits, value)| limits[order] = value);
        }
        if let Some(tolerance) = &self.start.tolerance_deg {
            let message = "found `tolerance_deg`, which is for the goal alone";
            return Err(document.error_at(tolerance.span(), message, None));
        }
        let tolerance = self.goal.tolerance_deg.as_ref().map_or(TOLERANCE_DEG, |t| t.get_ref().0);
        let weight = self.weights.base.as_ref().map_or(super::BASE_WEIGHT, |base| base.get_ref().0);
        let way = Way { limits: &self.limits, weights: &self.weights, robot: &robot, document };
        if let Some(tool) = &self.start.tool {
            let message = "found `tool`, which is for goals alone";
            return Err(document.error_at(tool.span(), message, None));
        }
        if let Some(retreat) = &self.goal.retreat_m {
            let message = "found `retreat_m`, which is for the start and for tools on the way";
            return Err(document.error_at(retreat.span(), message, None));
        }
        let start = reader.posture(&self.start)?;
        let (goal, tool) = self.goal(&reader, &start, &limits)?;
        let angular_momentum = self.total_angular_momentum(&start, &robot, document)?;
        let mut task = Task {
            start,
            goal,
            tool,
            limits: Limits(limits),
            angular_momentum,
            least_duration: self.limits.least_duration_s.as_ref().map_or(0.0, |s| s.get_ref().0),
            base_weight: weight,
            goal_tolerance: tolerance.to_radians(),
            path: way.build()?,
            uncertainty: self
                .uncertainty
                .as_ref()
                .map(|own| reader.uncertainty(own))
                .transpose()?,
            robust: None,
            robot: Arc::new(robot),
        };
        task.robust = robust(self.robust.as_ref(), &task, document)?;
        let solids = self.keep_out.solids(task.start.base_position(&task.robot));
        let least = self.limits.clearance_m.as_ref().map(|clearance| clearance.get_ref().0);
        // What is to be kept out of is not to be touched.
        if let Some(least) = least.or((!solids.is_empty()).then_some(0.0)) {
            task.path.clearance = Some(ClearanceLimit::new(&task.robot, solids, least));
        }
        self.check_drifting(&task, document)?;
        let (task, impossible) = self.branched(task, document)?;
        // Every motion of a mission has a turn of its own.
        let too_far = || task.impossible_turn().filter(|_| !self.is_mission());
        match impossible.or_else(too_far) {
            None => Ok(task),
            Some(Impossible { key, reason }) => {
                Err(document.error_at(self.limits.span_of(key), reason, None))
            }
        }
    }

    /// The goal, and what it is in terms of the tool if the table states that.
    fn goal(
        &self,
        reader: &Reader<'_>,
        start: &Posture,
        limits: &[[f64; 3]],
    ) -> Result<(Posture, Option<ToolGoal>), InputError> {
        let Some(table) = &self.goal.tool else {
            return Ok((reader.posture(&self.goal)?, None));
        };
        let failed = |message: String| reader.document.error_at(table.span(), message, None);
        if let Some(span) = self.goal.joints_span() {
            let message = "found both `tool` and the joints' positions, expected one of them";
            return Err(reader.document.error_at(span, message, None));
        }
        let least = self.limits.least_duration_s.as_ref();
        let table = match least {
            Some(least) => Spanned::new(table.span(), table.get_ref().met_at(least.get_ref().0)),
            None if self.moves() => {
                let message = "found a target that moves, expected `least_duration_s` in `[task.limits]`, too, which says when \
                               it is met; `plan` alone can find that";
                return Err(failed(message.to_owned()));
            }
            None => table.clone(),
        };
        let base = self.goal.base();
        if self.via.iter().any(|via| via.get_ref().changes_load()) {
            // Where the tool can be then depends on what it carries.
            return Ok((Posture { joints: start.joints.clone(), base }, None));
        }
        let origin = start.base_position(reader.robot);
        let tool = table.get_ref();
        let tool = tool.build(reader.robot, origin, &base, &start.joints, &efforts(limits));
        let tool = tool.map_err(failed)?;
        Ok((Posture { joints: tool.branches[0].clone(), base }, Some(tool)))
    }

    /// The same task with the branches of its goal that no limit excludes, at the branch that the table asks for; and what is
    /// impossible about it.
    fn branched(
        &self,
        mut task: Task,
        document: &Document,
    ) -> Result<(Task, Option<Impossible>), InputError> {
        let (Some(table), Some(mut goal)) = (&self.goal.tool, task.tool.take()) else {
            let impossible = task.impossible();
            return Ok((task, impossible));
        };
        let impossible = task.impossible();
        goal.branches.retain(|joints| task.ending_with(joints).impossible().is_none());
        let count = goal.branches.len();
        if let Some(branch) = table.get_ref().branch() {
            if !(1..=count).contains(&branch) && count > 0 {
                let message = format!("found `branch = {branch}`, expected one of 1 to {count}");
                return Err(document.error_at(table.span(), message, None));
            }
            goal.branches = goal.branches.into_iter().skip(branch - 1).take(1).collect();
        }
        let Some(first) = goal.branches.first() else { return Ok((task, impossible)) };
        let mut task = task.ending_with(first);
        task.tool = Some(goal);
        Ok((task, None))
    }
}
/// The wish for sampled robots.
pub(super) fn robust(
    table: Option<&Spanned<RobustTable>>,
    task: &Task,
    document: &Document,
) -> Result<Option<Robust>, InputError> {
    let Some(table) = table else { return Ok(None) };
    let failed = |message: String| document.error_at(table.span(), message, None);
    let uncertainty = task.uncertainty.as_ref().ok_or_else(|| {
        failed("found `robust` without `[task.uncertainty]`, which says what is not known".into())
    })?;
    if uncertainty.unknowns(&task.robot).is_empty() {
        return Err(failed(
            "found `robust`, and `[task.uncertainty]` leaves nothing uncertain".into(),
        ));
    }
    let robust = table.get_ref().build(uncertainty, task.base_weight);
    robust.uncertainty.draw(task).map_err(|error| failed(error.to_string()))?;
    Ok(Some(robust))
}

/// What a unit of each joint's way counts: its least time \[s\].
pub(super) fn efforts(limits: &[[f64; 3]]) -> Vec<f64> {
    limits.iter().map(|[rate, ..]| 1.0 / rate).collect()
}

/// The robot's file, and its text.
fn find_robot(
    name: &Spanned<String>,
    document: &Document,
) -> Result<(RobotFile, Document), InputError> {
    let known = name.get_ref();
    if let Some(embedded) = Robot::embedded(known) {
        return Ok((RobotFile::read(&embedded)?, embedded));
    }
    let path = document.resolve(known);
    if path.is_file() {
        let text = Document::read(&path)?;
        return Ok((RobotFile::read(&text)?, text));
    }
    let message = format!(
        "no robot `{known}`: neither one that comes with the program nor a file at {}",
        path.display()
    );
    let help = nearest(known, Robot::embedded_names()).map(|n| format!("did you mean `{n}`?"));
    Err(document.error_at(name.span(), message, help))
}
