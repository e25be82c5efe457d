//! Who won, by how much, and whether that is chance.

use super::running_time;
use crate::analysis::blocks::{ALPHA, Blocks, Unit};
use crate::analysis::grouped::Analysis;
use crate::analysis::statistics::median;
use crate::exhibit::Finding;
use crate::exhibit::words::{any_of, list, number, p_value, some_of};
use crate::experiment::Instance;
use crate::words::plural;

/// How a sentence on pairs begins.
const WILCOXON: &str = "By Wilcoxon's test with Holm's correction at the 5 % level";

/// Some of the level winners, the others that they differ from, and those that they do not.
type Side = (Vec<usize>, Vec<usize>, Vec<usize>);

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
        format!("{} {}", self.blocks.costs.len(), self.blocks.unit.name())
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
            "{names} {is} the lowest mean rank, {rank} among {} over {over}.",
            plural(count, "optimiser")
        );
        format!("{told} {}", self.who_else(first, others))
    }

    /// Who differs from the first, and who does not.
    fn who_else(&self, first: &[usize], others: &[usize]) -> String {
        if self.is_hopeless() {
            let over = self.blocks_told();
            return format!("Pair by pair, {over} cannot show that this is more than chance.");
        }
        let sides = self.sides(first, others);
        let told = sides.iter().map(|(winners, _, alike)| {
            let names = match (sides.len(), winners.len()) {
                (1, 1) => "It".to_owned(),
                (1, _) => "They".to_owned(),
                _ => list(&self.names(winners.iter().copied())),
            };
            let (s, do_not) = if winners.len() == 1 { ("s", "does not") } else { ("", "do not") };
            if alike.is_empty() {
                let rest = if first.len() == 1 { "every other" } else { "the rest" };
                return format!("{names} differ{s} significantly from {rest}");
            }
            let alike = any_of(&self.names(alike.iter().copied()), others.len());
            format!("{names} {do_not} differ significantly from {alike} at the 5 % level")
        });
        format!("{}.", told.collect::<Vec<_>>().join("; "))
    }

    /// The first, those together that the tests tell from the same others; with these, and with those they are not
    /// told from.
    fn sides(&self, first: &[usize], others: &[usize]) -> Vec<Side> {
        let mut sides: Vec<Side> = Vec::new();
        for &winner in first {
            let (differ, alike): (Vec<usize>, Vec<usize>) =
                others.iter().partition(|&&other| self.blocks.differ(winner, other));
            match sides.iter_mut().find(|side| side.1 == differ) {
                Some(side) => side.0.push(winner),
                None => sides.push((vec![winner], differ, alike)),
            }
        }
        sides
    }

    fn by_how_much(&self) -> String {
        let winner = self.order[0];
        let mut told = if self.level < self.order.len() {
            self.costs(winner)
        } else {
            "Not at all in final costs.".to_owned()
        };
        if let Some(times) = running_time::told(self.analysis, self.blocks, winner) {
            told = told + " " + &times;
        }
        told
    }

    /// Those that share the mean rank of the one at a place of the order.
    fn level_with(&self, place: usize) -> Vec<usize> {
        let ranks = &self.blocks.friedman.mean_ranks;
        let rank = ranks[self.order[place]];
        self.order.iter().copied().filter(|&o| ranks[o] == rank).collect()
    }

    /// Some optimisers in words, and what each has. `places` is what one is called, and what is said behind several.
    fn of(&self, places: [&str; 2], level: &[usize], value: &dyn Fn(usize) -> String) -> String {
        let mut values: Vec<String> = level.iter().map(|&o| value(o)).collect();
        values.dedup();
        match &self.names(level.iter().copied())[..] {
            [name] => format!("that of the {}, {name}, {}", places[0], values[0]),
            [a, b] => format!("{} for {a} and {b}, {}", list(&values), places[1]),
            names => {
                let names = some_of(names, self.order.len() - 1);
                format!("{} for {names}, {}", list(&values), places[1])
            }
        }
    }

    /// The winner's costs against those of who comes next and who is last.
    fn costs(&self, winner: usize) -> String {
        let (second, last) = (self.level_with(self.level), self.level_with(self.order.len() - 1));
        let against = |value: &dyn Fn(usize) -> String| {
            if self.order.len() == 2 {
                self.of(["other", ""], &second, value)
            } else if second == last {
                self.of(["last", "which tie"], &last, value)
            } else {
                let comma = if second.len() == 1 { "" } else { "," };
                let second = self.of(["runner-up", "tied as runners-up"], &second, value);
                format!("{second}{comma} and {}", self.of(["last", "tied for last"], &last, value))
            }
        };
        let symbol = self.analysis.plan.cost_symbol();
        let named = self.name(winner);
        let mut told = vec![if self.blocks.unit == Unit::Seeds {
            // As the tables have it: ties are for ranks.
            let cost = |o| number(self.median_cost(o));
            let own = cost(winner);
            format!("The median cost of {named} is {symbol} {own}, {}.", against(&cost))
        } else {
            let rank = |o| self.rank(o);
            format!("The mean rank of {named} is {}, {}.", rank(winner), against(&rank))
        }];
        told.extend(self.wins(winner));
        let mut effects: Vec<String> =
            second.iter().map(|&o| format!("{:.2}", self.blocks.effect(winner, o))).collect();
        effects.dedup();
        told.push(format!(
            "A run of {named} ends lower than one of {} with probability {} (A12, ties count half).",
            some_of(&self.names(second), self.order.len() - 1),
            list(&effects)
        ));
        told.join(" ")
    }

    /// The median cost of an optimiser over its runs on the only instance of the blocks.
    fn median_cost(&self, optimiser: usize) -> f64 {
        let own = self.analysis.runs.iter().filter(|run| {
            run.optimiser == optimiser && self.blocks.instances.first() == Some(&run.instance)
        });
        median(own.map(|run| run.cost).collect())
    }

    /// On how many instances nobody's median is lower; none where the blocks are seeds.
    fn wins(&self, winner: usize) -> Option<String> {
        let is_lowest = |row: &&Vec<f64>| {
            row[winner].is_finite() && row.iter().all(|&cost| row[winner] <= cost)
        };
        let won = self.blocks.costs.iter().filter(is_lowest).count();
        let (name, all) = (self.name(winner), plural(self.blocks.costs.len(), "instance"));
        let told =
            format!("The median of {name} is the lowest, alone or with others, on {won} of {all}.");
        (self.blocks.unit == Unit::Instances).then_some(told)
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
        told.extend(self.dependence().map(str::to_owned));
        told.join(" ")
    }

    fn blocks_mean(&self) -> String {
        match self.blocks.unit {
            Unit::Seeds => {
                "Blocks are the seeds of one instance, which says nothing about others.".to_owned()
            }
            Unit::Instances => {
                format!("Blocks are {}, each with the median over its seeds.", self.blocks_told())
            }
        }
    }

    /// What makes blocks alike, in the words of the subjects.
    fn dependence(&self) -> Option<&'static str> {
        let plan = self.analysis.plan;
        let mut own = plan.by_kind();
        let mut own = own.iter_mut().map(|(_, instances)| {
            let is_block = |instance: &&Instance| {
                let blocks = self.blocks.instances.iter();
                blocks.clone().any(|&i| plan.instances[i].label == instance.label)
            };
            instances.retain(is_block);
            &*instances
        });
        own.find_map(|i| i.first()?.subject.dependence(i))
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
        let (first, others) = self.order.split_at(self.level);
        let (first, others) = match (first, others) {
            ([_], _) | (_, [_, ..]) => (first, others),
            _ => return self.level_pairs_told(),
        };
        let told = self.sides(first, others).into_iter().map(|(winners, differ, alike)| {
            let (s, does) = if winners.len() == 1 { ("s", "does") } else { ("", "do") };
            let verb = match (differ.is_empty(), alike.is_empty()) {
                (false, true) => {
                    format!("differ{s} from {}", some_of(&self.names(differ), others.len()))
                }
                (true, _) => format!(
                    "{does} not differ significantly from {}",
                    any_of(&self.names(alike), others.len())
                ),
                (false, false) => format!(
                    "differ{s} from {} and not significantly from {}",
                    some_of(&self.names(differ), others.len()),
                    any_of(&self.names(alike), others.len())
                ),
            };
            format!("{} {verb}", list(&self.names(winners)))
        });
        format!("{WILCOXON} {}.", told.collect::<Vec<_>>().join("; "))
    }

    /// Where all are level.
    fn level_pairs_told(&self) -> String {
        let pairs = &self.blocks.pairs;
        let differ = pairs.iter().filter(|p| self.blocks.differ(p.first, p.second)).count();
        match differ {
            0 => format!("{WILCOXON} no pair differs significantly."),
            n => format!("{WILCOXON} {n} of {} differ.", plural(pairs.len(), "pair")),
        }
    }
}
