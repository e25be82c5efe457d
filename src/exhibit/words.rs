//! Numbers and lists as one reads them.

/// A cost or a time, to four digits.
pub(crate) fn number(value: f64) -> String {
    significant(value, 4)
}

/// How many times as much.
pub(crate) fn factor(value: f64) -> String {
    match value {
        0.0..0.1 => significant(value, 1),
        0.1..10.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// A p-value with its sign of relation.
pub(crate) fn p_value(p: f64) -> String {
    if p < 1e-4 { "p < 0.0001".to_owned() } else { format!("p = {}", significant(p, 3)) }
}

/// A share in whole percent, in tenths where that would hide on which side of 100 % it is.
pub(crate) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.round() == 100.0 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Names as a sentence has them.
pub(crate) fn list<T: AsRef<str>>(names: &[T]) -> String {
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
pub(crate) fn some_of(names: &[&str], others: usize) -> String {
    match names.len() {
        2 if others == 2 => "both others".to_owned(),
        n if n == others && n > 1 => format!("all {n} others"),
        _ => few_of(names, others),
    }
}

/// Some names of a number of others, after a negation: "does not differ from either of the others".
pub(crate) fn any_of(names: &[&str], others: usize) -> String {
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
pub(crate) fn span(values: &[f64], unit: &str) -> String {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match (number(least), number(largest)) {
        (least, largest) if least == largest => format!("{least}{unit}"),
        (least, largest) => format!("{least}{unit} to {largest}{unit}"),
    }
}

/// So many significant digits, in plain notation where that is readable.
pub(crate) fn significant(number: f64, digits: usize) -> String {
    if !number.is_finite() {
        return if number == f64::INFINITY { "∞" } else { "–" }.to_owned();
    }
    let magnitude = if number == 0.0 { 0.0 } else { number.abs().log10().floor() };
    if (-4.0..7.0).contains(&magnitude) {
        format!("{number:.*}", (digits as f64 - 1.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{number:.3e}")
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
        assert_eq!(
            [0.992, 0.9988, 1.002, 1.2].map(percent),
            ["99 %", "99.9 %", "100.2 %", "120 %"]
        );
        assert_eq!(span(&[2.0, 1.0], " s"), "1.000 s to 2.000 s");
        assert_eq!(span(&[2.0, 2.000_01], " s"), "2.000 s");
    }

    #[test]
    fn keeps_five_significant_digits() {
        for (number, text) in [
            (0.0, "0.0000"),
            (0.781_849_4, "0.78185"),
            (13.290_71, "13.291"),
            (123_456.7, "123457"),
            (0.000_123_456, "0.00012346"),
            (1.5e-7, "1.500e-7"),
            (f64::NAN, "–"),
        ] {
            assert_eq!(significant(number, 5), text);
        }
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
    }
}
