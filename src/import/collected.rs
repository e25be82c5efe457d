//! Runs as they are read, on their way to results.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::num::NonZeroU64;
use std::path::{Path, PathBuf};

use super::Import;
use super::error::ImportError;
use super::files::name_of;
use crate::experiment::{
    DataFormat, Foreign, ForeignOptimiser, ForeignProblem, ForeignRun, ForeignStep, Provenance,
};

/// Most runs, as of any experiment.
const MOST_RUNS: usize = 1_000_000;

/// Most evaluations of a run, as a budget's; the largest seed, which files keep with a sign; most variables.
const MOST_EVALUATIONS: u64 = 1_000_000_000_000;
const LARGEST_SEED: u64 = i64::MAX as u64;
const MOST_VARIABLES: u64 = 1_000_000;

/// Most rows of traces; all of them are in memory at a time.
pub(super) const MOST_ROWS: usize = 20_000_000;

/// Rows of a run in the order of evaluations, of which improvements are kept.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    improvements: Vec<ForeignStep>,
    last: u64,
}

impl Rows {
    pub(super) fn push(&mut self, evaluation: u64, cost: f64) {
        self.last = self.last.max(evaluation);
        if cost.is_finite() && self.improvements.last().is_none_or(|best| cost < best.cost) {
            self.improvements.push(ForeignStep { evaluation, cost, seconds: None });
        }
    }

    /// The last evaluation.
    pub(super) fn last(&self) -> u64 {
        self.last
    }

    /// All improvements that these and others have.
    pub(super) fn with(mut self, other: Self) -> Self {
        self.improvements.extend(other.improvements);
        Self { last: self.last.max(other.last), ..self }
    }

    /// The trace of a run that ended after so many evaluations, or with the last of these.
    pub(super) fn into_trace(self, evaluations: u64) -> Trace {
        Trace::of(self.improvements, evaluations.max(self.last))
    }
}

/// Improvements of the best cost and the last evaluation.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Trace {
    pub(super) evaluations: u64,
    pub(super) steps: Vec<ForeignStep>,
}

impl Trace {
    /// Of rows in any order, of a run of so many evaluations. Costs that are not finite are never best.
    pub(super) fn of(mut rows: Vec<ForeignStep>, evaluations: u64) -> Self {
        rows.sort_by(|a, b| a.evaluation.cmp(&b.evaluation).then(a.cost.total_cmp(&b.cost)));
        let last = rows.last().copied();
        let mut best = f64::INFINITY;
        rows.retain(|row| {
            let is_better = row.cost.is_finite() && row.cost < best;
            best = if is_better { row.cost } else { best };
            is_better
        });
        if rows.last().is_some_and(|step| step.evaluation < evaluations) {
            let seconds = last.filter(|last| last.evaluation == evaluations);
            let seconds = seconds.and_then(|last| last.seconds);
            rows.push(ForeignStep { evaluation: evaluations, cost: best, seconds });
        }
        rows.shrink_to_fit();
        Self { evaluations, steps: rows }
    }
}

/// One run as its files have it.
#[derive(Debug)]
pub(super) struct ReadRun {
    pub(super) provenance: Provenance,
    pub(super) optimiser: ForeignOptimiser,
    /// None where the data do not tell it.
    pub(super) seed: Option<u64>,
    /// None where the data do not tell it.
    pub(super) budget: Option<NonZeroU64>,
    /// The least cost known of the instance, if the data tell it.
    pub(super) optimum: Option<f64>,
    pub(super) trace: Trace,
}

/// The runs of an optimiser on an instance that have been read so far.
#[derive(Debug)]
struct Cell {
    seeds: HashSet<u64>,
    /// Whether the data do not tell the seeds, so that runs are numbered.
    are_numbered: bool,
    /// That of the first index that has some.
    folder: PathBuf,
}

/// The runs that have been read so far.
#[derive(Debug, Default)]
pub(super) struct Collected {
    problems: BTreeMap<Provenance, Option<f64>>,
    optimisers: BTreeSet<ForeignOptimiser>,
    runs: Vec<ReadRun>,
    /// The first with each digest: whatever it is called, it is the same instance.
    exported: HashMap<String, Provenance>,
    cells: HashMap<(Provenance, ForeignOptimiser), Cell>,
    rows: usize,
    are_seeds_counted: bool,
}

