//! Charts of what a sweep over settings of the task comes to.

use super::best::BestMotion;
use super::pareto::{pareto, trades};
use super::sweeps::{Swept, points, sweep};
use crate::exhibit::Chart;
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

/// A chart for each setting that varies, and one of what the weight trades.
pub(super) fn charts(best: &[BestMotion<'_>]) -> Vec<Chart> {
    let bound = best.iter().filter_map(|m| BestKnown::of(m.problem)).find_map(|k| k.free_form_j);
    let of = |swept: Swept| {
        let figure = sweep(&points(best, swept), swept, bound)?;
        let (name, title, caption) = told(swept);
        let (name, title, caption) = (name.to_owned(), title.to_owned(), caption.to_owned());
        Some(Chart { name, title, caption, table: "best".into(), figure })
    };
    let mut charts: Vec<Chart> = Swept::ALL.into_iter().filter_map(of).collect();
    charts.extend(pareto(&trades(best)).map(|figure| Chart {
        name: "pareto".to_owned(),
        title: "Residual against duration".to_owned(),
        caption: "Residual against duration of the best motions of all weights; efficient are those that no other \
                  weight's beats in one without being worse in the other."
            .to_owned(),
        table: "pareto".into(),
        figure,
    }));
    charts
}

/// Name, title and caption of a sweep's chart.
fn told(swept: Swept) -> (&'static str, &'static str, &'static str) {
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
            "Duration of the best motion against the limit on jerks. The dashed line, where there is one, is the \
             law that holds while jerk alone limits the motion.",
        ),
        Swept::Terms => (
            "terms-sweep",
            "Number of terms",
            "Cost of the best motion against the number of free coefficients per joint. The dashed line, where there is one, \
             is the least cost found for motions of any shape, of piecewise constant jerk.",
        ),
        Swept::Pieces => (
            "pieces-sweep",
            "Number of pieces",
            "Cost of the best motion against the number of pieces of a spline.",
        ),
    }
}
