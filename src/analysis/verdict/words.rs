//! Numbers and lists as one reads them.

use crate::analysis::format::significant;

/// Angles below are as good as none: searches end with some 10⁻⁶ \[°\].
pub(super) const NONE_DEG: f64 = 1e-3;

/// A cost or a time, to four digits.
pub(super) fn number(value: f64) -> String {
    significant(value, 4)
}

/// How many times as much.
pub(super) fn factor(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

/// A p-value with its sign of relation.
pub(super) fn p_value(p: f64) -> String {
    if p < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {}", significant(p, 3)) }
}

/// A share in whole percent, in tenths where that would hide on which side of 100 % it is.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.round() == 100.0 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// How far the base ends off the goal.
pub(super) fn off_the_goal(residual_deg: f64) -> String {
    if residual_deg < NONE_DEG {
        "within 0.001° of the goal".to_owned()
    } else {
        format!("{}° off the goal", significant(residual_deg, 2))
    }
}

/// A number of things.
pub(super) fn plural(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Names as a sentence has them.
pub(super) fn list<T: AsRef<str>>(names: &[T]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match names.split_last() {
        None => String::new(),
        Some((last, [])) => (*last).to_owned(),
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
    }
}

/// Most names of a sentence.
const MOST_NAMES: usize = 5;

/// Some names of a number of others, or how many they are: "differs from both others".
pub(super) fn some_of(names: &[&str], others: usize) -> String {
    match names.len() {
        2 if others == 2 => "both others".to_owned(),
        n if n == others && n > 1 => format!("all {n} others"),
        _ => few_of(names, others),
    }
}

/// Some names of a number of others, after a negation: "does not differ from either of the others".
pub(super) fn any_of(names: &[&str], others: usize) -> String {
    match names.len() {
        2 if others == 2 => "either of the others".to_owned(),
        n if n == others && n > 1 => format!("any of the {n} others"),
        _ => few_of(names, others),
    }
}

fn few_of(names: &[&str], others: usize) -> String {
    match names.len() {
        n if n > MOST_NAMES => format!("{n} of the {others} others"),
        _ => list(names),
    }
}

/// From the least to the largest of some numbers, once where they look alike.
pub(super) fn span(values: &[f64], unit: &str) -> String {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match (number(least), number(largest)) {
        (least, largest) if least == largest => format!("{least}{unit}"),
        (least, largest) => format!("{least}{unit} to {largest}{unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_sensible_digits() {
        assert_eq!(number(0.781_849_4), "0.7818");
        assert_eq!([1.26, 34.4].map(factor), ["1.3", "34"]);
        assert_eq!([0.0625, 2e-5].map(p_value), ["p = 0.0625", "p < 0.0001"]);
        assert_eq!(off_the_goal(3e-7), "within 0.001° of the goal");
        assert_eq!(off_the_goal(0.12688), "0.13° off the goal");
        assert_eq!(
            [0.992, 0.9988, 1.002, 1.2].map(percent),
            ["99 %", "99.9 %", "100.2 %", "120 %"]
        );
        assert_eq!(span(&[2.0, 1.0], " s"), "1.000 s to 2.000 s");
        assert_eq!(span(&[2.0, 2.000_01], " s"), "2.000 s");
    }

    #[test]
    fn lists_are_sentences() {
        assert_eq!(list(&["a"]), "a");
        assert_eq!(list(&["a", "b", "c"]), "a, b and c");
        assert_eq!(some_of(&["a", "b"], 2), "both others");
        assert_eq!(some_of(&["a", "b", "c"], 3), "all 3 others");
        assert_eq!(any_of(&["a", "b"], 2), "either of the others");
        assert_eq!(any_of(&["a", "b", "c"], 3), "any of the 3 others");
        assert_eq!(any_of(&["a", "b"], 3), "a and b");
        assert_eq!(some_of(&["a", "b"], 3), "a and b");
        assert_eq!(some_of(&["a", "b", "c", "d", "e", "f"], 9), "6 of the 9 others");
        assert_eq!(plural(1, "run") + &plural(2, "run"), "1 run2 runs");
    }
}