impl Collected {
    /// Adds a run that a file has, or an index.
    pub(super) fn add(&mut self, mut run: ReadRun, file: &Path) -> Result<(), ImportError> {
        if let Some(digest) = &run.provenance.digest {
            let first = self.exported.entry(digest.clone());
            run.provenance = first.or_insert_with(|| run.provenance.clone()).clone();
        }
        let folder = file.parent().unwrap_or(file);
        let is_numbered = run.seed.is_none();
        let cell = self.cells.entry((run.provenance.clone(), run.optimiser.clone()));
        let cell = cell.or_insert_with(|| Cell {
            seeds: HashSet::new(),
            are_numbered: is_numbered,
            folder: folder.to_owned(),
        });
        let on = || {
            let Provenance { suite, function, name, dimension, instance, digest: _ } =
                &run.provenance;
            let number = |name: &str, n: Option<u64>| n.map(|n| format!(" {name} {n}"));
            let parts = [
                Some(format!(" {suite}")).filter(|_| !suite.is_empty()),
                number("function", function.map(u64::from)),
                Some(format!(" {name}")).filter(|_| !name.is_empty()),
                number("dimension", *dimension),
                number("instance", instance.map(u64::from)),
            ];
            let on: String = parts.into_iter().flatten().collect();
            format!("`{}` on{on}", run.optimiser.name)
        };
        if cell.are_numbered != is_numbered {
            let message = format!(
                "found runs of {} with a seed and without, expected all to have one, or none",
                on()
            );
            return Err(ImportError::of(file, message));
        }
        if is_numbered && cell.folder != folder {
            let message = format!(
                "found runs of {} here and in {}, expected each optimiser's in one folder: import them one at a time",
                on(),
                cell.folder.display()
            );
            return Err(ImportError::of(file, message));
        }
        let (seed, dimension) = (run.seed.unwrap_or(1), run.provenance.dimension.unwrap_or(1));
        let is_within = run.trace.evaluations <= MOST_EVALUATIONS
            && seed <= LARGEST_SEED
            && (1..=MOST_VARIABLES).contains(&dimension);
        if !is_within {
            let message = format!(
                "found {} evaluations of {} with seed {seed}, expected {MOST_EVALUATIONS} at most, seeds below 2^63 and 1 to \
                 {MOST_VARIABLES} variables",
                run.trace.evaluations,
                on()
            );
            return Err(ImportError::of(file, message));
        }
        let allowed = run.trace.evaluations..=MOST_EVALUATIONS;
        if let Some(budget) = run.budget.filter(|budget| !allowed.contains(&budget.get())) {
            let message = format!(
                "found the budget {budget} of {}, expected {} at least, its evaluations, and {MOST_EVALUATIONS} at most",
                on(),
                run.trace.evaluations
            );
            return Err(ImportError::of(file, message));
        }
        self.are_seeds_counted |= is_numbered;
        let seed = run.seed.unwrap_or(cell.seeds.len() as u64 + 1);
        if !cell.seeds.insert(seed) {
            let message = format!("found {} with seed {seed} twice, expected each run once", on());
            return Err(ImportError::of(file, message));
        }
        self.rows += run.trace.steps.len();
        if self.runs.len() == MOST_RUNS || self.rows > MOST_ROWS {
            let message = format!(
                "found more than {MOST_RUNS} runs or {MOST_ROWS} improvements, expected fewer: import them in parts"
            );
            return Err(ImportError::of(file, message));
        }
        let optimum = self.problems.entry(run.provenance.clone()).or_default();
        *optimum = [*optimum, run.optimum].into_iter().flatten().reduce(f64::min);
        self.optimisers.insert(run.optimiser.clone());
        self.runs.push(ReadRun { seed: Some(seed), ..run });
        Ok(())
    }

    /// What all runs come to.
    pub(super) fn import(
        self,
        format: DataFormat,
        data: &Path,
        mut notes: Vec<String>,
    ) -> Result<Import, ImportError> {
        if self.runs.is_empty() {
            return Err(ImportError::of(data, "found no runs, expected at least one"));
        }
        if self.are_seeds_counted {
            notes.push("the data name no seeds, so runs of an instance are numbered".to_owned());
        }
        if self.runs.iter().any(|run| run.budget.is_none()) {
            notes.push(
                "the data name no budget, so it is the most evaluations that the optimiser made on the function and \
                 dimension"
                    .to_owned(),
            );
        }
        let problems: HashMap<&Provenance, usize> =
            self.problems.keys().enumerate().map(|(i, provenance)| (provenance, i)).collect();
        let optimisers: HashMap<&ForeignOptimiser, usize> =
            self.optimisers.iter().enumerate().map(|(i, optimiser)| (optimiser, i)).collect();
        let on = |run: &ReadRun| {
            let provenance = Provenance { instance: None, digest: None, ..run.provenance.clone() };
            (provenance, optimisers[&run.optimiser])
        };
        let mut most = HashMap::new();
        for run in &self.runs {
            let known = most.entry(on(run)).or_insert(NonZeroU64::MIN);
            *known = NonZeroU64::new(run.trace.evaluations).map_or(*known, |own| own.max(*known));
        }
        let run = |run: ReadRun| ForeignRun {
            problem: problems[&run.provenance],
            optimiser: optimisers[&run.optimiser],
            seed: run.seed.unwrap_or_default(),
            budget: run.budget.unwrap_or_else(|| most[&on(&run)]),
            evaluations: run.trace.evaluations,
            trace: run.trace.steps,
        };
        let runs = self.runs.into_iter().map(run).collect();
        let problem = |(provenance, optimum)| ForeignProblem { provenance, optimum };
        let foreign = Foreign {
            format,
            from: name_of(data),
            problems: self.problems.into_iter().map(problem).collect(),
            optimisers: self.optimisers.into_iter().collect(),
            runs,
        };
        Ok(Import { foreign, notes })
    }
}
