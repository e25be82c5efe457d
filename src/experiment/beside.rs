//! Experiments side by side, as if they were one.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::num::NonZeroU64;

use super::entrant::Entrant;
use super::plan::{Plan, RunSpec, problem_identity};
use super::subject::Instance;

/// What tells an instance from those of other experiments: its problem, and its budget where it has one of its own.
type InstanceId = (String, Option<NonZeroU64>);

/// What tells an optimiser from those of other experiments: settings, formulation and what its runs may spend.
type EntrantId = (String, Option<String>, NonZeroU64);

impl Plan {
    /// One plan with all that these plans have, each with a name that tells it from the others, such as that of its folder.
    /// Instances with the same problem are one, and so are optimisers with the same settings and budget, whatever they are
    /// called; what has one label in two plans and is not the same has the plan's name behind it. A run that several plans
    /// have stands once.
    ///
    /// None for no plans.
    pub fn beside(plans: &[(&str, &Plan)]) -> Option<Plan> {
        let (_, first) = plans.first()?;
        let all = All::of(plans);
        let name: Vec<&str> = plans.iter().map(|(name, _)| *name).collect();
        let mut experiment = first.experiment.clone();
        experiment.name = name.join(", ");
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
        let (mut instances, mut optimisers) = (HashMap::new(), HashMap::new());
        let labels = ambiguous(plans, |plan| {
            let own = plan.instances.iter();
            own.map(|i| (i.label.clone(), format!("{:?}", instance_id(i)))).collect()
        });
        let groups = ambiguous_groups(plans, &labels);
        let names = ambiguous(plans, |plan| {
            let own = plan.optimisers.iter();
            own.map(|o| (o.label.clone(), format!("{:?}", entrant_id(o, plan)))).collect()
        });
        let mut keys = HashSet::new();
        for (name, plan) in plans {
            let own: Vec<usize> = plan
                .instances
                .iter()
                .map(|instance| {
                    *instances.entry(instance_id(instance)).or_insert_with(|| {
                        all.instances.push(named(instance, name, &labels, &groups));
                        all.instances.len() - 1
                    })
                })
                .collect();
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

fn instance_id(instance: &Instance) -> InstanceId {
    (problem_identity(instance).to_string(), instance.budget)
}

fn entrant_id(entrant: &Entrant, plan: &Plan) -> EntrantId {
    let budget = entrant.budget.unwrap_or(plan.experiment.budget);
    (entrant.identity().to_string(), entrant.formulation.clone(), budget)
}

/// The labels that stand for different things in different plans.
fn ambiguous(
    plans: &[(&str, &Plan)],
    labelled: impl Fn(&Plan) -> Vec<(String, String)>,
) -> HashSet<String> {
    let mut meanings: HashMap<String, BTreeSet<String>> = HashMap::new();
    for (label, meaning) in plans.iter().flat_map(|(_, plan)| labelled(plan)) {
        meanings.entry(label).or_default().insert(meaning);
    }
    let several = meanings.into_iter().filter(|(_, meanings)| meanings.len() > 1);
    several.map(|(label, _)| label).collect()
}

/// The groups that are not the same in all plans that have them: some label there stands for different things, or the plans
/// share none of their instances and the group's name does not say what they are.
fn ambiguous_groups(plans: &[(&str, &Plan)], labels: &HashSet<String>) -> HashSet<String> {
    let mut groups: HashMap<&str, Vec<HashSet<InstanceId>>> = HashMap::new();
    let mut found = HashSet::new();
    for (_, plan) in plans {
        let mut own: HashMap<&str, HashSet<InstanceId>> = HashMap::new();
        for instance in &plan.instances {
            own.entry(&instance.group).or_default().insert(instance_id(instance));
            if labels.contains(&instance.label) {
                found.insert(instance.group.clone());
            }
        }
        for (group, ids) in own {
            let name = plan.instances.iter().find(|instance| instance.group == group);
            let says = name.is_some_and(|instance| group.starts_with(instance.subject.name()));
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
