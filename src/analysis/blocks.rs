//! What the tests of the final costs stand on, and what they say.

use super::pairs::{Pair, pairs};
use super::statistics::{Friedman, friedman, median};
use super::ties::settled;
use crate::experiment::{Plan, Run};
use crate::words::plural;

/// Level of the tests.
pub const ALPHA: f64 = 0.05;

/// What a block is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    /// An instance, with the median over its seeds.
    Instances,
    /// A seed of the only instance.
    Seeds,
}

impl Unit {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Instances => "instances",
            Self::Seeds => "seeds",
        }
    }
}

/// What the tests stand on: final costs of all optimisers, block by block.
#[derive(Debug)]
pub(super) struct Blocks {
    /// One row per block, one cost per optimiser.
    pub(super) costs: Vec<Vec<f64>>,
    /// What to call each block.
    pub(super) names: Vec<String>,
    /// What a block is.
    pub(super) unit: Unit,
    /// The instances that they come from.
    pub(super) instances: Vec<usize>,
    /// What Friedman's test says.
    pub(super) friedman: Friedman,
    /// All pairs of optimisers.
    pub(super) pairs: Vec<Pair>,
    /// Whether some optimisers may spend more than others.
    is_uneven: bool,
}

/// Seed and cost of every run, by instance and optimiser.
type Cells = Vec<Vec<Vec<(u64, f64)>>>;

impl Blocks {
    /// Instances are the blocks, with the median over their seeds; of those that differ in budget alone,
    /// the one with the largest. Where the experiment has but one, its seeds are the blocks. None where
    /// there are fewer than two blocks or optimisers.
    pub(super) fn of(plan: &Plan, runs: &[Run]) -> Option<Self> {
        let mut cells: Cells = vec![vec![Vec::new(); plan.optimisers.len()]; plan.instances.len()];
        for (run, cost) in runs.iter().zip(settled(plan, runs)) {
            cells[run.instance][run.optimiser].push((run.seed, cost));
        }
        let problems = largest_budgets(plan);
        let is_whole = |&i: &usize| cells[i].iter().all(|cell| !cell.is_empty());
        let whole: Vec<usize> = problems.iter().copied().filter(is_whole).collect();
        let (unit, costs, names) = if let (&[_], &[only]) = (&problems[..], &whole[..]) {
            let (seeds, costs) = by_seed(&cells[only]);
            (Unit::Seeds, costs, seeds.iter().map(|seed| format!("seed {seed}")).collect())
        } else {
            let costs = |cell: &Vec<(u64, f64)>| cell.iter().map(|run| run.1).collect();
            let row = |&i: &usize| cells[i].iter().map(|cell| median(costs(cell))).collect();
            let name = |&i: &usize| plan.instances[i].label.clone();
            (Unit::Instances, whole.iter().map(row).collect(), whole.iter().map(name).collect())
        };
        let pairs = pairs(&costs, &whole.iter().map(|&i| &cells[i][..]).collect::<Vec<_>>());
        let is_uneven = plan.is_uneven();
        let friedman = friedman(&costs)?;
        Some(Self { friedman, costs, names, unit, instances: whole, pairs, is_uneven })
    }

    /// What the tests stand on, in words.
    pub(super) fn told(&self) -> String {
        let n = self.costs.len();
        let mut told = match self.unit {
            Unit::Seeds => format!(
                "Blocks are the seeds of the only instance, {n} in number, so it says nothing about other instances."
            ),
            Unit::Instances => format!(
                "Blocks are {}, those with the largest budget, each with the median cost over its seeds.",
                plural(n, "instance")
            ),
        };
        told += " Costs that differ by less than searches leave open are taken for the same.";
        if self.least_p() * self.pairs.len() as f64 > ALPHA {
            told += " With so few blocks no pair can differ significantly.";
        }
        if self.is_uneven {
            told += " Budgets differ within the field, so final costs do not compare.";
        }
        told
    }

    /// The least p-value that the signed ranks of so many blocks can give, before Holm's correction.
    pub(super) fn least_p(&self) -> f64 {
        2_f64.powi(1 - self.costs.len() as i32)
    }

    /// The optimisers, by mean rank, the best first.
    pub(super) fn order(&self) -> Vec<usize> {
        let ranks = &self.friedman.mean_ranks;
        let mut order: Vec<usize> = (0..ranks.len()).collect();
        order.sort_by(|&a, &b| ranks[a].total_cmp(&ranks[b]));
        order
    }

    /// Whether two optimisers differ significantly.
    pub(super) fn differ(&self, a: usize, b: usize) -> bool {
        self.pair(a, b).is_some_and(|pair| pair.p_holm <= ALPHA)
    }

    /// A12 of one optimiser against another: how likely a run of it ends lower.
    pub(super) fn effect(&self, a: usize, b: usize) -> f64 {
        let effect = self.pair(a, b).map_or(f64::NAN, |pair| pair.effect);
        if a < b { effect } else { 1.0 - effect }
    }

    fn pair(&self, a: usize, b: usize) -> Option<&Pair> {
        self.pairs.iter().find(|pair| [pair.first, pair.second] == [a.min(b), a.max(b)])
    }
}

/// The instances, of those that differ in budget alone the one with the largest.
fn largest_budgets(plan: &Plan) -> Vec<usize> {
    let (instances, problems) = (&plan.instances, plan.problems());
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
