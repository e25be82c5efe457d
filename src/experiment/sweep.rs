//! The instances of a sweep over the reorientation task.

use std::fmt::Write as _;
use std::num::NonZeroU64;
use std::sync::Arc;

use toml::Spanned;

use super::{Evaluations, Instance, Sweep};
use crate::input::{Document, InputError, Positive};
use crate::reorientation::{BestKnown, TrajectoryTable};
use crate::task::{PoseTable, Task, TaskTable};

/// Targets where the file states none: by which shares they exceed the best known cost.
const GAPS: [f64; 3] = [0.1, 0.01, 0.001];

/// A task on its way through the lists, with what they have set so far.
#[derive(Clone)]
struct Draft {
    label: String,
    task: Task,
    terms: Spanned<usize>,
    budget: Option<NonZeroU64>,
}

/// The cross product of the sweep's lists; instances that differ in the pose alone are one group.
pub(super) fn instances(
    task: &TaskTable,
    trajectory: &TrajectoryTable,
    sweep: &Sweep,
    document: &Document,
) -> Result<Vec<Instance>, InputError> {
    let poses = poses(task, sweep, document)?;
    let posed: Vec<Task> =
        poses.iter().map(|pose| task.with_pose(pose).build(document)).collect::<Result<_, _>>()?;
    // The task's own start and goal need not fit the robot where poses replace them.
    let task = posed.first().map_or_else(|| task.build(document), |task| Ok(task.clone()))?;
    let first =
        Draft { label: String::new(), task, terms: trajectory.terms().clone(), budget: None };
    let mut instances = Vec::new();
    for group in drafts(first, sweep) {
        let numbered: Vec<(usize, &Task)> = (1..).zip(&posed).collect();
        let drafts = cross(vec![group.clone()], "pose", &numbered, |draft, (number, posed)| {
            draft.task.start = posed.start.clone();
            draft.task.goal = posed.goal.clone();
            number.to_string()
        });
        for draft in drafts {
            instances.push(Instance {
                group: group.label.clone(),
                ..draft.build(trajectory, document)?
            });
        }
    }
    Ok(instances)
}

/// The pairs of start and goal that replace the task's.
fn poses(
    task: &TaskTable,
    sweep: &Sweep,
    document: &Document,
) -> Result<Vec<PoseTable>, InputError> {
    match &sweep.random_poses {
        None => Ok(sweep.pose.clone()),
        Some(random) if sweep.pose.is_empty() => Ok(random.get_ref().draw(&task.robot(document)?)),
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
            limit.0.to_string()
        }
    };
    let mut drafts = cross(vec![first], "weight_base", &sweep.weight_base, |draft, weight| {
        draft.task.base_weight = weight.0;
        weight.0.to_string()
    });
    drafts = cross(drafts, "rate_limit_deg_s", &sweep.rate_limit_deg_s, limit(0));
    drafts = cross(drafts, "acceleration_limit_deg_s2", &sweep.acceleration_limit_deg_s2, limit(1));
    drafts = cross(drafts, "jerk_limit_deg_s3", &sweep.jerk_limit_deg_s3, limit(2));
    drafts = cross(drafts, "terms", &sweep.terms, |draft, terms| {
        draft.terms = terms.clone();
        terms.get_ref().to_string()
    });
    cross(drafts, "budget", &sweep.budget, |draft, Evaluations(evaluations)| {
        draft.budget = Some(*evaluations);
        evaluations.to_string()
    })
}

/// Every draft with every value of one list; a list without values leaves the drafts alone.
fn cross<T>(
    drafts: Vec<Draft>,
    name: &str,
    values: &[T],
    set: impl Fn(&mut Draft, &T) -> String,
) -> Vec<Draft> {
    if values.is_empty() {
        return drafts;
    }
    let with = |draft: &Draft, value: &T| {
        let mut draft = draft.clone();
        let shown = set(&mut draft, value);
        let space = if draft.label.is_empty() { "" } else { " " };
        let _ = write!(draft.label, "{space}{name}={shown}");
        draft
    };
    drafts.iter().flat_map(|draft| values.iter().map(|value| with(draft, value))).collect()
}

impl Draft {
    fn build(
        self,
        trajectory: &TrajectoryTable,
        document: &Document,
    ) -> Result<Instance, InputError> {
        let table = trajectory.with_terms(self.terms);
        let (problem, boxes) = table.build(Arc::new(self.task), document)?;
        let known = BestKnown::of(&problem);
        let targets = known.into_iter().flat_map(|known| GAPS.map(|gap| known.target(gap)));
        let targets = targets.collect();
        let instance = Instance::task(self.label, Arc::new(problem), boxes);
        Ok(Instance { targets, budget: self.budget, ..instance })
    }
}
