//! How many evaluations the winner needs, and how many the others.

use super::words::{factor, list, plural, some_of};
use crate::analysis::statistics::{Trial, expected_running_time};
use crate::analysis::{Analysis, Run};

/// Most optimisers whose factor is told.
const MOST_TOLD: usize = 4;

/// Expected running times to the hardest target that the winner reached; none without targets.
pub(super) fn told(analysis: &Analysis<'_>, winner: usize) -> Option<String> {
    if analysis.targets.count() == 0 {
        return None;
    }
    let name = analysis.optimiser(winner);
    let reached = (0..analysis.targets.count()).map(|k| (k, time(analysis, winner, k)));
    let hardest = reached.filter(|(_, time)| time.is_finite()).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((k, own)) = hardest else {
        return Some(format!("No run of {name} reached a target."));
    };
    let others: Vec<(usize, f64)> = (0..analysis.plan.optimisers.len())
        .filter(|&o| o != winner)
        .map(|o| (o, time(analysis, o, k) / own))
        .collect();
    let (reached, never): (Vec<_>, Vec<_>) =
        others.iter().partition(|(_, times)| times.is_finite());
    let target = analysis.target_label(k);
    let target = if target.starts_with("target") { target + " of each instance" } else { target };
    let mut told = format!(
        "To {target}, the hardest target that it reached, {name} has an expected running time of {own:.0} evaluations"
    );
    if !reached.is_empty() {
        told = told + "; " + &factors(analysis, &reached);
    }
    if !never.is_empty() {
        told = told + "; " + &failures(analysis, &never, others.len());
    }
    Some(told + "." + &derivatives(analysis, reached.iter().map(|(o, _)| *o).chain([winner])))
}

/// Who never reached it, and in how many runs.
fn failures(analysis: &Analysis<'_>, never: &[(usize, f64)], others: usize) -> String {
    let names: Vec<&str> = never.iter().map(|(o, _)| analysis.optimiser(*o)).collect();
    let count = |o: usize| analysis.runs.iter().filter(|run| run.optimiser == o).count();
    let counts: Vec<usize> = never.iter().map(|(o, _)| count(*o)).collect();
    let runs = match counts.as_slice() {
        [only] => format!("in {}", plural(*only, "run")),
        [first, rest @ ..] if rest.iter().all(|count| count == first) => {
            format!("in {} each", plural(*first, "run"))
        }
        _ => "in any run".to_owned(),
    };
    match names.len() {
        1 => format!("{} does not reach it {runs}", names[0]),
        n if n == others => format!("none of the {n} others reaches it {runs}"),
        _ => format!("{} do not reach it {runs}", some_of(&names, others)),
    }
}

/// Over all runs, each asked for the k-th target of its instance.
fn time(analysis: &Analysis<'_>, optimiser: usize, k: usize) -> f64 {
    let own = analysis.runs.iter().filter(|run| run.optimiser == optimiser);
    let trial = |run: &Run| Some(run.trial(*analysis.targets.values[run.instance].get(k)?));
    expected_running_time(&own.filter_map(trial).collect::<Vec<Trial>>())
}

fn factors(analysis: &Analysis<'_>, reached: &[(usize, f64)]) -> String {
    if reached.len() <= MOST_TOLD {
        let told = reached.iter().map(|(o, times)| {
            format!("{} needs {} times as many", analysis.optimiser(*o), factor(*times))
        });
        return list(&told.collect::<Vec<_>>());
    }
    let least = reached.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    let most = reached.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let told = [least, most].into_iter().flatten();
    let told = told.map(|(o, times)| format!("{} ({})", factor(*times), analysis.optimiser(*o)));
    format!("{} others need {} times as many", reached.len(), told.collect::<Vec<_>>().join(" to "))
}

/// Whose evaluations say more than those of others.
fn derivatives(analysis: &Analysis<'_>, optimisers: impl Iterator<Item = usize>) -> String {
    let all: Vec<usize> = optimisers.collect();
    let uses = |&o: &usize| analysis.plan.optimisers[o].settings.optimiser().needs_derivatives();
    let names: Vec<&str> =
        all.iter().copied().filter(uses).map(|o| analysis.optimiser(o)).collect();
    match names.len() {
        n if n == 0 || n == analysis.plan.optimisers.len() => String::new(),
        _ => format!(" Evaluations of {} come with derivatives.", list(&names)),
    }
}
