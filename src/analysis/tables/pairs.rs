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
    /// Vargha and Delaney's A12, in the mean over the instances.
    effect: f64,
}

/// All pairs, from the costs of each block and from all runs of each instance, by optimiser.
pub(super) fn pairs(blocks: &[Vec<f64>], instances: &[&[Vec<(u64, f64)>]]) -> Vec<Pair> {
    let count = blocks.first().map_or(0, Vec::len);
    let column = |i: usize| blocks.iter().map(|row| row[i]).collect::<Vec<f64>>();
    let places = (0..count).flat_map(|first| (first + 1..count).map(move |second| (first, second)));
    let tests: Vec<_> = places.map(|(a, b)| (a, b, wilcoxon(&column(a), &column(b)))).collect();
    let adjusted = holm(&tests.iter().map(|(_, _, test)| test.p).collect::<Vec<_>>());
    let pair = |((first, second, test), p_holm)| {
        let effect = effect(instances, first, second);
        Pair { first, second, test, p_holm, effect }
    };
    tests.into_iter().zip(adjusted).map(pair).collect()
}

fn effect(instances: &[&[Vec<(u64, f64)>]], first: usize, second: usize) -> f64 {
    let costs = |cell: &[(u64, f64)]| cell.iter().map(|run| run.1).collect::<Vec<f64>>();
    let effects =
        instances.iter().map(|cells| vargha_delaney(&costs(&cells[first]), &costs(&cells[second])));
    effects.sum::<f64>() / instances.len() as f64
}

/// One line a pair.
pub(super) fn table(field: &Field<'_>, blocks: &Blocks<'_>) -> PolarsResult<Table> {
    let pairs = &blocks.pairs;
    let frame = df!(
        "first" => pairs.iter().map(|p| field.optimiser(p.first)).collect::<Vec<_>>(),
        "second" => pairs.iter().map(|p| field.optimiser(p.second)).collect::<Vec<_>>(),
        "blocks" => vec![blocks.costs.len() as u64; pairs.len()],
        "differing" => pairs.iter().map(|p| p.test.pairs as u64).collect::<Vec<_>>(),
        "rank sum first lower" => pairs.iter().map(|p| p.test.first_lower).collect::<Vec<_>>(),
        "rank sum second lower" => pairs.iter().map(|p| p.test.second_lower).collect::<Vec<_>>(),
        "p" => pairs.iter().map(|p| p.test.p).collect::<Vec<_>>(),
        "exact" => pairs.iter().map(|p| if p.test.exact { "yes" } else { "no" }).collect::<Vec<_>>(),
        "p Holm" => pairs.iter().map(|p| p.p_holm).collect::<Vec<_>>(),
        "A12" => pairs.iter().map(|p| p.effect).collect::<Vec<_>>(),
    )?;
    let caption = format!(
        "Wilcoxon's signed-rank test of the final certified costs, two-sided, with Holm's correction over all pairs; \
         A12 is the probability that a run of the first ends lower than a run of the second on the same instance, ties \
         half, in the mean over instances. {}",
        blocks.told()
    );
    Ok(Table::new("pairs", caption, frame))
}
