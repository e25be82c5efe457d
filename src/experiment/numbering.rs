//! The numbers that exports give functions and instances, the same in every experiment.

use std::collections::{HashMap, HashSet};

use super::identity::Identity;
use super::plan::Plan;
use super::provenance::{IMPORTED_KIND, WORKED_OUT};
use super::same::instance_digest;
use super::subject::{Instance, Number, Numbers};
use crate::digest::digest;

/// The numbers of all instances of a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Numbering {
    /// One entry per instance, in the plan's order.
    pub instances: Vec<Numbered>,
    /// How many functions and instances have the next free number, as another of this experiment has theirs. Such a number
    /// depends on the experiment.
    pub renumbered: usize,
}

/// What exports call an instance.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Numbered {
    /// The function's number.
    pub function: u32,
    /// The function's name: the problem's and, unless that is a test function's, what tells the group from others.
    pub name: String,
    /// The number of variables, whatever the formulation.
    pub dimension: u16,
    /// The instance's number.
    pub instance: u32,
    /// What tells the instance from all others, in every experiment: 16 hexadecimal digits.
    pub digest: String,
}

/// An experiment that exports have too few numbers for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NumberingError {
    /// The formats count variables in 16 bits.
    #[error("found {0} variables, expected 65,535 at most")]
    TooManyVariables(usize),
    /// And functions, and instances of one, too.
    #[error("found more {0} than the formats have numbers for")]
    TooMany(&'static str),
}

impl Plan {
    /// The numbers that exports give the instances.
    pub fn numbering(&self) -> Result<Numbering, NumberingError> {
        let mut numbering = Numbering { instances: Vec::new(), renumbered: 0 };
        let mut by_number: HashMap<u32, (Number, String)> = HashMap::new();
        let mut taken: HashSet<(u32, u16, u32)> = HashSet::new();
        for instance in &self.instances {
            let Numbers { function: by, instance: own } = numbers(instance);
            let is_another = |value: u32| by_number.get(&value).is_some_and(|(of, _)| *of != by);
            let function = free(&by, is_another).ok_or(NumberingError::TooMany("functions"))?;
            let is_new = !by_number.contains_key(&function);
            numbering.renumbered += usize::from(is_new && function != own_number(&by));
            let named = by_number.entry(function).or_insert_with(|| {
                let name = function_name(instance, &by);
                (by, name)
            });
            let variables = instance.subject.dimension();
            let dimension = u16::try_from(variables)
                .map_err(|_| NumberingError::TooManyVariables(variables))?;
            let number = free(&own, |value| taken.contains(&(function, dimension, value)))
                .ok_or(NumberingError::TooMany("instances of one function"))?;
            numbering.renumbered += usize::from(number != own_number(&own));
            taken.insert((function, dimension, number));
            let name = named.1.clone();
            let digest = instance_digest(instance);
            let numbered = Numbered { function, name, dimension, instance: number, digest };
            numbering.instances.push(numbered);
        }
        Ok(numbering)
    }
}

fn numbers(instance: &Instance) -> Numbers {
    let subject = &instance.subject;
    let by_group = || Numbers {
        function: Number::Of(
            Identity::new().with("name", subject.name()).with("group", instance.group.as_str()),
        ),
        instance: Number::Of(subject.identity()),
    };
    subject.numbers().unwrap_or_else(by_group)
}

/// The number that a function or an instance has where no other has it.
fn own_number(number: &Number) -> u32 {
    let (first, last) = WORKED_OUT.into_inner();
    let hashed = |text: &str| {
        let hash = u64::from_str_radix(&digest(text), 16).unwrap_or_default();
        first + (hash % u64::from(last - first + 1)) as u32
    };
    match number {
        Number::Known(number) if (1..first).contains(number) => *number,
        Number::Known(number) => hashed(&number.to_string()),
        Number::Exported(number, _) if (1..=last).contains(number) => *number,
        Number::Exported(_, identity) | Number::Of(identity) => hashed(&identity.to_string()),
    }
}

/// The number of a function or an instance or, where that is taken, as by one and the same with another budget, the next that is
/// not.
fn free(number: &Number, is_taken: impl Fn(u32) -> bool) -> Option<u32> {
    let (first, last) = WORKED_OUT.into_inner();
    let own = own_number(number);
    std::iter::once(own)
        .chain((own + 1).max(first)..=last)
        .chain(WORKED_OUT)
        .find(|value| !is_taken(*value))
}

fn function_name(instance: &Instance, by: &Number) -> String {
    let (subject, group) = (&instance.subject, &instance.group);
    let problem = subject.name();
    let name = match by {
        Number::Of(_) if subject.kind() == IMPORTED_KIND => problem.to_owned(),
        Number::Known(_) | Number::Exported(..) => problem.to_owned(),
        Number::Of(_) if group.starts_with(problem) => group.clone(),
        Number::Of(_) => format!("{problem} {group}"),
    };
    one_line(&name)
}

/// A label without line breaks and doubled spaces.
pub(crate) fn one_line(label: &str) -> String {
    label.split_whitespace().collect::<Vec<_>>().join(" ")
}
