//! An experiment's runs as benchmarking tools see them: algorithms, functions, trials.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::RangeInclusive;

use polars::prelude::*;

use crate::analysis::least_found;
use crate::digest::digest;
use crate::experiment::{Identity, Instance, Number, Numbers, Plan, Run};
use crate::output::{FileError, file_name, unlike};

/// The name of the suite in the files.
pub(super) const SUITE: &str = "driftless";

/// The stored runs of an experiment.
#[derive(Debug, Clone)]
pub struct Suite {
    /// The experiment's name.
    pub name: String,
    /// Evaluations allowed to a run.
    pub budget: u64,
    /// The field.
    pub algorithms: Vec<Algorithm>,
    /// The functions.
    pub functions: Vec<Function>,
    /// The stored runs, in the plan's order.
    pub trials: Vec<ExportedRun>,
    /// How many functions and instances have the next free number, as another of this experiment has theirs. Such a number
    /// depends on the experiment.
    pub renumbered: usize,
}

/// One optimiser of the field.
#[derive(Debug, Clone)]
pub struct Algorithm {
    /// Its label.
    pub name: String,
    /// The same, fit for a folder's name and unlike the others'.
    pub folder: String,
    /// All settings, as JSON.
    pub settings: String,
}

/// Evaluation and best cost so far, in order.
pub(super) type Trace = Vec<(u64, f64)>;

/// Instances that differ in no more than their numbers say, and in the number of variables.
#[derive(Debug, Clone)]
pub struct Function {
    /// Its number in the files, the same in every experiment.
    pub number: u32,
    /// The problem's name and, unless that is a test function's, what tells the group from others.
    pub name: String,
    /// The same, fit for a file's name.
    pub file: String,
    /// The instances' groups.
    pub groups: Vec<String>,
    /// The instances.
    pub instances: Vec<Objective>,
}

/// One instance.
#[derive(Debug, Clone)]
pub struct Objective {
    /// Its number in the files, the same in every experiment.
    pub number: u32,
    /// Its group.
    pub group: String,
    /// The number of variables, whatever the formulation.
    pub dimension: u16,
    /// The least cost known; where none is, the least among these runs, infinite where all found nothing.
    pub optimum: f64,
    /// Whether the optimum was known beforehand.
    pub is_known: bool,
}

/// One stored run, as the search evaluated its costs.
#[derive(Debug, Clone)]
pub struct ExportedRun {
    /// Place of the algorithm.
    pub algorithm: usize,
    /// Place of the function.
    pub function: usize,
    /// Place of the instance within the function.
    pub instance: usize,
    /// Seed.
    pub seed: u64,
    /// Evaluation and best cost so far: the first evaluation, improvements, the last one. The cost is
    /// infinite until one is finite, and to the end for a run that found nothing. A run that failed
    /// before its first evaluation has one here, since the formats begin there.
    pub trace: Trace,
}

/// Results that could not be exported.
#[derive(Debug, thiserror::Error)]
pub enum SuiteError {
    /// The files could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The stored tables are not what they should be.
    #[error("cannot use the stored tables")]
    Table(#[from] PolarsError),
    /// The formats count variables in 16 bits.
    #[error("found {0} variables, expected 65,535 at most")]
    TooManyVariables(usize),
    /// And functions, and instances of one, too.
    #[error("found more {0} than the formats have numbers for")]
    TooMany(&'static str),
}

/// The trials of each algorithm on each function, by their dimension, with seeds of one instance
/// together.
pub(super) type Cells<'a> = BTreeMap<(usize, usize), BTreeMap<u16, Vec<&'a ExportedRun>>>;

impl Suite {
    /// The runs of a plan that are stored.
    pub fn new(plan: &Plan, runs: &[Run]) -> Result<Self, SuiteError> {
        let traces: Vec<Trace> = runs.iter().map(whole).collect();
        let (functions, places, renumbered) = functions(plan, &least_found(plan, runs))?;
        let trial = |(run, trace): (&Run, Trace)| {
            let (function, instance) = places[run.instance];
            ExportedRun { algorithm: run.optimiser, function, instance, seed: run.seed, trace }
        };
        Ok(Self {
            name: plan.name.clone(),
            budget: plan.runs.iter().map(|run| run.budget).max().unwrap_or(1),
            algorithms: algorithms(plan),
            functions,
            trials: runs.iter().zip(traces).map(trial).collect(),
            renumbered,
        })
    }

    /// The instance that a trial ran on.
    pub fn objective(&self, trial: &ExportedRun) -> &Objective {
        &self.functions[trial.function].instances[trial.instance]
    }

    pub(super) fn cells(&self) -> Cells<'_> {
        let mut cells = Cells::new();
        for trial in &self.trials {
            let by_dimension = cells.entry((trial.algorithm, trial.function)).or_default();
            by_dimension.entry(self.objective(trial).dimension).or_default().push(trial);
        }
        cells
    }
}

impl ExportedRun {
    /// Evaluations spent.
    pub fn evaluations(&self) -> u64 {
        self.trace.last().map_or(1, |(evaluation, _)| *evaluation)
    }

