//! Whether the optimisers differ, and which is ahead.

use polars::prelude::*;

use super::pairs::{Pair, pairs};
use super::{ALPHA, Field, Table, median};
use crate::analysis::Run;
use crate::analysis::statistics::{Friedman, cliques, critical_difference, friedman};

/// Final costs of all optimisers, block by block.
pub(super) struct Blocks {
    /// One row a block, one cost an optimiser.
    pub(super) costs: Vec<Vec<f64>>,
    /// What a block is.
    pub(super) unit: &'static str,
    /// What the tests say.
    pub(super) friedman: Friedman,
}

impl Blocks {
    /// Instances are the blocks, with the median over their seeds; where there is but one, its seeds are.
    /// None where there are fewer than two blocks or optimisers.
    pub(super) fn of(field: &Field<'_>) -> Option<Self> {
        let optimisers = field.plan.optimisers.len();
        let mut cells = vec![vec![Vec::new(); optimisers]; field.plan.instances.len()];
        field.runs.iter().for_each(|run| cells[run.instance][run.optimiser].push(run));
        cells.retain(|row: &Vec<Vec<&Run>>| row.iter().all(|cell| !cell.is_empty()));
        let costs = |cell: &Vec<&Run>| cell.iter().map(|run| run.cost).collect::<Vec<f64>>();
        let (unit, costs) = match &cells[..] {
            [] => return None,
            [only] => ("seeds", by_seed(only)),
            many => {
                let row =
                    |row: &Vec<Vec<&Run>>| row.iter().map(|cell| median(&costs(cell))).collect();
                ("instances", many.iter().map(row).collect())
            }
        };
        Some(Self { friedman: friedman(&costs)?, costs, unit })
    }

    /// What the tests stand on, in words.
    pub(super) fn told(&self) -> String {
        let n = self.costs.len();
        match self.unit {
            "seeds" => format!(
                "Blocks are the {n} seeds of the only instance, so it says nothing about other instances."
            ),
            _ => format!("Blocks are {n} instances, each with the median cost over its seeds."),
        }
    }
}

/// Costs of the seeds that every optimiser has tried.
fn by_seed(cells: &[Vec<&Run>]) -> Vec<Vec<f64>> {
    let row = |seed: u64| {
        let of = |cell: &Vec<&Run>| cell.iter().find(|run| run.seed == seed).map(|run| run.cost);
        cells.iter().map(of).collect::<Option<Vec<f64>>>()
    };
    cells[0].iter().filter_map(|run| row(run.seed)).collect()
}

/// One line: Friedman's test and what goes with it.
pub(super) fn friedman_table(field: &Field<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let Friedman { chi_square, p, f, f_p, .. } = blocks.friedman;
    let (n, k) = (blocks.costs.len(), field.plan.optimisers.len());
    let frame = df!(
        "blocks" => [n as u64],
        "block" => [blocks.unit],
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
    Ok(Table::new("friedman", caption, frame))
}

/// One line an optimiser, the best first.
pub(super) fn table(field: &Field<'_>, blocks: &Blocks) -> PolarsResult<Table> {
    let ranks = &blocks.friedman.mean_ranks;
    let pairs = pairs(field, blocks);
    let differ = |a: usize, b: usize| {
        let of = |pair: &&Pair| [pair.first, pair.second] == [a.min(b), a.max(b)];
        pairs.iter().find(of).is_some_and(|pair| pair.p_holm <= ALPHA)
    };
    let groups = cliques(ranks, differ);
    let alike = |optimiser: usize| -> String {
        let of = groups.iter().enumerate().filter(|(_, group)| group.contains(&optimiser));
        of.map(|(i, _)| format!("{}", i + 1)).collect::<Vec<_>>().join(" ")
    };
    let mut order: Vec<usize> = (0..ranks.len()).collect();
    order.sort_by(|&a, &b| ranks[a].total_cmp(&ranks[b]));
    let frame = df!(
        "optimiser" => order.iter().map(|&o| field.optimiser(o)).collect::<Vec<_>>(),
        "mean rank" => order.iter().map(|&o| ranks[o]).collect::<Vec<_>>(),
        "alike" => order.iter().map(|&o| alike(o)).collect::<Vec<_>>(),
    )?;
    let caption = format!(
        "Mean ranks of the final certified costs, 1 being the best. Optimisers with a number of `alike` in common do not \
         differ by Wilcoxon's test with Holm's correction at level {ALPHA}. {}",
        blocks.told()
    );
    Ok(Table::new("ranks", caption, frame))
}
