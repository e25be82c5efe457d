//! The instances of a sweep over the reorientation task.

use std::num::NonZeroU64;
use std::sync::Arc;

use super::bases::{Base, bases};
use super::keys::{Evaluations, Sweep, TaskKeys};
use super::settings::TrajectoryTable;
use super::subject::TaskSubject;
use super::symbols::K_B;
use crate::experiment::{Coordinate, Instance, Value};
use crate::input::{Document, InputError, NonNegative, Positive};
use crate::task::{ClearanceLimit, PoseTable, Task, TaskTable};

/// Settings that change the number of variables and keep what the problem is like.
const SIZES: [&str; 2] = ["terms", "pieces"];

/// A task on its way through the lists, with what they have set so far.
#[derive(Clone)]
struct Draft {
    label: String,
    title: String,
    series: String,
    coordinates: Vec<Coordinate>,
    task: Task,
    trajectory: TrajectoryTable,
    budget: Option<NonZeroU64>,
}

/// The cross product of the sweep's lists; instances that differ in the pose alone are one group.
pub(super) fn instances(keys: &TaskKeys, document: &Document) -> Result<Vec<Instance>, InputError> {
    let mut instances = Vec::new();
    for base in bases(keys, document)? {
        instances.extend(instances_of(&base, keys, document)?);
    }
    Ok(instances)
}

fn instances_of(
    base: &Base<'_>,
    TaskKeys { trajectory, sweep, .. }: &TaskKeys,
    document: &Document,
) -> Result<Vec<Instance>, InputError> {
    let own = &base.document;
    let task = &base.task.clone().with_swept_limits([
        !sweep.rate_limit_deg_s.is_empty(),
        !sweep.acceleration_limit_deg_s2.is_empty(),
        !sweep.jerk_limit_deg_s3.is_empty(),
    ]);
    check_swept_limits(task, sweep, own, document)?;
    let poses = poses(task, sweep, own, document)?;
    let posed = |pose: &PoseTable| task.with_pose(pose).build(own);
    let posed: Vec<Task> = poses.iter().map(posed).collect::<Result<_, _>>()?;
    // The task's own start and goal need not fit the robot where poses replace them.
    let task = posed.first().map_or_else(|| task.build(own), |task| Ok(task.clone()))?;
    check_swept_cones(&task, sweep, document)?;
    let mut first = Draft {
        label: String::new(),
        title: String::new(),
        series: String::new(),
        coordinates: Vec::new(),
        task,
        trajectory: trajectory.clone(),
        budget: None,
    };
    if let Some((setting, name)) = &base.setting {
        first = first.with(setting, name.as_str().into());
    }
    let mut instances = Vec::new();
    for group in drafts(first, sweep) {
        let numbered: Vec<(usize, &Task)> = (1..).zip(&posed).collect();
        let drafts = cross(vec![group.clone()], "pose", &numbered, |draft, (number, posed)| {
            draft.pose(posed);
            Value::Count(*number as u64)
        });
        for draft in drafts {
            instances.push(Instance {
                group: group.label.clone(),
                title: group.title.clone(),
                series: group.series.clone(),
                ..draft.build(document)?
            });
        }
    }
    Ok(instances)
}

/// Limits in one unit are for robots whose joints all turn.
fn check_swept_limits(
    task: &TaskTable,
    sweep: &Sweep,
    own: &Document,
    document: &Document,
) -> Result<(), InputError> {
    let keys = [
        ("rate_limit_deg_s", "degrees", &sweep.rate_limit_deg_s),
        ("acceleration_limit_deg_s2", "degrees", &sweep.acceleration_limit_deg_s2),
        ("jerk_limit_deg_s3", "degrees", &sweep.jerk_limit_deg_s3),
        ("torque_n_m", "N·m", &sweep.torque_n_m),
    ];
    let Some((key, unit, _)) = keys.into_iter().find(|(.., values)| !values.is_empty()) else {
        return Ok(());
    };
    let robot = task.robot(own)?;
    match robot.sliding_joint() {
        None => Ok(()),
        Some(joint) => {
            let message = format!("`sweep.{key}` is in {unit}, and joint `{}` slides", joint.name);
            let help = "`[task.limits]` states limits joint by joint".to_owned();
            Err(document.error_at(document.key("sweep")?.unwrap_or_default(), message, Some(help)))
        }
    }
}

