//! The instances of a sweep over the reorientation task.

use std::fmt::Write as _;
use std::sync::Arc;

use super::{Instance, Sweep};
use crate::input::{Document, InputError, Positive};
use crate::problem::{BestKnown, TrajectoryTable};
use crate::task::{Task, TaskTable};

/// Targets where the file states none: by which shares they exceed the best known cost.
const GAPS: [f64; 3] = [0.1, 0.01, 0.001];

/// The cross product of the sweep's lists.
pub(super) fn instances(
    task: &TaskTable,
    trajectory: &TrajectoryTable,
    sweep: &Sweep,
    document: &Document,
) -> Result<Vec<Instance>, InputError> {
    /// A task on its way through the lists, with what they have set so far.
    #[derive(Clone)]
    struct Draft {
        label: String,
        task: Task,
        terms: toml::Spanned<usize>,
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
    let limit = |order: usize| {
        move |draft: &mut Draft, limit: &Positive| {
            draft.task.limits.0.iter_mut().for_each(|l| l[order] = limit.0.to_radians());
            limit.0.to_string()
        }
    };
    let (task, terms) = (task.build(document)?, trajectory.terms().clone());
    let mut drafts = vec![Draft { label: String::new(), task, terms }];
    drafts = cross(drafts, "weight_base", &sweep.weight_base, |draft, weight| {
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
    let build = |draft: Draft| {
        let table = trajectory.with_terms(draft.terms);
        let (problem, boxes) = table.build(Arc::new(draft.task), document)?;
        let known = BestKnown::of(&problem);
        let targets = known.into_iter().flat_map(|known| GAPS.map(|gap| known.target(gap)));
        let targets = targets.collect();
        Ok(Instance { targets, ..Instance::task(draft.label, Arc::new(problem), boxes) })
    };
    drafts.into_iter().map(build).collect()
}
