//! Every optimiser against every other.

use polars::prelude::*;

use super::ranks::Blocks;
use super::{Field, Table};
use crate::analysis::statistics::{Wilcoxon, holm, vargha_delaney, wilcoxon};

/// Two optimisers, by index, and how they compare.
pub(super) struct Pair {
    pub(super) first: usize,
    pub(super) second: usize,
    test: Wilcoxon,
    /// Holm's p-value over all pairs.
    pub(super) p_holm: f64,
}

/// All pairs.
pub(super) fn pairs(field: &Field<'_>, blocks: &Blocks) -> Vec<Pair> {
    let count = field.plan.optimisers.len();
    let column = |i: usize| blocks.costs.iter().map(|row| row[i]).collect::<Vec<f64>>();
    let places = (0..count).flat_map(|first| (first + 1..count).map(move |second| (first, second)));
    let tests: Vec<_> = places.map(|(a, b)| (a, b, wilcoxon(&column(a), &column(b)))).collect();
    let adjusted = holm(&tests.iter().map(|(_, _, test)| test.p).collect::<Vec<_>>());
    let pair = |((first, second, test), p_holm)| Pair { first, second, test, p_holm };
    tests.into_iter().zip(adjusted).map(pair).collect()
}

/// One line a pair.
pub(super) fn table(field: &Field<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let pairs = pairs(field, blocks);
    let effects = effects(field);
    let frame = df!(
        "first" => pairs.iter().map(|p| field.optimiser(p.first)).collect::<Vec<_>>(),
        "second" => pairs.iter().map(|p| field.optimiser(p.second)).collect::<Vec<_>>(),
        "blocks" => vec![blocks.costs.len() as u64; pairs.len()],
        "differing" => pairs.iter().map(|p| p.test.pairs as u64).collect::<Vec<_>>(),
        "rank sum first lower" => pairs.iter().map(|p| p.test.first_lower).collect::<Vec<_>>(),
        "rank sum second lower" => pairs.iter().map(|p| p.test.second_lower).collect::<Vec<_>>(),
        "p" => pairs.iter().map(|p| p.test.p).collect::<Vec<_>>(),
        "p Holm" => pairs.iter().map(|p| p.p_holm).collect::<Vec<_>>(),
        "A12" => pairs.iter().map(|p| effects[p.first][p.second]).collect::<Vec<_>>(),
    )?;
    let caption = format!(
        "Wilcoxon's signed-rank test of the final certified costs, two-sided, with Holm's correction over all pairs; \
         A12 is the probability that a run of the first ends lower than a run of the second on the same instance, ties \
         half, in the mean over instances. {}",
        blocks.told()
    );
    Ok(Table::new("pairs", caption, frame))
}

/// Vargha and Delaney's A12 of every two optimisers, in the mean over the instances that both have tried.
fn effects(field: &Field<'_>) -> Vec<Vec<f64>> {
    let count = field.plan.optimisers.len();
    let mut costs = vec![vec![Vec::new(); count]; field.plan.instances.len()];
    field.runs.iter().for_each(|run| costs[run.instance][run.optimiser].push(run.cost));
    let mean = |a: usize, b: usize| {
        let both = costs.iter().filter(|row| !row[a].is_empty() && !row[b].is_empty());
        let all: Vec<f64> = both.map(|row| vargha_delaney(&row[a], &row[b])).collect();
        all.iter().sum::<f64>() / all.len() as f64
    };
    (0..count).map(|a| (0..count).map(|b| if a < b { mean(a, b) } else { 0.5 }).collect()).collect()
}
