//! Whether the optimisers differ, and which is ahead.

use polars::prelude::*;

use crate::analysis::blocks::{ALPHA, Blocks};
use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::{Friedman, cliques, critical_difference};
use crate::exhibit::Table;

/// One line: Friedman's test and what goes with it.
pub(super) fn friedman_table(blocks: &Blocks) -> PolarsResult<Table> {
    let Friedman { chi_square, p, f, f_p, .. } = blocks.friedman;
    let (n, k) = (blocks.costs.len(), blocks.friedman.mean_ranks.len());
    let frame = df!(
        "blocks" => [n as u64],
        "block" => [blocks.unit.name()],
        "optimisers" => [k as u64],
        "χ²" => [chi_square],
        "p" => [p],
        "F" => [f],
        "p of F" => [f_p],
        "critical difference" => [critical_difference(k, n, ALPHA)],
    )?;
    let caption = format!(
        "Friedman's test of the final certified costs, with Iman and Davenport's F, and Nemenyi's critical difference \
         of mean ranks at level {ALPHA}. {}",
        blocks.told()
    );
    Ok(Table::of("friedman", caption, frame))
}

/// One line per optimiser, the best first.
pub(super) fn table(analysis: &Analysis<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let ranks = &blocks.friedman.mean_ranks;
    let groups = cliques(ranks, |a, b| blocks.differ(a, b));
    let cliques_of = |optimiser: usize| -> String {
        let of = groups.iter().enumerate().filter(|(_, group)| group.contains(&optimiser));
        of.map(|(i, _)| format!("{}", i + 1)).collect::<Vec<_>>().join(" ")
    };
    let order = blocks.order();
    let frame = df!(
        "optimiser" => order.iter().map(|&o| analysis.optimiser(o)).collect::<Vec<_>>(),
        "mean rank" => order.iter().map(|&o| ranks[o]).collect::<Vec<_>>(),
        "cliques" => order.iter().map(|&o| cliques_of(o)).collect::<Vec<_>>(),
    )?;
    let caption = format!(
        "Mean ranks of the final certified costs, 1 being the best. Within a clique no two optimisers differ \
         significantly, which does not mean that they are alike: Wilcoxon's test with Holm's correction at level {ALPHA}. \
         An optimiser without a clique differs from all. {}",
        blocks.told()
    );
    Ok(Table::of("ranks", caption, frame))
}

/// The costs that the tests compare, one line per block.
pub(super) fn blocks_table(analysis: &Analysis<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let optimisers = 0..analysis.plan.optimisers.len();
    let mut block = "block".to_owned();
    while optimisers.clone().any(|o| analysis.optimiser(o) == block) {
        block.push('_');
    }
    let costs = |o: usize| blocks.costs.iter().map(|row| row[o]).collect::<Vec<f64>>();
    let columns: Vec<Column> =
        optimisers.map(|o| Column::new(analysis.optimiser(o).into(), costs(o))).collect();
    let frame = df!(block => &blocks.names)?.hstack(&columns)?;
    let caption = format!("The costs that the tests compare. {}", blocks.told());
    Ok(Table::of("blocks", caption, frame))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::handmade::{plan, runs};
    use crate::analysis::targets;

    #[test]
    fn an_optimiser_called_block_leaves_the_blocks_their_names() {
        let plan = plan(
            "seeds = 2\nbudget = { evaluations = 100 }\n[functions]\nname = ['sphere']\n\
             [[optimiser]]\nlabel = 'block'\nrandom = {}\n[[optimiser]]\nde = {}\n",
        );
        let runs = runs(&plan, |run| vec![(1, run.seed as f64)]);
        let targets = targets(&plan, &runs);
        let analysis = Analysis::new(&plan, &runs, &targets);
        let frame = blocks_table(&analysis, analysis.blocks.as_ref().unwrap()).unwrap().frame;
        assert_eq!(frame.get_column_names(), ["block_", "block", "de"]);
        assert_eq!(frame.column("block_").unwrap().str().unwrap().get(1), Some("seed 2"));
        assert_eq!(frame.column("block").unwrap().f64().unwrap().get(1), Some(2.0));
    }
}
