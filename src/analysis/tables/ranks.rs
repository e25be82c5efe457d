//! Whether the optimisers differ, and which is ahead.

use polars::prelude::*;

use super::pairs::{Pair, pairs};
use super::{ALPHA, Field, Table};
use crate::analysis::statistics::{Friedman, cliques, critical_difference, friedman, median};
use crate::analysis::ties::settled;

/// What the tests stand on: final costs of all optimisers, block by block.
pub(super) struct Blocks<'a> {
    field: &'a Field<'a>,
    /// One row a block, one cost an optimiser.
    pub(super) costs: Vec<Vec<f64>>,
    names: Vec<String>,
    /// What a block is.
    unit: &'static str,
    /// What Friedman's test says.
    friedman: Friedman,
    /// All pairs of optimisers.
    pub(super) pairs: Vec<Pair>,
}

/// Seed and cost of every run, by instance and optimiser.
type Cells = Vec<Vec<Vec<(u64, f64)>>>;

impl<'a> Blocks<'a> {
    /// Instances are the blocks, with the median over their seeds; of those that differ in budget alone,
    /// the one with the largest. Where the experiment has but one, its seeds are the blocks. None where
    /// there are fewer than two blocks or optimisers.
    pub(super) fn of(field: &'a Field<'a>) -> Option<Self> {
        let plan = field.plan;
        let mut cells: Cells = vec![vec![Vec::new(); plan.optimisers.len()]; plan.instances.len()];
        for (run, cost) in field.runs.iter().zip(settled(plan, field.runs)) {
            cells[run.instance][run.optimiser].push((run.seed, cost));
        }
        let problems = largest_budgets(field);
        let is_whole = |&i: &usize| cells[i].iter().all(|cell| !cell.is_empty());
        let whole: Vec<usize> = problems.iter().copied().filter(is_whole).collect();
        let (unit, costs, names) = if let (&[_], &[only]) = (&problems[..], &whole[..]) {
            let (seeds, costs) = by_seed(&cells[only]);
            ("seeds", costs, seeds.iter().map(|seed| format!("seed {seed}")).collect())
        } else {
            let costs = |cell: &Vec<(u64, f64)>| cell.iter().map(|run| run.1).collect();
            let row = |&i: &usize| cells[i].iter().map(|cell| median(costs(cell))).collect();
            let name = |&i: &usize| plan.instances[i].label.clone();
            ("instances", whole.iter().map(row).collect(), whole.iter().map(name).collect())
        };
        let pairs = pairs(&costs, &whole.iter().map(|&i| &cells[i][..]).collect::<Vec<_>>());
        Some(Self { friedman: friedman(&costs)?, field, costs, names, unit, pairs })
    }

    /// What the tests stand on, in words.
    pub(super) fn told(&self) -> String {
        let n = self.costs.len();
        let mut told = match self.unit {
            "seeds" => format!(
                "Blocks are the {n} seeds of the only instance, so it says nothing about other instances."
            ),
            _ => format!(
                "Blocks are {n} instances, those with the largest budget, each with the median cost over its seeds."
            ),
        };
        told += " Costs that differ by less than 10⁻⁶ of themselves, on other problems than the task by less than 10⁻⁸, \
            are taken for the same.";
        // The least that the signed ranks of n pairs can give, before Holm's correction of the first pair.
        if 2_f64.powi(1 - n as i32) * self.pairs.len() as f64 > ALPHA {
            told += " With so few blocks no pair can differ significantly.";
        }
        if self.field.plan.is_uneven() {
            told += " Budgets differ within the field, so final costs do not compare.";
        }
        told
    }
}

/// The instances, of those that differ in budget alone the one with the largest.
fn largest_budgets(field: &Field<'_>) -> Vec<usize> {
    let (instances, problems) = (&field.plan.instances, field.plan.problems());
    let budget = |i: usize| instances[i].budget;
    let is_largest = |&i: &usize| {
        (0..instances.len()).all(|j| problems[j] != problems[i] || budget(j) <= budget(i))
    };
    (0..instances.len()).filter(is_largest).collect()
}

/// The seeds that every optimiser has tried, and their costs.
fn by_seed(cells: &[Vec<(u64, f64)>]) -> (Vec<u64>, Vec<Vec<f64>>) {
    let row = |&(seed, _): &(u64, f64)| {
        let of = |cell: &Vec<(u64, f64)>| cell.iter().find(|run| run.0 == seed).map(|run| run.1);
        Some((seed, cells.iter().map(of).collect::<Option<Vec<f64>>>()?))
    };
    cells[0].iter().filter_map(row).unzip()
}

/// One line: Friedman's test and what goes with it.
pub(super) fn friedman_table(field: &Field<'_>, blocks: &Blocks<'_>) -> PolarsResult<Table> {
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
pub(super) fn table(field: &Field<'_>, blocks: &Blocks<'_>) -> PolarsResult<Table> {
    let ranks = &blocks.friedman.mean_ranks;
    let differ = |a: usize, b: usize| {
        let of = |pair: &&Pair| [pair.first, pair.second] == [a.min(b), a.max(b)];
        blocks.pairs.iter().find(of).is_some_and(|pair| pair.p_holm <= ALPHA)
    };
    let groups = cliques(ranks, differ);
    let cliques_of = |optimiser: usize| -> String {
        let of = groups.iter().enumerate().filter(|(_, group)| group.contains(&optimiser));
        of.map(|(i, _)| format!("{}", i + 1)).collect::<Vec<_>>().join(" ")
    };
    let mut order: Vec<usize> = (0..ranks.len()).collect();
    order.sort_by(|&a, &b| ranks[a].total_cmp(&ranks[b]));
    let frame = df!(
        "optimiser" => order.iter().map(|&o| field.optimiser(o)).collect::<Vec<_>>(),
        "mean rank" => order.iter().map(|&o| ranks[o]).collect::<Vec<_>>(),
        "cliques" => order.iter().map(|&o| cliques_of(o)).collect::<Vec<_>>(),
    )?;
    let caption = format!(
        "Mean ranks of the final certified costs, 1 being the best. Within a clique no two optimisers differ \
         significantly, which does not mean that they are alike: Wilcoxon's test with Holm's correction at level {ALPHA}. \
         An optimiser without a clique differs from all. {}",
        blocks.told()
    );
    Ok(Table::new("ranks", caption, frame))
}

/// The costs that the tests compare, one line a block.
pub(super) fn blocks_table(field: &Field<'_>, blocks: &Blocks<'_>) -> PolarsResult<Table> {
    let mut frame = df!("block" => &blocks.names)?;
    for i in 0..field.plan.optimisers.len() {
        let costs: Vec<f64> = blocks.costs.iter().map(|row| row[i]).collect();
        frame.with_column(Column::new(field.optimiser(i).into(), costs))?;
    }
    let caption = format!("The costs that the tests compare. {}", blocks.told());
    Ok(Table::new("blocks", caption, frame))
}