    /// The best cost, infinite where none is finite.
    pub fn best(&self) -> f64 {
        best(&self.trace)
    }
}

fn best(trace: &Trace) -> f64 {
    trace.last().map_or(f64::INFINITY, |(_, cost)| *cost)
}

/// A run's trace with its first and its last evaluation.
fn whole(run: &Run) -> Trace {
    let mut trace: Trace = run.trace.iter().map(|step| (step.evaluation, step.cost)).collect();
    if trace.first().is_none_or(|(evaluation, _)| *evaluation > 1) {
        trace.insert(0, (1, f64::INFINITY));
    }
    let (last, cost) = trace[trace.len() - 1];
    if last < run.evaluations {
        trace.push((run.evaluations, cost));
    }
    trace
}

fn algorithms(plan: &Plan) -> Vec<Algorithm> {
    let mut taken = HashSet::new();
    let algorithms = plan.optimisers.iter().map(|entrant| {
        let folder = unlike(&file_name(&entrant.label), &mut taken);
        let settings = entrant.settings.to_string();
        Algorithm { name: one_line(&entrant.label), folder, settings }
    });
    algorithms.collect()
}

/// Place of a function, and of an instance within it.
type Place = (usize, usize);

/// The functions, where each instance of the plan is among them, and how many have a number that is not their own.
fn functions(plan: &Plan, least: &[f64]) -> Result<(Vec<Function>, Vec<Place>, usize), SuiteError> {
    let mut renumbered = 0;
    let mut functions: Vec<Function> = Vec::new();
    let mut places = Vec::new();
    let mut by_number: HashMap<u32, (usize, Number)> = HashMap::new();
    let mut taken: HashSet<(usize, u16, u32)> = HashSet::new();
    for (instance, least) in plan.instances.iter().zip(least) {
        let Numbers { function, instance: own } = numbers(instance);
        let is_another = |value: u32| by_number.get(&value).is_some_and(|(_, of)| *of != function);
        let value = free(&function, is_another).ok_or(SuiteError::TooMany("functions"))?;
        let known = by_number.get(&value).map(|(place, _)| *place);
        let place = known.unwrap_or(functions.len());
        if known.is_none() {
            renumbered += usize::from(value != own_number(&function));
            functions.push(self::function(instance, value, &function));
        }
        by_number.insert(value, (place, function));
        let variables = instance.subject.dimension();
        let dimension =
            u16::try_from(variables).map_err(|_| SuiteError::TooManyVariables(variables))?;
        let value = free(&own, |value| taken.contains(&(place, dimension, value)))
            .ok_or(SuiteError::TooMany("instances of one function"))?;
        renumbered += usize::from(value != own_number(&own));
        taken.insert((place, dimension, value));
        let of_function = &mut functions[place];
        if !of_function.groups.contains(&instance.group) {
            of_function.groups.push(instance.group.clone());
        }
        let optimum = instance.subject.known_cost();
        places.push((place, of_function.instances.len()));
        of_function.instances.push(Objective {
            number: value,
            group: instance.group.clone(),
            dimension,
            optimum: optimum.unwrap_or(*least),
            is_known: optimum.is_some(),
        });
    }
    Ok((functions, places, renumbered))
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

/// The numbers that are worked out; readers count in 16 bits.
const WORKED_OUT: RangeInclusive<u32> = 10_001..=65_535;

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
        Number::Of(identity) => hashed(&identity.to_string()),
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

fn function(instance: &Instance, number: u32, by: &Number) -> Function {
    let (problem, group) = (instance.subject.name(), &instance.group);
    let name = match by {
        Number::Known(_) => problem.to_owned(),
        Number::Of(_) if group.starts_with(problem) => group.clone(),
        Number::Of(_) => format!("{problem} {group}"),
    };
    let name = one_line(&name);
    Function { number, file: file_name(&name), name, groups: Vec::new(), instances: Vec::new() }
}

/// A label without line breaks and doubled spaces.
fn one_line(label: &str) -> String {
    label.split_whitespace().collect::<Vec<_>>().join(" ")
}
