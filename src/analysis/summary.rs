//! One line an optimiser and instance.

use polars::prelude::*;

use super::runs::{Run, groups};
use crate::experiment::Plan;

/// Quantile by linear interpolation between order statistics (Hyndman and Fan 1996, type 7), of
/// sorted values; an infinite neighbour makes it infinite.
pub(super) fn quantile(sorted: &[f64], q: f64) -> f64 {
    let position = q * (sorted.len() - 1) as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    if low == high { low } else { low + (high - low) * position.fract() }
}

/// One line an optimiser and instance: quartiles of the best cost over the seeds, failures counted
/// as infinite, and the best motion's residual \[°\] and duration \[s\]. A column for each of the
/// plan's targets says how many runs reached it. Costs are certified.
pub fn summary(plan: &Plan, runs: &[Run]) -> PolarsResult<DataFrame> {
    let groups = groups(runs);
    let reals = |value: &dyn Fn(&[&Run]) -> f64| -> Vec<f64> {
        groups.iter().map(|group| value(group)).collect()
    };
    let counts = |value: &dyn Fn(&[&Run]) -> u64| -> Vec<u64> {
        groups.iter().map(|group| value(group)).collect()
    };
    let best = |group: &[&Run], value: fn(&Run) -> f64| {
        let best = group.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        best.map_or(f64::NAN, |run| value(run))
    };
    let instance = |g: &Vec<&Run>| plan.instances[g[0].instance].label.as_str();
    let optimiser = |g: &Vec<&Run>| plan.optimisers[g[0].optimiser].label.as_str();
    let mut table = df!(
        "instance" => groups.iter().map(instance).collect::<Vec<_>>(),
        "optimiser" => groups.iter().map(optimiser).collect::<Vec<_>>(),
        "runs" => counts(&|g| g.len() as u64),
        "failed" => counts(&|g| g.iter().filter(|run| run.cost.is_infinite()).count() as u64),
        "best J" => reals(&|g| quantile_of(g, |run| run.cost, 0.0)),
        "quartile 1" => reals(&|g| quantile_of(g, |run| run.cost, 0.25)),
        "median" => reals(&|g| quantile_of(g, |run| run.cost, 0.5)),
        "quartile 3" => reals(&|g| quantile_of(g, |run| run.cost, 0.75)),
        "residual [°]" => reals(&|g| best(g, |run| run.residual_deg)),
        "t_f [s]" => reals(&|g| best(g, |run| run.duration)),
        "evaluations" => counts(&|g| g.iter().map(|run| run.evaluations).sum()),
        "s/run" => reals(&|g| quantile_of(g, |run| run.seconds, 0.5)),
    )?;
    for target in &plan.targets {
        let reached = |g: &Vec<&Run>| {
            format!("{}/{}", g.iter().filter(|run| run.cost <= *target).count(), g.len())
        };
        let reached: Vec<String> = groups.iter().map(reached).collect();
        table.with_column(Column::new(format!("J ≤ {target}").into(), reached))?;
    }
    Ok(table)
}

fn quantile_of(group: &[&Run], value: fn(&Run) -> f64, q: f64) -> f64 {
    let mut values: Vec<f64> = group.iter().map(|run| value(run)).collect();
    values.sort_by(f64::total_cmp);
    quantile(&values, q)
}

#[cfg(test)]
mod tests {
    use super::quantile;

    /// Expected values from `numpy.quantile(..., method="linear")`.
    #[test]
    fn quantiles_interpolate_as_numpy_does() {
        let sorted = [1.0, 2.0, 4.0, 8.0];
        for (q, expected) in [(0.0, 1.0), (0.25, 1.75), (0.5, 3.0), (0.75, 5.0), (1.0, 8.0)] {
            assert_eq!(quantile(&sorted, q), expected);
        }
        assert_eq!(quantile(&[1.0, f64::INFINITY], 0.5), f64::INFINITY);
        assert_eq!(quantile(&[3.0, f64::INFINITY, f64::INFINITY], 1.0), f64::INFINITY);
    }
}
