//! How many instances are solved whose least value is known.

use crate::analysis::grouped::Analysis;
use crate::exhibit::Finding;
use crate::exhibit::words::{list, plural};

/// Costs that exceed the least value by no more are as good.
const SAME: f64 = 1e-8;

/// Who solves how many of the instances whose least value is known to the problem itself.
pub(super) fn finding(analysis: &Analysis<'_>) -> Option<Finding> {
    solved(analysis).map(|answer| Finding::new("How good is it?", answer))
}

fn solved(analysis: &Analysis<'_>) -> Option<String> {
    let instances = &analysis.plan.instances;
    let least: Vec<Option<f64>> = instances.iter().map(|i| i.subject.least_cost()).collect();
    let known = least.iter().flatten().count();
    if known == 0 {
        return None;
    }
    let mut solved = vec![vec![false; instances.len()]; analysis.plan.optimisers.len()];
    for run in analysis.runs {
        solved[run.optimiser][run.instance] |=
            least[run.instance].is_some_and(|least| run.cost - least <= SAME);
    }
    let count = |solved: &Vec<bool>| solved.iter().filter(|&&solved| solved).count();
    let mut by_count: Vec<(usize, &str)> =
        solved.iter().enumerate().map(|(o, s)| (count(s), analysis.optimiser(o))).collect();
    by_count.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
    let unsolved = known - (0..instances.len()).filter(|&i| solved.iter().any(|s| s[i])).count();
    let (most, _) = by_count.first()?;
    if *most == 0 {
        return Some("No run solved an instance to 10⁻⁸.".to_owned());
    }
    let told: Vec<String> =
        by_count.iter().map(|(count, name)| format!("{name} {count}")).collect();
    let rest = match unsolved {
        0 => String::new(),
        n => format!(" Nobody solved {n} of them."),
    };
    let known = plural(known, "instance");
    Some(format!("Of {known}, solved to 10⁻⁸ in any run: {}.{rest}", list(&told)))
}
