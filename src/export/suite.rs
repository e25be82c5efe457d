//! An experiment's runs as benchmarking tools see them: algorithms, functions, trials.

use std::collections::{BTreeMap, HashMap, HashSet};

use polars::prelude::*;

use crate::analysis::least_found;
use crate::experiment::{Instance, Plan, Run};
use crate::output::{FileError, file_name, unlike};

/// The name of the suite in the files.
pub(super) const SUITE: &str = "driftless";

/// The stored runs of an experiment.
#[derive(Debug, Clone)]
pub struct Suite {
    /// The experiment's name.
    pub name: String,
    /// The largest seed of the plan.
    pub seeds: u64,
    /// Evaluations allowed to a run.
    pub budget: u64,
    /// The field.
    pub algorithms: Vec<Algorithm>,
    /// One each group of instances; its number in the files is its place, counted from one.
    pub functions: Vec<Function>,
    /// The stored runs, in the plan's order.
    pub trials: Vec<ExportedRun>,
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

/// Instances that are summarised together.
#[derive(Debug, Clone)]
pub struct Function {
    /// The problem's name and what tells the group from others.
    pub name: String,
    /// The same, fit for a file's name.
    pub file: String,
    /// The instances' group.
    pub group: String,
    /// The instances; an instance's number in the files is its place, counted from one.
    pub instances: Vec<Objective>,
}

/// One instance.
#[derive(Debug, Clone)]
pub struct Objective {
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
    /// The formats number functions, instances and variables in 16 bits.
    #[error("found {found} {what}, expected {} at most", u16::MAX)]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many.
        found: usize,
    },
}

/// The trials of each algorithm on each function, by their dimension, with seeds of one instance
/// together.
pub(super) type Cells<'a> = BTreeMap<(usize, usize), BTreeMap<u16, Vec<&'a ExportedRun>>>;

impl Suite {
    /// The runs of a plan that are stored.
    pub fn new(plan: &Plan, runs: &[Run]) -> Result<Self, SuiteError> {
        let traces: Vec<Trace> = runs.iter().map(whole).collect();
        let (functions, places) = functions(plan, &least_found(plan, runs))?;
        let trial = |(run, trace): (&Run, Trace)| {
            let (function, instance) = places[run.instance];
            ExportedRun { algorithm: run.optimiser, function, instance, seed: run.seed, trace }
        };
        Ok(Self {
            name: plan.name.clone(),
            seeds: plan.runs.iter().map(|run| run.seed).max().unwrap_or(1),
            budget: plan.runs.iter().map(|run| run.budget).max().unwrap_or(1),
            algorithms: algorithms(plan),
            functions,
            trials: runs.iter().zip(traces).map(trial).collect(),
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

/// The functions, and where each instance of the plan is among them.
fn functions(plan: &Plan, least: &[f64]) -> Result<(Vec<Function>, Vec<Place>), SuiteError> {
    let mut functions: Vec<Function> = Vec::new();
    let mut places = Vec::new();
    let mut of_group: HashMap<&str, usize> = HashMap::new();
    for (instance, least) in plan.instances.iter().zip(least) {
        let place = *of_group.entry(&instance.group).or_insert_with(|| {
            functions.push(function(instance));
            functions.len() - 1
        });
        let known = instance.subject.known_cost();
        let instances = &mut functions[place].instances;
        places.push((place, instances.len()));
        instances.push(Objective {
            dimension: number("variables", instance.subject.dimension())?,
            optimum: known.unwrap_or(*least),
            is_known: known.is_some(),
        });
        number("instances of one function", instances.len())?;
    }
    number("functions", functions.len())?;
    Ok((functions, places))
}

fn function(instance: &Instance) -> Function {
    let (problem, group) = (instance.subject.name(), &instance.group);
    let name =
        if group.starts_with(problem) { group.clone() } else { format!("{problem} {group}") };
    let name = one_line(&name);
    Function { file: file_name(&name), name, group: group.clone(), instances: Vec::new() }
}

fn number(what: &'static str, found: usize) -> Result<u16, SuiteError> {
    u16::try_from(found).map_err(|_| SuiteError::TooMany { what, found })
}

/// A label without line breaks and doubled spaces.
fn one_line(label: &str) -> String {
    label.split_whitespace().collect::<Vec<_>>().join(" ")
}