/// Angles are for a task with one cone.
fn check_swept_cones(task: &Task, sweep: &Sweep, document: &Document) -> Result<(), InputError> {
    let Some(first) = sweep.base_cone_deg.first() else { return Ok(()) };
    if let Some(wide) = sweep.base_cone_deg.iter().find(|angle| angle.get_ref().0 >= 180.0) {
        let message = format!("found a cone of {}°, expected less than 180°", wide.get_ref().0);
        return Err(document.error_at(wide.span(), message, None));
    }
    let found = match task.path.base_cones.len() {
        1 => return Ok(()),
        0 => "none".to_owned(),
        count => count.to_string(),
    };
    let message =
        format!("`sweep.base_cone_deg` is for tasks with one cone, and this one has {found}");
    let help = "a cone stands in `[task.limits]` as `base_cone`".to_owned();
    Err(document.error_at(first.span(), message, Some(help)))
}

/// The pairs of start and goal that replace the task's.
fn poses(
    task: &TaskTable,
    sweep: &Sweep,
    own: &Document,
    document: &Document,
) -> Result<Vec<PoseTable>, InputError> {
    match &sweep.random_poses {
        None => Ok(sweep.pose.clone()),
        Some(random) if sweep.pose.is_empty() => Ok(random.get_ref().draw(&task.robot(own)?)),
        Some(random) => {
            let message = "found both `pose` and `random_poses`, expected one of them";
            Err(document.error_at(random.span(), message, None))
        }
    }
}

/// The cross product of all lists but the poses.
fn drafts(first: Draft, sweep: &Sweep) -> Vec<Draft> {
    let limit = |order: usize| {
        move |draft: &mut Draft, limit: &Positive| {
            draft.task.limits.0.iter_mut().for_each(|l| l[order] = limit.0.to_radians());
            Value::Real(limit.0)
        }
    };
    let mut drafts = cross(vec![first], "weight_base", &sweep.weight_base, |draft, weight| {
        draft.task.base_weight = weight.0;
        Value::Real(weight.0)
    });
    drafts = cross(drafts, "rate_limit_deg_s", &sweep.rate_limit_deg_s, limit(0));
    drafts = cross(drafts, "acceleration_limit_deg_s2", &sweep.acceleration_limit_deg_s2, limit(1));
    drafts = cross(drafts, "jerk_limit_deg_s3", &sweep.jerk_limit_deg_s3, limit(2));
    drafts = swept_on_the_way(drafts, sweep);
    drafts = cross(drafts, "family", &sweep.family, |draft, family| {
        draft.trajectory = draft.trajectory.clone().with_family(*family);
        family.name().into()
    });
    for key in &sweep.sizes() {
        let cross = |draft: Draft| {
            if draft.trajectory.family() != key.family {
                return vec![draft];
            }
            cross(vec![draft], key.name, key.values, |draft, value| {
                draft.trajectory = (key.set)(draft.trajectory.clone(), value.clone());
                (*value.get_ref()).into()
            })
        };
        drafts = drafts.into_iter().flat_map(cross).collect();
    }
    cross(drafts, "budget", &sweep.budget, |draft, Evaluations(evaluations)| {
        draft.budget = Some(*evaluations);
        Value::Count(evaluations.get())
    })
}

/// With every value of the lists that are about the way.
fn swept_on_the_way(mut drafts: Vec<Draft>, sweep: &Sweep) -> Vec<Draft> {
    drafts = cross(drafts, "base_turn_deg", &sweep.base_turn_deg, |draft, limit| {
        draft.task.path.base_turn = Some(limit.0.to_radians());
        Value::Real(limit.0)
    });
    drafts = cross(drafts, "base_cone_deg", &sweep.base_cone_deg, |draft, angle| {
        let degrees = angle.get_ref().0;
        draft.task.path.base_cones.iter_mut().for_each(|cone| cone.angle = degrees.to_radians());
        Value::Real(degrees)
    });
    drafts = cross(drafts, "base_rate_deg_s", &sweep.base_rate_deg_s, |draft, limit| {
        draft.task.path.base_rate = Some(limit.0.to_radians());
        Value::Real(limit.0)
    });
    drafts = cross(drafts, "tool_speed_m_s", &sweep.tool_speed_m_s, |draft, limit| {
        draft.task.path.tool_speed = Some(limit.0);
        Value::Real(limit.0)
    });
    drafts = cross(drafts, "torque_n_m", &sweep.torque_n_m, |draft, limit| {
        draft.task.path.torque = Some(vec![limit.0; draft.task.robot.joint_count()]);
        Value::Real(limit.0)
    });
    drafts = with_clearances(drafts, &sweep.clearance_m);
    let weight = |which: usize| {
        move |draft: &mut Draft, weight: &NonNegative| {
            draft.task.path.turn_weights[which] = weight.0;
            Value::Real(weight.0)
        }
    };
    drafts = cross(drafts, "weight_largest_turn", &sweep.weight_largest_turn, weight(0));
    cross(drafts, "weight_mean_turn", &sweep.weight_mean_turn, weight(1))
}

