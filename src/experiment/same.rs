//! Which instances of several plans are the same.

use std::collections::HashMap;
use std::num::NonZeroU64;

use super::origin::Origin;
use super::plan::Plan;
use super::specs::problem_identity;
use super::stored::origin;
use super::subject::Instance;

/// What tells an instance from those of other experiments: its problem, and its budget where it has one of its own.
type InstanceId = (String, Option<NonZeroU64>);

/// What an export calls an instance beside the function's name: the numbers of function and instance, and its number of
/// variables.
type ExportedId = (u32, u32, u64);

/// Places of instances among all of several plans.
#[derive(Default)]
struct Known<'a> {
    ids: HashMap<InstanceId, usize>,
    /// With the names of their functions.
    exported: HashMap<ExportedId, Vec<(String, usize)>>,
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
    let is_exported = |instance: &Instance| origin(instance).is_some_and(Origin::is_exported);
    let needs_numbers = plans.iter().any(|(_, plan)| plan.instances.iter().any(is_exported));
    for turn in 0..3 {
        for ((_, plan), places) in plans.iter().zip(&mut places) {
            let is_numbered = turn == 0 && needs_numbers && plan.imported().is_none();
            let numbering = if is_numbered { plan.numbering().ok() } else { None };
            for (i, instance) in
                plan.instances.iter().enumerate().filter(|(_, i)| turn_of(i) == turn)
            {
                places[i] = known.place(instance);
                if let Some(numbered) = numbering.as_ref().map(|numbering| &numbering.instances[i])
                {
                    let id = (numbered.function, numbered.instance, u64::from(numbered.dimension));
                    let same = known.exported.entry(id).or_default();
                    if same.iter().all(|(_, place)| *place != places[i]) {
                        same.push((numbered.name.clone(), places[i]));
                    }
                }
            }
        }
    }
    places
}

/// First come instances of this program, then imported functions, then imported problems that have no more than a label.
fn turn_of(instance: &Instance) -> u8 {
    match origin(instance) {
        None => 0,
        Some(origin) if origin.function.is_some() => 1,
        Some(_) => 2,
    }
}

impl<'a> Known<'a> {
    fn place(&mut self, instance: &'a Instance) -> usize {
        let found = origin(instance).and_then(|origin| match origin.function {
            Some(_) => self.exported(origin),
            None => self.labelled(&instance.label),
        });
        let id = (problem_identity(instance).to_string(), instance.budget);
        let next = self.ids.len();
        let place = match found {
            Some(place) => place,
            None => *self.ids.entry(id).or_insert(next),
        };
        let same = self.labels.entry(&instance.label).or_default();
        if turn_of(instance) < 2 && !same.contains(&place) {
            same.push(place);
        }
        place
    }

    /// The only instance that an export calls like this.
    fn exported(&self, origin: &Origin) -> Option<usize> {
        let function = origin.function.filter(|_| origin.is_exported())?;
        let same = self.exported.get(&(function, origin.instance?, origin.dimension?))?;
        let is_named = |name: &str| origin.name.is_empty() || origin.name == name;
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
