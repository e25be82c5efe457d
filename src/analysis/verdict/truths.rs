//! Tests that findings say nothing untrue where a simple summary would.

use super::tests::functions;
use crate::analysis::handmade::{answer, findings, plan, runs};
use crate::experiment::Run;

const TWO: &str = "name = ['sphere', 'rastrigin']";

/// Reached by the one on all four after 20 evaluations, by the other on one after 40.
#[test]
fn running_times_compare_where_both_reach_the_target() {
    let plan = functions(1, &format!("{TWO}\ninstances = 2"), &["de", "random"]);
    let runs = runs(&plan, |run| match (run.optimiser, run.instance) {
        (0, _) => vec![(20, 1e-9)],
        (_, 0) => vec![(40, 5e-9)],
        (_, _) => vec![(40, 1.0)],
    });
    let told = findings(&plan, &runs);
    let by = answer(&told, "By how much?");
    assert!(
        by.ends_with(
            "The hardest target that de reached, f ≤ 1e-8, was reached on 4 of 4 instances by de and on 1 by random. In \
             expected running time, summed over the instances where both reached it, random needs 2.0 times as many evaluations as de."
        ),
        "{by}"
    );
    assert!(!by.contains("median cost"), "{by}");
}

/// One of two instances has a second target, which does not count.
#[test]
fn running_times_keep_to_targets_of_all_instances() {
    let plan = plan(
        "seeds = 1\nbudget = { evaluations = 100 }\n[functions]\nname = ['sphere']\ndimension = [2]\n\
         instances = 2\n[targets]\n'sphere dimension=2 instance=1' = [1.0]\n\
         'sphere dimension=2 instance=2' = [2.0, 0.1]\n[[optimiser]]\nde = {}\n[[optimiser]]\nrandom = {}\n",
    );
    let told = findings(&plan, &runs(&plan, |run| vec![(20, 0.01 + run.optimiser as f64)]));
    let by = answer(&told, "By how much?");
    let part = "Of the targets that every instance has, the hardest that de reached, target 1 of each instance, was \
                reached on 2 of 2 instances by de and on 1 by random.";
    assert!(by.contains(part), "{by}");
}

#[test]
fn shifts_of_a_function_are_not_independent_but_functions_are() {
    let significance = |names: &str| {
        let plan = functions(1, names, &["de", "random"]);
        let told = findings(&plan, &runs(&plan, |run| vec![(1, 1.0 + run.optimiser as f64)]));
        answer(&told, "Is it significant?").to_owned()
    };
    let shifted = significance("name = ['sphere']\ninstances = 3");
    assert!(shifted.contains("Shifts and dimensions of one function"), "{shifted}");
    let different = significance(TWO);
    assert!(different.starts_with("By Friedman"), "{different}");
    assert!(!different.contains("independent"), "{different}");
}

#[test]
fn functions_are_no_sweep() {
    let plan = functions(2, TWO, &["random"]);
    let told = findings(&plan, &runs(&plan, |_| vec![(1, 1.0)]));
    assert_eq!(
        answer(&told, "Who won?"),
        "There is one optimiser only, so there is nothing to compare."
    );
    assert_eq!(answer(&told, "What does the sweep say?"), "");
}

/// Eight blocks. The first is below the third in all, by Wilcoxon's test with Holm's factor of 3 at 3 · 2 / 2⁸ = 0.023;
/// the second in six, the other two being the largest differences: signed ranks of 21 against 15. Ranks of the first and
/// the second sum to 13 each.
#[test]
fn each_of_the_level_ones_is_told_from_the_rest_by_itself() {
    let plan = functions(8, "name = ['sphere']", &["random", "de", "pso"]);
    let told = findings(
        &plan,
        &runs(&plan, |run| {
            let seed = run.seed as f64;
            let costs = match run.seed {
                1 | 2 => [1.0, 90.0 + seed, 2.0],
                3 => [1.0, 1.5, 2.0 + seed],
                _ => [1.5, 1.0, 2.0 + seed],
            };
            vec![(1, costs[run.optimiser])]
        }),
    );
    let who = answer(&told, "Who won?");
    assert!(
        who.starts_with("random and de are level: they share the lowest mean rank, 1.62"),
        "{who}"
    );
    let rest = "random differs significantly from the rest; de does not differ significantly from pso at the 5 % level.";
    assert!(who.ends_with(rest), "{who}");
    let significance = answer(&told, "Is it significant?");
    let pairs = "random differs from pso; de does not differ significantly from pso.";
    assert!(significance.contains(pairs), "{significance}");
}

/// Two optimisers share the middle rank and two the last: none of them is the runner-up or the last.
#[test]
fn equals_are_named_together() {
    let plan = functions(8, "name = ['sphere']", &["random", "de", "pso", "l-shade", "cma-es"]);
    let told = findings(
        &plan,
        &runs(&plan, |run| vec![(1, 9.0), (2, [1.0, 2.0, 2.0, 3.0, 3.0][run.optimiser])]),
    );
    let by = answer(&told, "By how much?");
    let costs = "The median cost of random is f 1.000, 2.000 for de and pso, tied as runners-up, and 3.000 for l-shade \
                 and cma-es, tied for last. A run of random ends lower than one of de and pso with probability 1.00 (A12, \
                 ties count half).";
    assert!(by.starts_with(costs), "{by}");
    let plan = functions(8, "name = ['sphere']", &["random", "de", "pso"]);
    let told =
        findings(&plan, &runs(&plan, |run| vec![(1, 9.0), (2, [1.0, 2.0, 2.0][run.optimiser])]));
    let by = answer(&told, "By how much?");
    let costs = "The median cost of random is f 1.000, 2.000 for de and pso, which tie. A run";
    assert!(by.starts_with(costs), "{by}");
}

/// Of four instances the second is solved, the third is not, and the fourth has been tried by one alone.
#[test]
fn what_is_not_tried_yet_is_not_unsolved() {
    let plan = functions(1, "name = ['sphere']\ninstances = 4", &["de", "random"]);
    let all = runs(&plan, |run| vec![(1, if run.instance < 2 { 1e-9 } else { 1.0 })]);
    let tried = |run: &Run| run.instance < 3 || (run.instance, run.optimiser) == (3, 0);
    let stored: Vec<Run> = all.into_iter().filter(tried).collect();
    let told = findings(&plan, &stored);
    assert_eq!(
        answer(&told, "How good is it?"),
        "Of 4 instances, solved to 10⁻⁸ in any run: de 2 and random 2 of the 3 that it has tried. Nobody solved 1 of \
         them. Not all optimisers have tried 1 instance yet."
    );
}
