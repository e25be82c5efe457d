//! Performance and data profiles.

use std::collections::BTreeMap;

use polars::prelude::*;

use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::{ProfileStep, data_profiles, performance_profiles};
use crate::exhibit::Table;

/// Both profiles, a curve per optimiser and target. A problem is an instance with a seed; those that an
/// optimiser has not tried yet are left out.
pub(super) fn tables(analysis: &Analysis<'_>) -> PolarsResult<[Table; 2]> {
    let (mut performance, mut data) = (Curves::default(), Curves::default());
    let mut most = 0;
    for k in 0..analysis.targets.count() {
        let target = &analysis.target_label(k);
        let (times, dimensions) = problems(analysis, k);
        most = most.max(times.len());
        performance.add(analysis, target, performance_profiles(&times), 1.0);
        data.add(analysis, target, data_profiles(&times, &dimensions), 0.0);
    }
    let pool: Vec<&str> = analysis.plan.optimisers.iter().map(|o| o.label.as_str()).collect();
    let pool = pool.join(", ");
    Ok([
        Table::curve(
            "performance-profiles",
            format!(
                "Share of {most} problems, each an instance with a seed that all optimisers tried, whose target is reached \
                 within a multiple of the fewest evaluations that any of these needed: {pool}."
            ),
            performance.into_frame("ratio")?,
        ),
        Table::curve(
            "data-profiles",
            format!(
                "Share of {most} problems, each an instance with a seed that all optimisers tried, whose target is reached \
                 within so many simplex gradients, n + 1 evaluations each, by each of {pool}. n is the same for all formulations of a \
                 problem."
            ),
            data.into_frame("simplex gradients")?,
        ),
    ])
}

/// Evaluations to the k-th target for every problem and optimiser, and every problem's dimension.
fn problems(analysis: &Analysis<'_>, k: usize) -> (Vec<Vec<f64>>, Vec<usize>) {
    let solvers = analysis.plan.optimisers.len();
    let mut rows: BTreeMap<(usize, u64), Vec<Option<f64>>> = BTreeMap::new();
    for run in analysis.runs {
        if let Some(&target) = analysis.targets.values[run.instance].get(k) {
            let row = rows.entry((run.instance, run.seed)).or_insert_with(|| vec![None; solvers]);
            row[run.optimiser] = Some(run.hit(target).map_or(f64::INFINITY, |hit| hit as f64));
        }
    }
    let complete = |(&(instance, _), row): (&(usize, u64), &Vec<Option<f64>>)| {
        let row: Option<Vec<f64>> = row.iter().copied().collect();
        row.map(|row| (row, analysis.plan.instances[instance].subject.dimension()))
    };
    rows.iter().filter_map(complete).unzip()
}

#[derive(Default)]
struct Curves {
    targets: Vec<String>,
    optimisers: Vec<String>,
    steps: Vec<ProfileStep>,
}

impl Curves {
    /// Every curve begins with a share of 0, be it where it ends as well.
    fn add(
        &mut self,
        analysis: &Analysis<'_>,
        target: &str,
        profiles: Vec<Vec<ProfileStep>>,
        first: f64,
    ) {
        let zero = ProfileStep { time: first, share: 0.0 };
        for (optimiser, steps) in profiles.into_iter().enumerate() {
            for step in std::iter::once(zero).chain(steps) {
                self.targets.push(target.to_owned());
                self.optimisers.push(analysis.optimiser(optimiser).to_owned());
                self.steps.push(step);
            }
        }
    }

    fn into_frame(self, time: &str) -> PolarsResult<DataFrame> {
        df!(
            "target" => self.targets,
            "optimiser" => self.optimisers,
            time => self.steps.iter().map(|step| step.time).collect::<Vec<_>>(),
            "share" => self.steps.iter().map(|step| step.share).collect::<Vec<_>>(),
        )
    }
}
