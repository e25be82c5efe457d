//! Experiments side by side, as if they were one.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::num::NonZeroU64;

use super::entrant::Entrant;
use super::plan::Plan;
use super::same::places;
use super::specs::RunSpec;
use super::stored::provenance;
use super::subject::Instance;

/// What tells an optimiser from those of other experiments: settings, formulation and what its runs may spend.
type EntrantId = (String, Option<String>, NonZeroU64);

impl Plan {
    /// One plan with all that these plans have, each with a name that tells it from the others, such as that of its folder.
    /// Instances with the same problem are one, also where results were imported, and so are optimisers with the same settings
    /// and budget, whatever they are called; what has one label in two plans and is not the same has the plan's name behind it.
    /// A run that several plans have stands once.
    ///
    /// None for no plans.
    pub fn beside(plans: &[(&str, &Plan)]) -> Option<Plan> {
        let (_, first) = plans.first()?;
        let all = All::of(plans);
        let name: Vec<&str> = plans.iter().map(|(name, _)| *name).collect();
        let mut experiment = first.experiment.clone();
        experiment.name = name.join(", ");
        experiment.imported = None;
        Some(experiment.spelt_out(all.instances, all.optimisers, all.runs))
    }
}

#[derive(Default)]
struct All {
    instances: Vec<Instance>,
    optimisers: Vec<Entrant>,
    runs: Vec<RunSpec>,
}

impl All {
    fn of(plans: &[(&str, &Plan)]) -> Self {
        let mut all = Self::default();
        let mut optimisers = HashMap::new();
        let places = places(plans);
        // What an instance is called follows from the first plan that has it; those that can be run stand before imported ones.
        let mut first: BTreeMap<usize, (&str, &Instance)> = BTreeMap::new();
        for ((name, plan), places) in plans.iter().zip(&places) {
            for (instance, place) in plan.instances.iter().zip(places) {
                let known = first.entry(*place).or_insert((*name, instance));
                if provenance(known.1).is_some() && provenance(instance).is_none() {
                    *known = (*name, instance);
                }
            }
        }
        let called = |place: &usize| first[place].1;
        let labels = ambiguous(first.iter().map(|(place, (_, i))| (i.label.as_str(), place)));
        let groups = ambiguous_groups(&places, called, &labels);
        all.instances = first
            .values()
            .map(|(name, instance)| named(instance, name, &labels, &groups))
            .collect();
        let names = ambiguous(plans.iter().flat_map(|(_, plan)| {
            let own = plan.optimisers.iter();
            own.map(|o| (o.label.as_str(), entrant_id(o, plan)))
        }));
        let mut keys = HashSet::new();
        for ((name, plan), own) in plans.iter().zip(&places) {
            let field: Vec<usize> = plan
                .optimisers
                .iter()
                .map(|entrant| {
                    *optimisers.entry(entrant_id(entrant, plan)).or_insert_with(|| {
                        let mut entrant = entrant.clone();
                        if names.contains(&entrant.label) {
                            entrant.label = format!("{} ({name})", entrant.label);
                        }
                        all.optimisers.push(entrant);
                        all.optimisers.len() - 1
                    })
                })
                .collect();
            for run in plan.runs.iter().filter(|run| keys.insert(run.key.clone())) {
                all.runs.push(RunSpec {
                    instance: own[run.instance],
                    optimiser: field[run.optimiser],
                    ..run.clone()
                });
            }
        }
        all.runs.sort_by_key(|run| (run.instance, run.optimiser, run.seed));
        all
    }
}

fn entrant_id(entrant: &Entrant, plan: &Plan) -> EntrantId {
    // What imported runs may spend is part of their data, and these of the optimiser's settings.
    let own = || entrant.budget.unwrap_or(plan.experiment.budget);
    let budget = if entrant.imported().is_some() { NonZeroU64::MIN } else { own() };
    (entrant.identity().to_string(), entrant.formulation.clone(), budget)
}

/// The labels that stand for different things.
fn ambiguous<'a, T: Ord>(labelled: impl Iterator<Item = (&'a str, T)>) -> HashSet<String> {
    let mut meanings: HashMap<&str, BTreeSet<T>> = HashMap::new();
    for (label, meaning) in labelled {
        meanings.entry(label).or_default().insert(meaning);
    }
    let several = meanings.into_iter().filter(|(_, meanings)| meanings.len() > 1);
    several.map(|(label, _)| label.to_owned()).collect()
}

/// The groups that are not the same in all plans that have them: some label there stands for different things, or the plans
/// share none of their instances and the group's name does not say what they are. `places` are those of each plan's instances,
/// and `called` gives an instance by its place.
fn ambiguous_groups<'a>(
    places: &[Vec<usize>],
    called: impl Fn(&usize) -> &'a Instance,
    labels: &HashSet<String>,
) -> HashSet<String> {
    let mut groups: HashMap<&str, Vec<HashSet<usize>>> = HashMap::new();
    let mut found = HashSet::new();
    for places in places {
        let mut own: HashMap<&str, HashSet<usize>> = HashMap::new();
        for place in places {
            let instance = called(place);
            own.entry(&instance.group).or_default().insert(*place);
            if labels.contains(&instance.label) {
                found.insert(instance.group.clone());
            }
        }
        for (group, ids) in own {
            let mut instances = ids.iter().map(&called);
            let says = instances.all(|instance| group.starts_with(instance.subject.name()));
            let others = groups.entry(group).or_default();
            if !says && !others.is_empty() && others.iter().all(|other| other.is_disjoint(&ids)) {
                found.insert(group.to_owned());
            }
            others.push(ids);
        }
    }
    found
}

/// An instance of a plan with labels that tell it from others'.
fn named(
    instance: &Instance,
    plan: &str,
    labels: &HashSet<String>,
    groups: &HashSet<String>,
) -> Instance {
    let mut instance = instance.clone();
    let with = |text: &str| {
        if text.is_empty() { plan.to_owned() } else { format!("{text} ({plan})") }
    };
    if groups.contains(&instance.group) {
        instance.group = with(&instance.group);
        instance.title = with(&instance.title);
        instance.series = with(&instance.series);
    }
    if labels.contains(&instance.label) {
        instance.label = with(&instance.label);
    }
    instance
}
