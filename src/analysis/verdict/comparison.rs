//! Who won, by how much, and whether that is chance.

use super::words::{list, number, p_value, plural, some_of};
use super::{Finding, running_time};
use crate::analysis::blocks::{ALPHA, Blocks};
use crate::analysis::statistics::median;
use crate::analysis::{Analysis, Run};

/// The optimisers in their order.
struct Standings<'a> {
    analysis: &'a Analysis<'a>,
    blocks: &'a Blocks,
    /// By mean rank, the best first.
    order: Vec<usize>,
    /// How many share the lowest mean rank.
    level: usize,
}

/// What can be said of the optimisers.
pub(super) fn findings(analysis: &Analysis<'_>) -> Vec<Finding> {
    let nothing = |why: &str| vec![Finding::new("Who won?", why)];
    if analysis.plan.optimisers.len() < 2 {
        return nothing("There is one optimiser only, so there is nothing to compare.");
    }
    if analysis.plan.is_uneven() {
        return nothing(
            "Budgets differ within the field, so final costs do not compare. Evaluations to a target do.",
        );
    }
    let Some(blocks) = &analysis.blocks else {
        return nothing(
            "Too few runs to compare: it takes two seeds of the only instance, or two instances, that every optimiser \
             has tried.",
        );
    };
    let (order, ranks) = (blocks.order(), &blocks.friedman.mean_ranks);
    let level = order.iter().filter(|&&o| ranks[o] == ranks[order[0]]).count();
    let standings = Standings { analysis, blocks, order, level };
    vec![
        Finding::new("Who won?", standings.who()),
        Finding::new("By how much?", standings.by_how_much()),
        Finding::new("Is it significant?", standings.significance()),
    ]
}

