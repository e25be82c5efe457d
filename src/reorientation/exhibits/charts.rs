//! Charts of what a sweep over settings of the task comes to.

use super::best::BestMotion;
use super::pareto::{pareto, trades};
use super::sweeps::{MOST_PANELS, Swept, points, sweep, varies};
use super::words::AT_GOAL_DEG;
use crate::exhibit::words::list;
use crate::exhibit::{Chart, Finding};
use crate::reorientation::best_known::BestKnown;

/// The names that the charts may have.
pub(super) const NAMES: [&str; 7] = [
    "weight-sweep",
    "rate-sweep",
    "acceleration-sweep",
    "jerk-sweep",
    "terms-sweep",
    "pieces-sweep",
    "pareto",
];

/// A chart for each setting that varies, and one of what the weight trades; and what is said of those that are left out.
pub(super) fn charts(best: &[BestMotion<'_>]) -> (Vec<Chart>, Option<Finding>) {
    let bound = best.iter().filter_map(|m| BestKnown::of(m.problem)).find_map(|k| k.free_form_j);
    let (mut charts, mut left_out) = (Vec::new(), Vec::new());
    for swept in Swept::ALL {
        let points = points(best, swept);
        let (name, title, caption) = texts_of(swept);
        let Some(figure) = sweep(&points, swept, bound) else {
            left_out.extend(varies(&points).then_some(name));
            continue;
        };
        let joined = match swept {
            Swept::Terms | Swept::Pieces => "",
            Swept::WeightBase => ", and joined to none that reaches it",
            _ => ", and joined to no other",
        };
        let caption = format!(
            "{caption} Motions that end more than {AT_GOAL_DEG}° off the goal are hollow{joined}. Of several poses \
             each has a thin line."
        );
        let (name, title) = (name.to_owned(), title.to_owned());
        charts.push(Chart { name, title, caption, table: "best".into(), figure });
    }
    let explain = |names: &[&str]| {
        let why = format!("other settings have more than {MOST_PANELS} combinations");
        Finding::new("Which charts are left out?", format!("{}: {why}.", list(names)))
    };
    let left_out = (!left_out.is_empty()).then(|| explain(&left_out));
    charts.extend(pareto(&trades(best)).map(|figure| Chart {
        name: "pareto".to_owned(),
        title: "Residual against duration".to_owned(),
        caption: "Residual against duration of the best motions of all weights; efficient are those that no other \
                  weight's beats in one without being worse in the other."
            .to_owned(),
        table: "pareto".into(),
        figure,
    }));
    (charts, left_out)
}

/// Name, title and caption of a sweep's chart.
fn texts_of(swept: Swept) -> (&'static str, &'static str, &'static str) {
    match swept {
        Swept::WeightBase => (
            "weight-sweep",
            "Weight of the base",
            "Residual and duration of the best motion against the weight of the base.",
        ),
        Swept::RateLimit => (
            "rate-sweep",
            "Limit on rates",
            "Duration of the best motion against the limit on rates.",
        ),
        Swept::AccelerationLimit => (
            "acceleration-sweep",
            "Limit on accelerations",
            "Duration of the best motion against the limit on accelerations.",
        ),
        Swept::JerkLimit => (
            "jerk-sweep",
            "Limit on jerks",
            "Duration of the best motion against the limit on jerks. The dotted line, where there is one, is the \
             law that holds while jerk alone limits the motion, from the lowest limit on at which the goal is reached.",
        ),
        Swept::Terms => (
            "terms-sweep",
            "Number of terms",
            "Cost of the best motion against the number of free coefficients per joint. The dotted line, where there is one, \
             is the least cost found for motions of any shape, of piecewise constant jerk.",
        ),
        Swept::Pieces => (
            "pieces-sweep",
            "Number of pieces",
            "Cost of the best motion against the number of pieces of a spline.",
        ),
    }
}
