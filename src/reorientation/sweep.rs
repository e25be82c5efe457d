//! The instances of a sweep over the reorientation task.

use std::num::NonZeroU64;
use std::sync::Arc;

use super::bases::{Base, bases};
use super::best_known::BestKnown;
use super::keys::{Evaluations, Sweep, TaskKeys};
use super::settings::TrajectoryTable;
use super::subject::TaskSubject;
use super::symbols::K_B;
use crate::experiment::{Coordinate, Instance, Value};
use crate::input::{Document, InputError, Positive};
use crate::task::{PoseTable, Task, TaskTable};

/// Targets where the file states none: by which shares they exceed the best known cost.
const GAPS: [f64; 3] = [0.1, 0.01, 0.001];

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
    let poses = poses(task, sweep, own, document)?;
    let posed = |pose: &PoseTable| task.with_pose(pose).build(own);
    let posed: Vec<Task> = poses.iter().map(posed).collect::<Result<_, _>>()?;
    // The task's own start and goal need not fit the robot where poses replace them.
    let task = posed.first().map_or_else(|| task.build(own), |task| Ok(task.clone()))?;
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
            draft.task.start = posed.start.clone();
            draft.task.goal = posed.goal.clone();
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

    fn build(self, document: &Document) -> Result<Instance, InputError> {
        let subject: TaskSubject = self.trajectory.build(Arc::new(self.task), document)?.into();
        let known = BestKnown::of(subject.reorientation());
        let targets = known.into_iter().flat_map(|known| GAPS.map(|gap| known.target(gap)));
        let targets: Vec<f64> = targets.collect();
        let mut instance = Instance::new(self.label, Arc::new(subject)).with_targets(targets);
        instance.coordinates = self.coordinates;
        instance.budget = self.budget;
        Ok(instance)
    }
}
