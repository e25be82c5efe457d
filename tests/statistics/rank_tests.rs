//! Ranks, tests of them, and what follows from those.

use driftless::analysis::statistics::{
    average_ranks, cliques, critical_difference, friedman, holm, nemenyi, studentised_range_sf,
    vargha_delaney, wilcoxon,
};

use super::cases;

#[test]
fn ranks_are_those_of_scipy() {
    for case in cases("ranks") {
        assert_eq!(average_ranks(&case.reals("values")), case.reals("ranks"));
    }
}

/// SciPy's statistic and p-value; Iman and Davenport's F by Demšar's formula (2006, p. 11) from SciPy's
/// statistic, its p-value SciPy's.
#[test]
fn friedman_is_that_of_scipy() {
    for case in cases("friedman") {
        let found = friedman(&case.rows("blocks")).unwrap();
        case.assert_all_close(&found.mean_ranks, &case.reals("mean_ranks"));
        case.assert_close(found.chi_square, case.real("chi_square"));
        case.assert_close(found.p, case.real("p"));
        case.assert_close(found.f, case.real("f"));
        case.assert_close(found.f_p, case.real("f_p"));
    }
}

#[test]
fn friedman_needs_treatments_and_blocks() {
    let tied = friedman(&[vec![2.0; 3], vec![f64::INFINITY; 3]]).unwrap();
    assert_eq!((tied.chi_square, tied.p, tied.f, tied.f_p), (0.0, 1.0, 0.0, 1.0));
    assert_eq!(tied.mean_ranks, [2.0; 3]);
    for blocks in
        [&[][..], &[vec![1.0, 2.0]], &[vec![1.0], vec![2.0]], &[vec![1.0, 2.0], vec![1.0]]]
    {
        assert_eq!(friedman(blocks), None);
    }
}

#[test]
fn nemenyi_is_that_of_scikit_posthocs() {
    for case in cases("friedman") {
        let ranks = case.reals("mean_ranks");
        let (k, n) = (ranks.len(), case.rows("blocks").len());
        for (i, row) in case.rows("nemenyi").iter().enumerate() {
            let found: Vec<f64> = ranks.iter().map(|rank| nemenyi(rank - ranks[i], k, n)).collect();
            case.assert_all_close(&found, row);
        }
        case.assert_close(critical_difference(k, n, 0.05), case.real("critical_difference"));
    }
}

/// Table 5a of Demšar (2006), for 2 to 10 treatments; its digits are cut off, not rounded.
#[test]
fn critical_values_are_those_of_the_table() {
    let five = [1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164];
    let ten = [1.645, 2.052, 2.291, 2.459, 2.589, 2.693, 2.780, 2.855, 2.920];
    for (alpha, table) in [(0.05, five), (0.1, ten)] {
        for (expected, k) in table.into_iter().zip(2_usize..) {
            let found = critical_difference(k, k * (k + 1), alpha) * 6_f64.sqrt();
            assert!((found - expected).abs() < 1e-3, "{k} treatments: {found} is not {expected}");
        }
    }
}

#[test]
fn the_studentised_range_is_that_of_scipy() {
    for case in cases("studentised_range") {
        case.assert_close(
            studentised_range_sf(case.real("q"), case.count("count")),
            case.real("sf"),
        );
    }
}

#[test]
fn wilcoxon_is_that_of_scipy() {
    let mut exact = 0;
    for case in cases("wilcoxon") {
        let found = wilcoxon(&case.reals("first"), &case.reals("second"));
        case.assert_close(found.first_lower.min(found.second_lower), case.real("statistic"));
        case.assert_close(found.p, case.real("p"));
        assert_eq!(found.exact, case.get("exact").as_bool().unwrap());
        exact += usize::from(found.exact);
    }
    assert!((6..cases("wilcoxon").len() - 2).contains(&exact), "{exact} exact cases");
}

#[test]
fn wilcoxon_says_which_is_lower() {
    let found =
        wilcoxon(&[1.0, 2.0, 9.0, f64::INFINITY], &[2.0, 4.0, f64::INFINITY, f64::INFINITY]);
    assert_eq!((found.pairs, found.first_lower, found.second_lower), (3, 6.0, 0.0));
    assert_eq!(wilcoxon(&[], &[]).p, 1.0);
}

#[test]
fn holm_is_that_of_statsmodels() {
    for case in cases("holm") {
        case.assert_all_close(&holm(&case.reals("p_values")), &case.reals("adjusted"));
    }
}

/// Mann and Whitney's U of SciPy, for each pair.
#[test]
fn the_effect_size_is_that_of_scipy() {
    for case in cases("vargha_delaney") {
        let (first, second) = (case.reals("first"), case.reals("second"));
        case.assert_close(vargha_delaney(&first, &second), case.real("effect"));
        case.assert_close(vargha_delaney(&second, &first), 1.0 - case.real("effect"));
    }
    assert_eq!(vargha_delaney(&[1.0, 2.0], &[3.0, f64::INFINITY]), 1.0);
}

#[test]
fn cliques_are_those_of_scikit_posthocs() {
    for case in cases("cliques") {
        let differ: Vec<Vec<bool>> = serde_json::from_value(case.get("differ").clone()).unwrap();
        let groups: Vec<Vec<usize>> = serde_json::from_value(case.get("groups").clone()).unwrap();
        assert_eq!(cliques(&case.reals("mean_ranks"), |i, j| differ[i][j]), groups);
    }
}

/// Fifty treatments have 2⁵⁰ groups, of which only one is maximal.
#[test]
fn cliques_of_many_alike_are_found_at_once() {
    let ranks: Vec<f64> = (0..50).rev().map(f64::from).collect();
    let all: Vec<usize> = (0..50).rev().collect();
    assert_eq!(cliques(&ranks, |_, _| false), [all]);
    assert!(cliques(&ranks, |_, _| true).is_empty());
    let near = |i: usize, j: usize| (ranks[i] - ranks[j]).abs() > 46.5;
    let pairs = cliques(&ranks, near);
    assert_eq!(pairs.len(), 4);
    assert!(pairs.iter().all(|group| group.len() == 47));
}
