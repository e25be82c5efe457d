//! Charts of what a sweep over settings of the task comes to.

use super::best::BestMotion;
use super::pareto::{Traded, pareto, trades};
use super::sweeps::{MOST_PANELS, Swept, points, sweep, varies};
use super::words::AT_GOAL_DEG;
use crate::exhibit::words::list;
use crate::exhibit::{Chart, Finding};
use crate::experiment::Instance;
use crate::reorientation::best_known::BestKnown;

/// The names that the charts may have.
pub(super) const NAMES: [&str; 16] = [
    "weight-sweep",
    "rate-sweep",
    "acceleration-sweep",
    "jerk-sweep",
    "turn-sweep",
    "cone-sweep",
    "base-rate-sweep",
    "tool-speed-sweep",
    "torque-sweep",
    "clearance-sweep",
    "largest-turn-weight-sweep",
    "mean-turn-weight-sweep",
    "terms-sweep",
    "pieces-sweep",
    "pareto",
    "turn-pareto",
];

/// A chart for each setting that varies, and one of what each weight trades; and what is said of those that are left out.
pub(super) fn charts(
    best: &[BestMotion<'_>],
    instances: &[Instance],
) -> (Vec<Chart>, Option<Finding>) {
    let bound = best.iter().filter_map(|m| BestKnown::of(m.problem)).find_map(|k| k.free_form_j);
    let (mut charts, mut left_out) = (Vec::new(), Vec::new());
    for swept in Swept::ALL {
        let points = points(best, instances, swept);
        let (name, title, caption) = texts_of(swept);
        let Some(figure) = sweep(&points, swept, bound) else {
            left_out.extend(varies(&points).then_some(name));
            continue;
        };
        let caption = format!(
            "{caption} Motions that end more than {AT_GOAL_DEG}° off the goal are hollow. A line joins neighbouring values that \
             both reach the goal with motions of one branch: at no time is a joint of one further from where it is in the other \
             than a quarter of the largest travel of a joint. Elsewhere, and where a value between gave no motion, there is a \
             gap. With several poses, each pose has a thin line."
        );
        let (name, title) = (name.to_owned(), title.to_owned());
        charts.push(Chart { name, title, caption, table: "best".into(), figure });
    }
    let explain = |names: &[&str]| {
        let why = format!("other settings have more than {MOST_PANELS} combinations");
        Finding::new("Which charts are left out?", format!("{}: {why}.", list(names)))
    };
    let left_out = (!left_out.is_empty()).then(|| explain(&left_out));
    let fronts = Traded::ALL.into_iter().filter_map(|traded| {
        let figure = pareto(&trades(best, traded), traded)?;
        Some(Chart {
            name: traded.name().to_owned(),
            title: format!("{} against duration", traded.title()),
            caption: traded.caption(),
            table: traded.name().into(),
            figure,
        })
    });
    charts.extend(fronts);
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
            "Duration and residual of the best motion against the limit on rates.",
        ),
        Swept::AccelerationLimit => (
            "acceleration-sweep",
            "Limit on accelerations",
            "Duration and residual of the best motion against the limit on accelerations.",
        ),
        Swept::JerkLimit => (
            "jerk-sweep",
            "Limit on jerks",
            "Duration and residual of the best motion against the limit on jerks. The dotted line, where there is one, is the \
             law that holds while jerk alone limits the motion, from the lowest limit on at which the goal is reached.",
        ),
        Swept::TurnLimit => (
            "turn-sweep",
            "Limit on turns of the base",
            "Duration and residual of the best motion against the limit on turns of the base.",
        ),
        Swept::Cone => (
            "cone-sweep",
            "Angle of the cone",
            "Duration and residual of the best motion against the angle of the cone.",
        ),
        Swept::BaseRateLimit => (
            "base-rate-sweep",
            "Limit on rates of the base",
            "Duration and residual of the best motion against the limit on rates of the base.",
        ),
        Swept::ToolSpeedLimit => (
            "tool-speed-sweep",
            "Limit on speeds of the tool",
            "Duration and residual of the best motion against the limit on speeds of the tool.",
        ),
        Swept::TorqueLimit => (
            "torque-sweep",
            "Limit on torques",
            "Duration and residual of the best motion against the limit on torques.",
        ),
        Swept::Clearance => (
            "clearance-sweep",
            "Clearance",
            "Duration and residual of the best motion against the clearance asked for.",
        ),
        Swept::WeightLargestTurn => (
            "largest-turn-weight-sweep",
            "Weight of the largest turn",
            "Largest turn of the base, duration and residual of the best motion against the weight of the largest turn.",
        ),
        Swept::WeightMeanTurn => (
            "mean-turn-weight-sweep",
            "Weight of the mean turn",
            "Largest turn of the base, duration and residual of the best motion against the weight of the mean turn.",
        ),
        Swept::Terms => (
            "terms-sweep",
            "Number of terms",
            "Cost, duration and residual of the best motion against the number of free coefficients per joint. The dotted line, where there is one, \
             is the least cost found for motions of any shape, of piecewise constant jerk.",
        ),
        Swept::Pieces => (
            "pieces-sweep",
            "Number of pieces",
            "Cost, duration and residual of the best motion against the number of pieces of a spline.",
        ),
    }
}
