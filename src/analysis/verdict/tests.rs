use crate::analysis::handmade::{answer, findings, plan, runs};
use crate::experiment::{Plan, RunSpec};

/// A field on test functions.
pub(super) fn functions(seeds: u64, names: &str, field: &[&str]) -> Plan {
    let field: Vec<String> = field.iter().map(|o| format!("[[optimiser]]\n{o} = {{}}\n")).collect();
    let field = field.concat();
    plan(&format!(
        "seeds = {seeds}\nbudget = {{ evaluations = 100 }}\n[functions]\n{names}\n{field}"
    ))
}

const SPHERE: &str = "name = ['sphere']";

#[test]
fn one_optimiser_has_nobody_to_compare_with() {
    let plan = functions(7, SPHERE, &["random"]);
    let told = findings(&plan, &runs(&plan, |_| vec![(1, 1.0)]));
    assert_eq!(
        answer(&told, "Who won?"),
        "There is one optimiser only, so there is nothing to compare."
    );
    assert_eq!(told.len(), 2, "{told:?}");
}

#[test]
fn unequal_budgets_do_not_compare() {
    let plan = plan(
        "seeds = 7\nbudget = { evaluations = 100 }\n[functions]\nname = ['sphere']\n\
         [[optimiser]]\nrandom = {}\n[[optimiser]]\nde = {}\nbudget = { evaluations = 200 }\n",
    );
    let told = findings(&plan, &runs(&plan, |_| vec![(1, 1.0)]));
    assert!(answer(&told, "Who won?").starts_with("Budgets differ"), "{told:?}");
    assert_eq!(answer(&told, "By how much?"), "");
}

#[test]
fn a_single_seed_is_no_comparison() {
    let plan = functions(1, SPHERE, &["random", "de"]);
    let told = findings(&plan, &runs(&plan, |_| vec![(1, 1.0)]));
    assert!(answer(&told, "Who won?").starts_with("Too few runs"), "{told:?}");
}

/// Ranks 1.5, 1.5 and 3 in each of seven blocks. Corrected for ties Friedman's statistic is n (k − 1) = 14, and with
/// two degrees of freedom p = exp(−7) = 0.000912. Wilcoxon's p of seven differences of one sign is 2 / 2⁷, and with
/// Holm's factor of 3 below 0.05.
#[test]
fn ties_are_level_and_the_rest_is_told_apart() {
    let plan = functions(7, SPHERE, &["random", "de", "pso"]);
    let runs = runs(&plan, |run| match run.optimiser {
        0 => vec![(10, 1.0)],
        1 => vec![(10, 1.0), (20, 1e-9)],
        _ => vec![(10, 1.0), (80, 2e-9)],
    });
    let told = findings(&plan, &runs);
    assert_eq!(
        answer(&told, "Who won?"),
        "de and pso are level: they share the lowest mean rank, 1.50 among 3 optimisers over 7 seeds. They differ \
         significantly from the rest."
    );
    // Their targets are 10⁻², 10⁻⁵ and 10⁻⁸.
    assert_eq!(
        answer(&told, "By how much?"),
        "The median cost of de is f 1.000e-9, that of the last, random, 1.000. A run of de ends lower than one of random \
         with probability 1.00 (A12, ties count half). To f ≤ 1e-8, the hardest target that it reached, de has an expected \
         running time of 20 evaluations; pso needs 4.0 times as many; random does not reach it in 7 runs."
    );
    assert_eq!(
        answer(&told, "Is it significant?"),
        "By Friedman's test over 7 seeds the optimisers differ (p = 0.000912). By Wilcoxon's test with Holm's correction \
         at the 5 % level de and pso differ from random. Blocks are the seeds of one instance, \
         which says nothing about others."
    );
    assert_eq!(
        answer(&told, "How good is it?"),
        "Of 1 instance, solved to 10⁻⁸ in any run: de 1, pso 1 and random 0."
    );
}

/// The least two-sided p of five signed ranks is 2 / 2⁵.
#[test]
fn few_seeds_cannot_be_significant() {
    let plan = functions(5, SPHERE, &["random", "de"]);
    let runs = runs(&plan, |run| vec![(1, 1.0 + run.optimiser as f64)]);
    let told = findings(&plan, &runs);
    assert_eq!(
        answer(&told, "Who won?"),
        "random has the lowest mean rank, 1.00 among 2 optimisers over 5 seeds. Pair by pair, 5 seeds cannot show that this \
         is more than chance."
    );
    let significant = answer(&told, "Is it significant?");
    let least =
        "With 5 seeds no pair can be told apart at the 5 % level: the least p of a pair is 0.0625.";
    assert!(significant.contains(least), "{significant}");
    let by = answer(&told, "By how much?");
    assert!(by.ends_with("No run of random reached a target."), "{by}");
    assert_eq!(answer(&told, "How good is it?"), "No run solved an instance to 10⁻⁸.");
}

#[test]
fn nobody_wins_where_all_are_level() {
    let plan = functions(7, SPHERE, &["random", "de"]);
    let told = findings(&plan, &runs(&plan, |_| vec![(1, 1.0)]));
    assert_eq!(answer(&told, "Who won?"), "Nobody: random and de are level over 7 seeds.");
    let by = answer(&told, "By how much?");
    assert!(by.starts_with("Not at all in final costs."), "{by}");
    assert!(answer(&told, "Is it significant?").contains("cannot be said to differ (p = 1.00)"));
}

/// The first optimiser is the best on all of eight instances but one, where it is second: mean ranks (7 + 2)/8,
/// (7 · 2 + 1)/8 and 3.
#[test]
fn many_instances_are_counted() {
    let names = "name = ['sphere', 'rastrigin']\ninstances = 4";
    let plan = functions(1, names, &["random", "de", "pso"]);
    let runs = runs(&plan, |run| match (run.optimiser, run.instance) {
        (0, 3) => vec![(5, 1.0)],
        (0, _) => vec![(5, 0.0)],
        (1, _) => vec![(5, 0.5)],
        (_, _) => vec![(5, 2.0)],
    });
    let told = findings(&plan, &runs);
    let by = answer(&told, "By how much?");
    assert!(
        by.starts_with(
            "The mean rank of random is 1.12, that of the runner-up, de, 1.88 and that of the last, pso, 3.00. The median \
             of random is the lowest, alone or with others, on 7 of 8 instances."
        ),
        "{by}"
    );
    assert_eq!(
        answer(&told, "How good is it?"),
        "Of 8 instances, solved to 10⁻⁸ in any run: random 7, de 0 and pso 0. Nobody solved 1 of them."
    );
}

#[test]
fn what_is_missing_comes_first() {
    let plan = functions(3, SPHERE, &["random", "de"]);
    let found = |run: &RunSpec| if run.seed == 1 { vec![] } else { vec![(1, 1.0)] };
    let told = findings(&plan, &runs(&plan, found)[..4]);
    assert_eq!(told[0].question, "Is anything missing?");
    assert_eq!(
        told[0].answer,
        "Only 4 of 6 runs are stored so far. 2 runs failed or found nothing; their costs count as infinite."
    );
    assert_eq!(findings(&plan, &[]).len(), 1);
}
