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
    // Where all blocks rank the optimisers alike F says nothing of how many they are, and its p-value would be zero.
    let of_f = |number| if f.is_finite() && n > 2 { number } else { f64::NAN };
    let frame = df!(
        "blocks" => [n as u64],
        "block" => [blocks.unit.name()],
        "optimisers" => [k as u64],
        "χ²" => [chi_square],
        "p" => [p],
        "F" => [of_f(f)],
        "p of F" => [of_f(f_p)],
        "critical difference" => [critical_difference(k, n, ALPHA)],
    )?;
    let caption = format!(
        "Friedman's test of the final certified costs, with Iman and Davenport's F, and Nemenyi's critical difference \
         of mean ranks at level {ALPHA}. F is left out with fewer than three blocks, and where all rank the optimisers alike. {}",
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

    /// χ² of costs that all blocks rank alike is n (k − 1); with ranks 1 2 3, 2 1 3 and 1 2 3 it is 14/3, and Demšar's formula
    /// (2006, p. 11) gives F = 2 χ² / (6 − χ²) = 7.
    #[test]
    fn an_f_that_says_nothing_is_left_out() {
        let found = |seeds: u64, cost: fn(u64, f64) -> f64| {
            let plan = plan(&format!(
                "seeds = {seeds}\nbudget = {{ evaluations = 100 }}\n[functions]\nname = ['sphere']\n\
                 [[optimiser]]\nrandom = {{}}\n[[optimiser]]\nde = {{}}\n[[optimiser]]\npso = {{}}\n",
            ));
            let runs = runs(&plan, |run| vec![(1, cost(run.seed, run.optimiser as f64))]);
            let targets = targets(&plan, &runs);
            let analysis = Analysis::new(&plan, &runs, &targets);
            let frame = friedman_table(analysis.blocks.as_ref().unwrap()).unwrap().frame;
            ["χ²", "F", "p of F"]
                .map(|name| frame.column(name).unwrap().f64().unwrap().get(0).unwrap())
        };
        let alike = |_, optimiser| optimiser;
        let swapped = |seed, optimiser| {
            if seed == 2 && optimiser < 2.0 { 1.0 - optimiser } else { optimiser }
        };
        for (seeds, cost, statistic) in
            [(2, alike as fn(u64, f64) -> f64, 4.0), (2, swapped, 3.0), (4, alike, 8.0)]
        {
            let [chi_square, f, p] = found(seeds, cost);
            assert!(chi_square == statistic && f.is_nan() && p.is_nan(), "{chi_square}, {f}, {p}");
        }
        let [chi_square, f, p] = found(3, swapped);
        assert!(
            (chi_square - 14.0 / 3.0).abs() < 1e-12 && (f - 7.0).abs() < 1e-9,
            "{chi_square}, {f}"
        );
        assert!(p > 0.04 && p < 0.06, "{p}");
    }
}
