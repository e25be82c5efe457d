//! Every optimiser against every other.

use super::statistics::{Wilcoxon, holm, vargha_delaney, wilcoxon};

/// Two optimisers, by index, and how they compare.
#[derive(Debug)]
pub(super) struct Pair {
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) test: Wilcoxon,
    /// Holm's p-value over all pairs.
    pub(super) p_holm: f64,
    /// Vargha and Delaney's A12, in the mean over the instances.
    pub(super) effect: f64,
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