/// With every clearance. All drafts are of one robot, so its bodies are made once.
fn with_clearances(drafts: Vec<Draft>, clearances: &[NonNegative]) -> Vec<Draft> {
    let Some(first) = drafts.first().filter(|_| !clearances.is_empty()) else { return drafts };
    let own = first.task.path.clearance.clone();
    let own = own.unwrap_or_else(|| ClearanceLimit::new(&first.task.robot, Vec::new(), 0.0));
    cross(drafts, "clearance_m", clearances, |draft, least| {
        draft.task.path.clearance = Some(own.with_least(least.0));
        Value::Real(least.0)
    })
}

/// Every draft with every value of one list; a list without values leaves the drafts alone.
fn cross<T>(
    drafts: Vec<Draft>,
    name: &str,
    values: &[T],
    set: impl Fn(&mut Draft, &T) -> Value,
) -> Vec<Draft> {
    if values.is_empty() {
        return drafts;
    }
    let with = |draft: &Draft, value: &T| {
        let mut draft = draft.clone();
        let value = set(&mut draft, value);
        draft.with(name, value)
    };
    drafts.iter().flat_map(|draft| values.iter().map(|value| with(draft, value))).collect()
}

/// Adds a part to a label.
fn append(text: &mut String, part: &str) {
    if !text.is_empty() {
        text.push(' ');
    }
    text.push_str(part);
}

/// A value as labels have it.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::Real(number) => number.to_string(),
        Value::Count(count) => count.to_string(),
        Value::Text(text) => text.clone(),
        _ => String::new(),
    }
}

/// A setting with its symbol and unit, as charts write it.
pub(super) fn title(setting: &str, value: &str) -> String {
    match setting {
        "weight_base" => format!("{K_B} = {value}"),
        "rate_limit_deg_s" => format!("rate ≤ {value} °/s"),
        "acceleration_limit_deg_s2" => format!("acceleration ≤ {value} °/s²"),
        "jerk_limit_deg_s3" => format!("jerk ≤ {value} °/s³"),
        "base_turn_deg" => format!("turn ≤ {value}°"),
        "base_cone_deg" => format!("cone of {value}°"),
        "base_rate_deg_s" => format!("base rate ≤ {value} °/s"),
        "tool_speed_m_s" => format!("tool speed ≤ {value} m/s"),
        "torque_n_m" => format!("torque ≤ {value} N·m"),
        "clearance_m" => format!("clearance ≥ {value} m"),
        "weight_largest_turn" => format!("weight of the largest turn = {value}"),
        "weight_mean_turn" => format!("weight of the mean turn = {value}"),
        "terms" | "pieces" | "degree" => format!("{setting} = {value}"),
        "family" | "robot" | "task" => value.to_owned(),
        _ => format!("{setting}={value}"),
    }
}

impl Draft {
    /// With one more setting in its label and its title.
    fn with(mut self, name: &str, value: Value) -> Self {
        let shown = shown(&value);
        let title = title(name, &shown);
        append(&mut self.label, &format!("{name}={shown}"));
        append(&mut self.title, &title);
        if !SIZES.contains(&name) {
            append(&mut self.series, &title);
        }
        self.coordinates.push(Coordinate { setting: name.to_owned(), value });
        self
    }

    /// With another start and goal. What is kept out of stands where the motion starts.
    fn pose(&mut self, posed: &Task) {
        self.task.start = posed.start.clone();
        self.task.goal = posed.goal.clone();
        self.task.tool.clone_from(&posed.tool);
        let path = &mut self.task.path;
        if let (Some(own), Some(posed)) = (&path.clearance, &posed.path.clearance) {
            path.clearance = Some(posed.with_least(own.least));
        }
    }

    fn build(self, document: &Document) -> Result<Instance, InputError> {
        if let Some(impossible) = self.task.impossible() {
            let message =
                format!("no motion does the task with `{}`: {}", self.label, impossible.reason);
            return Err(document.error_at(
                document.key("sweep")?.unwrap_or_default(),
                message,
                None,
            ));
        }
        let subject: TaskSubject = self.trajectory.build(Arc::new(self.task), document)?.into();
        let mut instance = subject.into_instance(self.label);
        instance.coordinates = self.coordinates;
        instance.budget = self.budget;
        Ok(instance)
    }
}
