//! Which instances of several plans are the same.

use std::collections::HashMap;

use super::plan::Plan;
use super::provenance::{Provenance, WORKED_OUT};
use super::specs::problem_identity;
use super::stored::provenance;
use super::subject::{Instance, Number, Numbers};
use crate::digest::digest;

/// What an export without digests calls a function's instance beside its name: the numbers of function and instance, and the
/// number of variables.
type NumberedId = (u32, u32, usize);

/// Places of instances among all of several plans.
#[derive(Default)]
struct Known<'a> {
    digests: HashMap<String, usize>,
    /// With the names of their functions.
    numbered: HashMap<NumberedId, Vec<(&'a str, usize)>>,
    labels: HashMap<&'a str, Vec<usize>>,
}

/// The place of every instance of every plan among all that they have together, in the order of these. Those with the same
/// problem are one. What was imported from an export of this program is the instance that was exported, and an imported one
/// that is no numbered function is that with its label, where another plan has them; the others stand before those that were
/// imported, which can only be told of.
pub(super) fn places(plans: &[(&str, &Plan)]) -> Vec<Vec<usize>> {
    let mut places: Vec<Vec<usize>> =
        plans.iter().map(|(_, plan)| vec![usize::MAX; plan.instances.len()]).collect();
    let mut known = Known::default();
    for turn in Turn::ALL {
        for (p, ((_, plan), places)) in plans.iter().zip(&mut places).enumerate() {
            let own = plan.instances.iter().zip(places);
            for (instance, place) in own.filter(|(instance, _)| Turn::of(instance) == turn) {
                *place = known.place(instance, turn, p);
            }
        }
    }
    places
}

/// The digest of all that tells an instance from those of other experiments: its problem, and its budget where it has one of its
/// own. One that was exported keeps its digest.
pub(super) fn instance_digest(instance: &Instance) -> String {
    let exported = provenance(instance).and_then(|provenance| provenance.digest.clone());
    exported.unwrap_or_else(|| {
        digest(&serde_json::json!([problem_identity(instance), instance.budget]).to_string())
    })
}

/// When an instance is looked at: those that are known by less come later.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// Of this program.
    Own,
    /// Imported, with the digest of the one that was exported.
    Exported,
    /// Imported, of a function with a number.
    Numbered,
    /// Imported, with no more than a label.
    Labelled,
}

impl Turn {
    const ALL: [Self; 4] = [Self::Own, Self::Exported, Self::Numbered, Self::Labelled];

    fn of(instance: &Instance) -> Self {
        match provenance(instance) {
            None => Self::Own,
            Some(provenance) if provenance.digest.is_some() => Self::Exported,
            Some(provenance) if provenance.function.is_some() => Self::Numbered,
            Some(_) => Self::Labelled,
        }
    }
}

impl<'a> Known<'a> {
    /// The place of an instance of the plan with that index.
    fn place(&mut self, instance: &'a Instance, turn: Turn, plan: usize) -> usize {
        let mut digest = instance_digest(instance);
        let found = match turn {
            Turn::Own | Turn::Exported => None,
            Turn::Numbered => self.numbered(instance),
            Turn::Labelled => self.labelled(&instance.label),
        };
        let is_ambiguous = provenance(instance).is_some_and(Provenance::is_exported)
            && turn == Turn::Numbered
            && numbered_id(instance).is_none();
        if is_ambiguous {
            // Nothing tells it from others of its number but the data that it stands in.
            digest = format!("{digest} {plan}");
        }
        let next = self.digests.len();
        let place = found.unwrap_or_else(|| *self.digests.entry(digest).or_insert(next));
        if matches!(turn, Turn::Own | Turn::Exported)
            && let Some(id) = numbered_id(instance)
        {
            let same = self.numbered.entry(id).or_default();
            if same.iter().all(|(_, known)| *known != place) {
                same.push((function_name(instance), place));
            }
        }
        let same = self.labels.entry(&instance.label).or_default();
        if turn != Turn::Labelled && !same.contains(&place) {
            same.push(place);
        }
        place
    }

    /// The only instance that an export without digests calls like this.
    fn numbered(&self, instance: &Instance) -> Option<usize> {
        let own = function_name(instance);
        let is_named = |name: &str| own.is_empty() || own == name;
        let same = self.numbered.get(&numbered_id(instance)?)?;
        let mut named = same.iter().filter(|(name, _)| is_named(name)).map(|(_, place)| *place);
        named.next().filter(|_| named.next().is_none())
    }

    /// The only instance with this label.
    fn labelled(&self, label: &str) -> Option<usize> {
        match self.labels.get(label).map(Vec::as_slice) {
            Some([place]) => Some(*place),
            _ => None,
        }
    }
}

/// How exports number an instance, unless one of the numbers is worked out, which different instances may share.
fn numbered_id(instance: &Instance) -> Option<NumberedId> {
    let known = |number: Number| match number {
        Number::Known(number) | Number::Exported(number, _) => {
            Some(number).filter(|number| (1..*WORKED_OUT.start()).contains(number))
        }
        Number::Of(_) => None,
    };
    let Numbers { function, instance: own } = instance.subject.numbers()?;
    Some((known(function)?, known(own)?, instance.subject.dimension()))
}

/// The name that exports give a function with a known number.
fn function_name(instance: &Instance) -> &str {
    provenance(instance).map_or_else(|| instance.subject.name(), |provenance| &provenance.name)
}