impl<'a> Standings<'a> {
    fn name(&self, optimiser: usize) -> &'a str {
        self.analysis.optimiser(optimiser)
    }

    fn names(&self, optimisers: impl IntoIterator<Item = usize>) -> Vec<&'a str> {
        optimisers.into_iter().map(|o| self.name(o)).collect()
    }

    fn rank(&self, optimiser: usize) -> String {
        format!("{:.2}", self.blocks.friedman.mean_ranks[optimiser])
    }

    /// The number of blocks, and what they are.
    fn blocks_told(&self) -> String {
        format!("{} {}", self.blocks.costs.len(), self.blocks.unit)
    }

    /// Whether the blocks are too few for any pair to differ significantly.
    fn is_hopeless(&self) -> bool {
        self.blocks.least_p() * self.blocks.pairs.len() as f64 > ALPHA
    }

    fn who(&self) -> String {
        let (count, over) = (self.order.len(), self.blocks_told());
        let (first, others) = self.order.split_at(self.level);
        let rank = self.rank(first[0]);
        if others.is_empty() {
            return format!(
                "Nobody: {} are level over {over}.",
                list(&self.names(first.iter().copied()))
            );
        }
        let names = list(&self.names(first.iter().copied()));
        let is = if first.len() == 1 { "has" } else { "are level: they share" };
        let told = format!(
            "{names} {is} the lowest mean rank, {rank} among {count} optimisers over {over}."
        );
        format!("{told} {}", self.who_else(first, others))
    }

    /// Who cannot be told from the first.
    fn who_else(&self, first: &[usize], others: &[usize]) -> String {
        if self.is_hopeless() {
            let over = self.blocks_told();
            return format!("Pair by pair, {over} cannot show that this is more than chance.");
        }
        let is_alike = |&o: &usize| first.iter().any(|&f| !self.blocks.differ(f, o));
        let alike = self.names(others.iter().copied().filter(is_alike));
        match (first.len(), alike.len()) {
            (1, 0) => "It differs significantly from every other.".to_owned(),
            (_, 0) => "They differ significantly from every other.".to_owned(),
            (n, _) => format!(
                "{} cannot be told from {} at the 5 % level.",
                if n == 1 { "It" } else { "They" },
                some_of(&alike, others.len())
            ),
        }
    }

    fn by_how_much(&self) -> String {
        let winner = self.order[0];
        let mut told = match (self.order.get(self.level), self.order.last()) {
            (Some(&second), Some(&last)) => self.costs(winner, second, last),
            _ => "Not at all in final costs.".to_owned(),
        };
        if let Some(times) = running_time::told(self.analysis, winner) {
            told = told + " " + &times;
        }
        told
    }

    /// The winner's costs against the runner-up's and the last one's.
    fn costs(&self, winner: usize, second: usize, last: usize) -> String {
        let of = |place: &str, o: usize, value: &dyn Fn(usize) -> String| {
            format!("that of the {place}, {}, {}", self.name(o), value(o))
        };
        let against = |value: &dyn Fn(usize) -> String| {
            if self.order.len() == 2 {
                of("other", second, value)
            } else if second == last {
                of("last", last, value)
            } else {
                format!("{} and {}", of("runner-up", second, value), of("last", last, value))
            }
        };
        let symbol = self.analysis.plan.cost_symbol();
        let instances = &self.analysis.plan.instances;
        let named = self.name(winner);
        let mut told = vec![if instances.iter().all(|i| i.group == instances[0].group) {
            let cost = |o| number(self.median_cost(o));
            let own = cost(winner);
            format!("The median cost of {named} is {symbol} {own}, {}.", against(&cost))
        } else {
            let rank = |o| self.rank(o);
            format!("The mean rank of {named} is {}, {}.", rank(winner), against(&rank))
        }];
        if self.blocks.unit == "instances" {
            let lowest = |row: &&Vec<f64>| row.iter().all(|&cost| row[winner] <= cost);
            let won = self.blocks.costs.iter().filter(lowest).count();
            let all = plural(self.blocks.costs.len(), "instance");
            told.push(format!(
                "Its median is the lowest, alone or with others, on {won} of {all}."
            ));
        }
        told.push(format!(
            "A run of it ends lower than one of {} with probability {:.2} (A12, ties count half).",
            self.name(second),
            self.blocks.effect(winner, second)
        ));
        told.join(" ")
    }

    fn median_cost(&self, optimiser: usize) -> f64 {
        let own = |run: &&Run| run.optimiser == optimiser;
        median(self.analysis.runs.iter().filter(own).map(|run| run.cost).collect())
    }

    fn significance(&self) -> String {
        let (over, friedman) = (self.blocks_told(), &self.blocks.friedman);
        let says = if friedman.p <= ALPHA { "differ" } else { "cannot be said to differ" };
        let p = p_value(friedman.p);
        let mut told = vec![
            format!("By Friedman's test over {over} the optimisers {says} ({p})."),
            if self.is_hopeless() { self.hopeless() } else { self.pairs_told() },
            self.blocks_mean(),
        ];
        if self.blocks.unit == "instances" && self.varies_settings() {
            told.push(
                "Settings of one task are not independent tasks, so p-values are smaller than they should be."
                    .to_owned(),
            );
        }
        told.join(" ")
    }

    fn blocks_mean(&self) -> String {
        match (self.blocks.unit, self.analysis.plan.cost_symbol()) {
            ("seeds", "J") => {
                "Blocks are the seeds of one task, which says nothing about other tasks.".to_owned()
            }
            ("seeds", _) => {
                "Blocks are the seeds of one instance, which says nothing about others.".to_owned()
            }
            _ => format!("Blocks are {}, each with the median over its seeds.", self.blocks_told()),
        }
    }

    /// Whether tasks differ in more than their poses.
    fn varies_settings(&self) -> bool {
        let tasks = || self.analysis.plan.instances.iter().filter(|instance| instance.is_task());
        tasks().zip(tasks().skip(1)).any(|(a, b)| a.group != b.group)
    }

    fn hopeless(&self) -> String {
        let correction = match self.blocks.pairs.len() {
            1 => String::new(),
            pairs => format!(" before Holm's correction for {pairs} pairs"),
        };
        let over = self.blocks_told();
        let least = p_value(self.blocks.least_p().min(1.0)).replace("p = ", "");
        format!(
            "With {over} no pair can be told apart at the 5 % level: the least p of a pair is {least}{correction}."
        )
    }

    fn pairs_told(&self) -> String {
        let winner = self.order[0];
        let others = &self.order[1..];
        let (differ, alike): (Vec<usize>, Vec<usize>) =
            others.iter().partition(|&&other| self.blocks.differ(winner, other));
        let told = |optimisers: Vec<usize>| some_of(&self.names(optimisers), others.len());
        let verb = match (differ.is_empty(), alike.is_empty()) {
            (false, true) => format!("differs from {}", told(differ)),
            (true, _) => format!("does not differ significantly from {}", told(alike)),
            (false, false) => {
                format!("differs from {} and not significantly from {}", told(differ), told(alike))
            }
        };
        format!(
            "By Wilcoxon's test with Holm's correction at the 5 % level {} {verb}.",
            self.name(winner)
        )
    }
}
