//! Every optimiser against every other.

use polars::prelude::*;

use crate::analysis::blocks::Blocks;
use crate::analysis::grouped::Analysis;
use crate::exhibit::Table;

/// One line per pair.
pub(super) fn table(analysis: &Analysis<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let pairs = &blocks.pairs;
    let frame = df!(
        "first" => pairs.iter().map(|p| analysis.optimiser(p.first)).collect::<Vec<_>>(),
        "second" => pairs.iter().map(|p| analysis.optimiser(p.second)).collect::<Vec<_>>(),
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
    Ok(Table::of("pairs", caption, frame))
}
