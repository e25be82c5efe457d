//! An experiment's runs as benchmarking tools see them: algorithms, functions, trials.

use std::collections::{BTreeMap, HashMap, HashSet};

use polars::prelude::*;

use crate::analysis::least_found;
use crate::experiment::{Numbering, NumberingError, Plan, Run, one_line};
use crate::output::{FileError, file_name, unlike};

pub(super) use crate::experiment::EXPORTED_SUITE as SUITE;

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
    /// What tells it from all others, in every experiment: 16 hexadecimal digits.
    pub digest: String,
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
    /// Evaluations allowed.
    pub budget: u64,
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
    /// The formats have too few numbers.
    #[error(transparent)]
    Numbering(#[from] NumberingError),
}

/// The trials of each algorithm on each function, by their dimension, with seeds of one instance
/// together.
pub(super) type Cells<'a> = BTreeMap<(usize, usize), BTreeMap<u16, Vec<&'a ExportedRun>>>;

impl Suite {
    /// The runs of a plan that are stored.
    pub fn new(plan: &Plan, runs: &[Run]) -> Result<Self, SuiteError> {
        let traces: Vec<Trace> = runs.iter().map(whole).collect();
        let numbering = plan.numbering()?;
        let (functions, places) = functions(plan, &numbering, &least_found(plan, runs));
        let trial = |(run, trace): (&Run, Trace)| {
            let (function, instance) = places[run.instance];
            let (algorithm, seed, budget) = (run.optimiser, run.seed, run.budget);
            ExportedRun { algorithm, function, instance, seed, budget, trace }
        };
        Ok(Self {
            name: plan.name.clone(),
            budget: plan.runs.iter().map(|run| run.budget).max().unwrap_or(1),
            algorithms: algorithms(plan),
            functions,
            trials: runs.iter().zip(traces).map(trial).collect(),
            renumbered: numbering.renumbered,
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
fn functions(plan: &Plan, numbering: &Numbering, least: &[f64]) -> (Vec<Function>, Vec<Place>) {
    let mut functions: Vec<Function> = Vec::new();
    let mut places = Vec::new();
    let mut by_number: HashMap<u32, usize> = HashMap::new();
    for ((instance, numbered), least) in plan.instances.iter().zip(&numbering.instances).zip(least)
    {
        let place = *by_number.entry(numbered.function).or_insert_with(|| {
            let (number, name) = (numbered.function, numbered.name.clone());
            let (groups, instances) = (Vec::new(), Vec::new());
            functions.push(Function { number, file: file_name(&name), name, groups, instances });
            functions.len() - 1
        });
        let of_function = &mut functions[place];
        if !of_function.groups.contains(&instance.group) {
            of_function.groups.push(instance.group.clone());
        }
        let optimum = instance.subject.known_cost();
        places.push((place, of_function.instances.len()));
        of_function.instances.push(Objective {
            number: numbered.instance,
            digest: numbered.digest.clone(),
            group: instance.group.clone(),
            dimension: numbered.dimension,
            optimum: optimum.unwrap_or(*least),
            is_known: optimum.is_some(),
        });
    }
    (functions, places)
}
