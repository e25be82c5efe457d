//! What charts call the optimisers of a field: labels without the settings that all of a kind share.

use std::collections::{HashMap, HashSet};

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
    let mut by_head: HashMap<&str, Vec<&[&str]>> = HashMap::new();
    for (head, settings) in &parts {
        by_head.entry(head).or_default().push(settings);
    }
    let kinds: HashMap<&str, Kind> =
        by_head.into_iter().map(|(head, all)| (head, Kind::new(head, &all))).collect();
    let mut short = Names::default();
    let mut noted = HashSet::new();
    for (head, settings) in &parts {
        let kind = &kinds[head];
        short.names.push(kind.name(head, settings));
        if let Some(keys) = &kind.keys
            && noted.insert(*head)
        {
            let keys = keys.join(", ");
            short.note.extend([" Behind ", head, " stand, in this order, ", &keys, "."]);
        }
    }
    let distinct: HashSet<&String> = short.names.iter().collect();
    if distinct.len() < labels.len() {
        return Names {
            names: labels.iter().map(|&l| l.to_owned()).collect(),
            note: String::new(),
        };
    }
    short
}

/// The labels with the same beginning.
struct Kind<'a> {
    /// The settings that all of them have.
    shared: HashSet<&'a str>,
    /// The keys of the others, where values stand without them.
    keys: Option<Vec<&'a str>>,
}

impl<'a> Kind<'a> {
    fn new(head: &str, all: &[&[&'a str]]) -> Self {
        let mut kind = Self { shared: HashSet::new(), keys: None };
        let [first, others @ ..] = all else { return kind };
        if others.is_empty() {
            return kind;
        }
        kind.shared = first.iter().copied().collect();
        for other in others {
            kind.shared.retain(|setting| other.contains(setting));
        }
        let keys = kind.own_keys(first);
        let is_long = all
            .iter()
            .any(|settings| text_width(&kind.name(head, settings), TEXT_PT) > LONGEST_NAME);
        let same_keys = others.iter().all(|other| kind.own_keys(other) == keys);
        kind.keys = (is_long && same_keys && keys.len() > 1).then_some(keys);
        kind
    }

    /// The settings of a label that not all have.
    fn own<'b>(&self, settings: &'b [&'a str]) -> impl Iterator<Item = &'a str> + use<'_, 'a, 'b> {
        settings.iter().copied().filter(|setting| !self.shared.contains(setting))
    }

    fn own_keys(&self, settings: &[&'a str]) -> Vec<&'a str> {
        self.own(settings).filter_map(|setting| Some(setting.split_once('=')?.0)).collect()
    }

    fn name(&self, head: &str, settings: &[&'a str]) -> String {
        self.own(settings).fold(head.to_owned(), |name, setting| {
            let value = setting.split_once('=').map_or(setting, |(_, value)| value);
            name + " " + if self.keys.is_some() { value } else { setting }
        })
    }
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
