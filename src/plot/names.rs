//! What charts call the optimisers of a field: labels without the settings that all of a kind share.

use std::collections::HashSet;

use crate::figure::axis::LONGEST_NAME;
use crate::figure::style::TEXT_PT;
use crate::figure::text::text_width;

/// Names by label, and what has to be known to read them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Names {
    pub(super) names: Vec<String>,
    /// Sentences for captions, each with a space before; empty where names say all.
    pub(super) note: String,
}

/// Names of the labels of a field. Those with the same beginning that differ in settings lose the settings that all of
/// them have; where what is left is too long for a chart, values alone are left, and the note says of what.
pub(super) fn names(labels: &[&str]) -> Names {
    let parts: Vec<(&str, Vec<&str>)> = labels.iter().map(|label| parts(label)).collect();
    let mut told = Names::default();
    let mut noted = HashSet::new();
    for (head, settings) in &parts {
        let twins = || parts.iter().filter(|(other, _)| other == head).map(|(_, own)| own);
        let is_shared = |setting: &&&str| twins().all(|own| own.contains(setting));
        let own = |settings: &[&str]| -> String {
            let own = settings.iter().filter(|setting| twins().count() < 2 || !is_shared(setting));
            own.fold((*head).to_owned(), |name, setting| name + " " + setting)
        };
        let keys = |settings: &[&str]| -> Vec<String> {
            let own = settings.iter().filter(|setting| !is_shared(setting));
            own.filter_map(|s| s.split_once('=')).map(|(key, _)| key.to_owned()).collect()
        };
        let is_long = twins().any(|settings| text_width(&own(settings), TEXT_PT) > LONGEST_NAME);
        let same_keys = twins().all(|other| keys(other) == keys(settings));
        let name = own(settings);
        if !(is_long && same_keys && keys(settings).len() > 1) {
            told.names.push(name);
            continue;
        }
        let values = settings.iter().filter(|setting| !is_shared(setting));
        let values: Vec<&str> = values.filter_map(|s| Some(s.split_once('=')?.1)).collect();
        told.names.push(format!("{head} {}", values.join(" ")));
        if noted.insert(*head) {
            let keys = keys(settings).join(", ");
            told.note.extend([" Behind ", head, " stand, in this order, ", &keys, "."]);
        }
    }
    let distinct: HashSet<&String> = told.names.iter().collect();
    if distinct.len() < labels.len() {
        return Names {
            names: labels.iter().map(|&l| l.to_owned()).collect(),
            note: String::new(),
        };
    }
    told
}

/// What a label begins with, and its settings.
fn parts(label: &str) -> (&str, Vec<&str>) {
    let words = label.split(' ').take_while(|word| !word.contains('='));
    let behind: usize = words.map(|word| word.len() + 1).sum();
    let settings: Vec<&str> = label.get(behind..).unwrap_or_default().split(' ').collect();
    let are_settings = settings.iter().all(|setting| setting.contains('='));
    match behind.checked_sub(1) {
        Some(end) if are_settings => (&label[..end], settings),
        _ => (label, Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every combination of a sweep over three settings, beside two that all share.
    #[test]
    fn names_have_what_differs() {
        let mut labels = vec!["de".to_owned()];
        for (a, b, c) in [("1.5", "1.5", "0.05"), ("1.5", "2.5", "0.05"), ("2.5", "1.5", "0.1")] {
            labels.push(format!(
                "pso population=25 last=0.4 cognitive={a} social={b} velocity_limit={c}"
            ));
        }
        let labels: Vec<&str> = labels.iter().map(String::as_str).collect();
        let told = names(&labels);
        assert_eq!(
            told.names,
            [
                "de",
                "pso cognitive=1.5 social=1.5 velocity_limit=0.05",
                "pso cognitive=1.5 social=2.5 velocity_limit=0.05",
                "pso cognitive=2.5 social=1.5 velocity_limit=0.1",
            ]
        );
        assert_eq!(told.note, "");
    }

    #[test]
    fn long_names_have_their_keys_once() {
        let label = |a: u32| {
            let more: Vec<String> = (0..8)
                .map(|i| format!("a_setting_{i}={}", if i < 2 { a } else { 7 + a }))
                .collect();
            format!("pso {}", more.join(" "))
        };
        let labels = [label(1), label(2)];
        let told = names(&labels.each_ref().map(String::as_str));
        assert_eq!(told.names, ["pso 1 1 8 8 8 8 8 8", "pso 2 2 9 9 9 9 9 9"]);
        let note = " Behind pso stand, in this order, a_setting_0, a_setting_1, a_setting_2, a_setting_3, \
                    a_setting_4, a_setting_5, a_setting_6, a_setting_7.";
        assert_eq!(told.note, note);
    }

    #[test]
    fn labels_of_ones_own_stay_as_they_are() {
        let labels = ["my pso", "my pso, a = 3", "=", "a=1", "pso a=1", "pso"];
        assert_eq!(names(&labels).names, labels);
    }
}
