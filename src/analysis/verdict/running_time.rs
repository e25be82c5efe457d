//! How many evaluations the winner needs, and how many the others.

use crate::analysis::blocks::Blocks;
use crate::analysis::grouped::{Analysis, trial};
use crate::analysis::statistics::{Trial, expected_running_time};
use crate::exhibit::words::{factor, list, some_of};
use crate::experiment::Run;
use crate::words::plural;

/// Most optimisers whose factor is told.
const MOST_TOLD: usize = 4;

/// Expected running times \[evaluations\] to one target, by optimiser and instance of the blocks.
type Times = Vec<Vec<f64>>;

/// Expected running times to the hardest target that the winner reached: the one that it reached on the fewest
/// instances, among such the lowest. None without targets that all instances of the blocks have.
pub(super) fn told(analysis: &Analysis<'_>, blocks: &Blocks, winner: usize) -> Option<String> {
    let (instances, values) = (&blocks.instances, &analysis.targets.values);
    let count = instances.iter().map(|&i| values[i].len()).min()?;
    let name = analysis.optimiser(winner);
    let all = (0..count).map(|k| (k, times(analysis, instances, k)));
    let reached = |times: &Times| times[winner].iter().filter(|time| time.is_finite()).count();
    let value = |k: usize| values[instances[0]][k];
    let hardest = all
        .filter(|(_, times)| reached(times) > 0)
        .min_by(|a, b| reached(&a.1).cmp(&reached(&b.1)).then(value(a.0).total_cmp(&value(b.0))));
    let Some((k, times)) = hardest else {
        let which =
            if have_same_count(analysis, instances) { "" } else { " that every instance has" };
        return (count > 0).then(|| format!("No run of {name} reached a target{which}."));
    };
    let target = analysis.targets.label(k, analysis.plan.cost_symbol(), instances.iter().copied());
    let (told, compared) = match instances.as_slice() {
        [only] => one(analysis, &target, *only, winner, &times),
        _ => many(analysis, blocks, &target, winner, &times),
    };
    Some(told + &derivatives(analysis, compared.into_iter().chain([winner])))
}

/// On the only instance; and who is compared with the winner.
fn one(
    analysis: &Analysis<'_>,
    target: &str,
    instance: usize,
    winner: usize,
    times: &Times,
) -> (String, Vec<usize>) {
    let (name, own) = (analysis.optimiser(winner), times[winner][0]);
    let others = (0..times.len()).filter(|&o| o != winner).map(|o| (o, times[o][0] / own));
    let (reached, never): (Vec<_>, Vec<_>) = others.partition(|(_, times)| times.is_finite());
    let mut told = format!(
        "To {target}, the hardest target that it reached, {name} has an expected running time of {own:.0} evaluations"
    );
    if !reached.is_empty() {
        told = told + "; " + &factors(analysis, &reached);
    }
    if !never.is_empty() {
        let never: Vec<usize> = never.iter().map(|(o, _)| *o).collect();
        told = told + "; " + &failures(analysis, instance, &never, times.len() - 1);
    }
    (told + ".", reached.iter().map(|(o, _)| *o).collect())
}

/// On how many instances each reached it, and times over the instances where the winner and the other did; and who
/// is compared.
fn many(
    analysis: &Analysis<'_>,
    blocks: &Blocks,
    target: &str,
    winner: usize,
    times: &Times,
) -> (String, Vec<usize>) {
    let name = analysis.optimiser(winner);
    let each = if target.starts_with("target") { " of each instance" } else { "" };
    let count = |o: usize| times[o].iter().filter(|time| time.is_finite()).count();
    let others: Vec<usize> = (0..times.len()).filter(|&o| o != winner).collect();
    let all = times[winner].len();
    let mut by = vec![format!("on {} of {} by {name}", count(winner), plural(all, "instance"))];
    if others.len() <= MOST_TOLD {
        by.extend(others.iter().map(|&o| format!("on {} by {}", count(o), analysis.optimiser(o))));
    } else {
        let most = others.iter().map(|&o| count(o)).max().unwrap_or(0);
        by.push(format!("on {most} at most by the {} others", others.len()));
    }
    let by = list(&by);
    let which = if have_same_count(analysis, &blocks.instances) {
        "The hardest target"
    } else {
        "Of the targets that every instance has, the hardest"
    };
    let mut told = format!("{which} that {name} reached, {target}{each}, was reached {by}.");
    let factor = |o: usize| {
        let both = times[winner].iter().zip(&times[o]).filter(|(a, b)| a.max(**b).is_finite());
        let (own, its) = both.fold((0.0, 0.0), |sums, (a, b)| (sums.0 + a, sums.1 + b));
        (own > 0.0).then_some((o, its / own))
    };
    let compared: Vec<(usize, f64)> = others.iter().filter_map(|&o| factor(o)).collect();
    if !compared.is_empty() {
        told = format!(
            "{told} In expected running time, summed over the instances where both reached it, {} evaluations as {name}.",
            factors(analysis, &compared)
        );
    }
    (told, compared.iter().map(|(o, _)| *o).collect())
}

/// Whether some instances have as many targets each.
fn have_same_count(analysis: &Analysis<'_>, instances: &[usize]) -> bool {
    let count = |i: usize| analysis.targets.values[i].len();
    instances.windows(2).all(|pair| count(pair[0]) == count(pair[1]))
}

/// Who never reached it, and in how many runs.
fn failures(analysis: &Analysis<'_>, instance: usize, never: &[usize], others: usize) -> String {
    let names: Vec<&str> = never.iter().map(|&o| analysis.optimiser(o)).collect();
    let own = |run: &&Run, o: usize| run.optimiser == o && run.instance == instance;
    let count = |o: usize| analysis.runs.iter().filter(|run| own(run, o)).count();
    let counts: Vec<usize> = never.iter().map(|&o| count(o)).collect();
    let runs = match counts.as_slice() {
        [only] => format!("in {}", plural(*only, "run")),
        [first, rest @ ..] if rest.iter().all(|count| count == first) => {
            format!("in {} each", plural(*first, "run"))
        }
        _ => "in any run".to_owned(),
    };
    match names.len() {
        1 => format!("{} does not reach it {runs}", names[0]),
        2 if others == 2 => format!("neither of the others reaches it {runs}"),
        n if n == others => format!("none of the {n} others reaches it {runs}"),
        _ => format!("{} do not reach it {runs}", some_of(&names, others)),
    }
}

/// Each optimiser's expected running time to the k-th target of each instance; infinite where no run reached it.
fn times(analysis: &Analysis<'_>, instances: &[usize], k: usize) -> Times {
    let place = |run: &Run| instances.iter().position(|&i| i == run.instance);
    let mut trials: Vec<Vec<Vec<Trial>>> =
        vec![vec![Vec::new(); instances.len()]; analysis.plan.optimisers.len()];
    for run in analysis.runs {
        if let Some(place) = place(run) {
            let target = analysis.targets.values[run.instance][k];
            trials[run.optimiser][place].push(trial(run, target));
        }
    }
    let time = |trials: &Vec<Trial>| expected_running_time(trials);
    trials.iter().map(|own| own.iter().map(time).collect()).collect()
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
    let uses = |&o: &usize| analysis.plan.optimisers[o].needs_derivatives;
    let names: Vec<&str> =
        all.iter().copied().filter(uses).map(|o| analysis.optimiser(o)).collect();
    match names.len() {
        n if n == 0 || n == analysis.plan.optimisers.len() => String::new(),
        _ => format!(" Evaluations of {} come with derivatives.", list(&names)),
    }
}
