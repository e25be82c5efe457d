//! One line an optimiser and instance.

use polars::prelude::*;

use super::runs::{Run, groups, runs};

/// Quantile by linear interpolation between order statistics (Hyndman and Fan 1996, type 7), of
/// sorted values; an infinite neighbour makes it infinite.
pub(super) fn quantile(sorted: &[f64], q: f64) -> f64 {
    let position = q * (sorted.len() - 1) as f64;
    let (low, high) = (sorted[position.floor() as usize], sorted[position.ceil() as usize]);
    if low == high { low } else { low + (high - low) * position.fract() }
}

/// The summary of a `runs` table: quartiles of the best cost over the seeds, failures counted as
/// infinite, and the best motion's residual \[°\] and duration \[s\]. A column for each target says
/// how many runs reached it.
pub fn summary(frame: &DataFrame, targets: &[f64]) -> PolarsResult<DataFrame> {
    let runs = runs(frame)?;
    let groups = groups(&runs);
    let column = |value: fn(&[&Run]) -> f64| groups.iter().map(|g| value(g)).collect::<Vec<_>>();
    let best = |g: &[&Run], value: fn(&Run) -> f64| {
        g.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).map_or(f64::NAN, |run| value(run))
    };
    let mut table = df!(
        "instance" => groups.iter().map(|g| g[0].instance.as_str()).collect::<Vec<_>>(),
        "optimiser" => groups.iter().map(|g| g[0].optimiser.as_str()).collect::<Vec<_>>(),
        "runs" => groups.iter().map(|g| g.len() as u64).collect::<Vec<_>>(),
        "failed" => groups
            .iter()
            .map(|g| g.iter().filter(|run| !run.cost.is_finite() || run.status == "panicked").count() as u64)
            .collect::<Vec<_>>(),
        "best J" => column(|g| cost_quantile(g, 0.0)),
        "lower quartile" => column(|g| cost_quantile(g, 0.25)),
        "median J" => column(|g| cost_quantile(g, 0.5)),
        "upper quartile" => column(|g| cost_quantile(g, 0.75)),
        "residual [°]" => groups.iter().map(|g| best(g, |run| run.residual_deg)).collect::<Vec<_>>(),
        "t_f [s]" => groups.iter().map(|g| best(g, |run| run.duration)).collect::<Vec<_>>(),
        "evaluations" => groups
            .iter()
            .map(|g| g.iter().map(|run| run.evaluations).sum::<u64>())
            .collect::<Vec<_>>(),
        "seconds a run" => column(|g| {
            let mut seconds: Vec<f64> = g.iter().map(|run| run.seconds).collect();
            seconds.sort_by(f64::total_cmp);
            quantile(&seconds, 0.5)
        }),
    )?;
    for &target in targets {
        let reached = |g: &Vec<&Run>| {
            format!("{}/{}", g.iter().filter(|run| run.cost <= target).count(), g.len())
        };
        let counts: Vec<String> = groups.iter().map(reached).collect();
        table.with_column(Column::new(format!("J ≤ {target}").into(), counts))?;
    }
    Ok(table)
}

fn cost_quantile(group: &[&Run], q: f64) -> f64 {
    let mut costs: Vec<f64> = group.iter().map(|run| run.cost).collect();
    costs.sort_by(f64::total_cmp);
    quantile(&costs, q)
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
