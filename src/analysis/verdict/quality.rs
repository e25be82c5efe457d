//! How many instances are solved whose least value is known.

use crate::analysis::grouped::Analysis;
use crate::exhibit::Finding;
use crate::exhibit::words::list;
use crate::words::plural;

/// Costs that exceed the least value by no more are as good.
const SAME: f64 = 1e-8;

/// Who solves how many of the instances whose least value is known to the problem itself.
pub(super) fn finding(analysis: &Analysis<'_>) -> Option<Finding> {
    solved(analysis).map(|answer| Finding::new("How good is it?", answer))
}

fn solved(analysis: &Analysis<'_>) -> Option<String> {
    let instances = &analysis.plan.instances;
    let least: Vec<Option<f64>> = instances.iter().map(|i| i.subject.least_cost()).collect();
    let is_known = |i: &usize| least[*i].is_some();
    let known: Vec<usize> = (0..instances.len()).filter(is_known).collect();
    if known.is_empty() {
        return None;
    }
    let count = analysis.plan.optimisers.len();
    let (mut solved, mut tried) =
        (vec![vec![false; instances.len()]; count], vec![vec![false; instances.len()]; count]);
    for run in analysis.runs {
        tried[run.optimiser][run.instance] = true;
        solved[run.optimiser][run.instance] |=
            least[run.instance].is_some_and(|least| run.cost - least <= SAME);
    }
    let of = |flags: &[bool]| known.iter().filter(|&&i| flags[i]).count();
    let mut by_count: Vec<usize> = (0..count).collect();
    by_count.sort_by_key(|&o| std::cmp::Reverse(of(&solved[o])));
    if of(&solved[*by_count.first()?]) == 0 {
        return Some("No run solved an instance to 10⁻⁸.".to_owned());
    }
    let told = |&o: &usize| {
        let (name, solved, tried) = (analysis.optimiser(o), of(&solved[o]), of(&tried[o]));
        if tried < known.len() {
            format!("{name} {solved} of the {tried} that it has tried")
        } else {
            format!("{name} {solved}")
        }
    };
    let told: Vec<String> = by_count.iter().map(told).collect();
    // Of what some have not tried nobody knows.
    let (whole, open): (Vec<usize>, Vec<usize>) =
        known.iter().partition(|&&i| tried.iter().all(|flags| flags[i]));
    let unsolved = whole.iter().filter(|&&i| !solved.iter().any(|flags| flags[i])).count();
    let unsolved = match unsolved {
        0 => String::new(),
        n => format!(" Nobody solved {n} of them."),
    };
    let open = match open.len() {
        0 => String::new(),
        n => format!(" Not all optimisers have tried {} yet.", plural(n, "instance")),
    };
    let known = plural(known.len(), "instance");
    Some(format!("Of {known}, solved to 10⁻⁸ in any run: {}.{unsolved}{open}", list(&told)))
}
