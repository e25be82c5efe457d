//! Groups of treatments that cannot be told apart.

use super::ranks::ascending;

/// The maximal groups of two treatments or more of which no two differ significantly, as indices, in order
/// of mean rank, both inside a group and among groups: the bars of a critical-difference diagram.
///
/// `differ(i, j)`, the same for `(j, i)`, says whether two treatments do: by an adjusted p-value at most
/// the level, or by mean ranks further apart than the critical difference. With the latter, a group is all
/// that lies between its first and last treatment; with the former, one between them may not belong to it.
///
/// Demšar (2006), Journal of Machine Learning Research 7:1–30; found as Bron and Kerbosch
/// (1973) do, doi 10.1145/362342.362367, with a pivot.
pub fn cliques(mean_ranks: &[f64], differ: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let order = ascending(mean_ranks);
    let alike = |a: usize, b: usize| a != b && !differ(order[a], order[b]);
    let mut found = Vec::new();
    extend(&[], (0..order.len()).collect(), Vec::new(), &alike, &mut found);
    found.retain(|group| group.len() > 1);
    found.sort();
    for place in found.iter_mut().flatten() {
        *place = order[*place];
    }
    found
}

/// Adds to what is found every maximal group that holds `group`, any of the candidates, and none of the
/// excluded. All candidates and all excluded are like everyone in `group`.
fn extend(
    group: &[usize],
    mut candidates: Vec<usize>,
    mut excluded: Vec<usize>,
    alike: &impl Fn(usize, usize) -> bool,
    found: &mut Vec<Vec<usize>>,
) {
    let like = |one: usize, of: &[usize]| -> Vec<usize> {
        of.iter().copied().filter(|&other| alike(one, other)).collect()
    };
    // A maximal group holds the pivot or one that is not like it.
    let pivot = candidates.iter().chain(&excluded).max_by_key(|&&one| like(one, &candidates).len());
    let Some(&pivot) = pivot else {
        let mut group = group.to_vec();
        group.sort_unstable();
        found.push(group);
        return;
    };
    let branches: Vec<usize> = candidates.iter().copied().filter(|&c| !alike(pivot, c)).collect();
    for one in branches {
        let larger = [group, &[one]].concat();
        extend(&larger, like(one, &candidates), like(one, &excluded), alike, found);
        candidates.retain(|&candidate| candidate != one);
        excluded.push(one);
    }
}
