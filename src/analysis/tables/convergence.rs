//! Best cost against evaluations, over the seeds.

use polars::prelude::*;
use rayon::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::quartiles;
use crate::exhibit::Table;
use crate::experiment::Run;

/// Points of a curve, spaced evenly on a logarithmic axis.
const POINTS: usize = 200;

/// Quartiles of the best cost so far over the runs of a group, as the searches evaluated their costs.
struct Curve<'a> {
    /// The optimiser's and the group's label.
    labels: [&'a str; 2],
    /// Evaluations made, ascending, the quartiles at each, and those of the gap to the least cost known.
    points: Vec<(f64, [f64; 3], [f64; 3])>,
}

/// A curve holds where every run of the group still counts: up to the smallest budget among them. A run that ended early
/// keeps the best it had.
fn curve<'a>(analysis: &Analysis<'a>, group: &[&Run]) -> Curve<'a> {
    let budget = group.iter().map(|run| run.budget).min().unwrap_or(1);
    let last = (budget as f64).ln();
    let mut evaluations: Vec<f64> =
        (0..POINTS).map(|i| (last * i as f64 / (POINTS - 1) as f64).exp().round()).collect();
    evaluations.dedup();
    let known = |run: &Run| analysis.plan.instances[run.instance].subject.known_cost();
    let known: Vec<f64> = group.iter().map(|run| known(run).unwrap_or(f64::NAN)).collect();
    let is_known = known.iter().all(|known| known.is_finite());
    let point = |made: f64| {
        let costs = || group.iter().map(|run| run.best_at(made as u64));
        let gaps = || costs().zip(&known).map(|(cost, known)| cost - known);
        let gaps = if is_known { quartiles(gaps()) } else { [f64::NAN; 3] };
        (made, quartiles(costs()), gaps)
    };
    Curve {
        labels: analysis.labels(group),
        points: evaluations.into_par_iter().map(point).collect(),
    }
}

/// One line per optimiser, group and place on the curve.
pub(super) fn table(analysis: &Analysis<'_>) -> PolarsResult<Table> {
    let curves: Vec<Curve<'_>> =
        analysis.groups.iter().map(|group| curve(analysis, group)).collect();
    let rows = || curves.iter().flat_map(|c| c.points.iter().map(move |point| (c.labels, point)));
    let frame = df!(
        "group" => rows().map(|(labels, _)| labels[1]).collect::<Vec<_>>(),
        "optimiser" => rows().map(|(labels, _)| labels[0]).collect::<Vec<_>>(),
        "evaluations" => rows().map(|(_, point)| point.0).collect::<Vec<_>>(),
        "quartile 1" => rows().map(|(_, point)| point.1[0]).collect::<Vec<_>>(),
        "median" => rows().map(|(_, point)| point.1[1]).collect::<Vec<_>>(),
        "quartile 3" => rows().map(|(_, point)| point.1[2]).collect::<Vec<_>>(),
        "gap quartile 1" => rows().map(|(_, point)| point.2[0]).collect::<Vec<_>>(),
        "gap median" => rows().map(|(_, point)| point.2[1]).collect::<Vec<_>>(),
        "gap quartile 3" => rows().map(|(_, point)| point.2[2]).collect::<Vec<_>>(),
    )?;
    let caption = "Quartiles over the runs of the best cost so far, as the search evaluated it, after so many \
        evaluations, up to the smallest budget of the group; and of how far it lies above the least cost known of each run's \
        instance, where there is one.";
    Ok(Table::curve("convergence", caption, frame))
}
