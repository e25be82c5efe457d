//! Experiments: read, entered into, run.

use std::num::NonZeroU64;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use driftless::experiment::{
    Again, Entrant, FOUND_NOTHING, Folder, Identity, Instance, Options, Plan, Progress, Record,
    RunSpec, Value,
};
use driftless::input::Document;
use driftless::registry;
use driftless::search::{Bounds, Watch};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors::{self, OrRaise as _};
use crate::problem::{Origin, Problem};
use crate::results::Results;
use crate::solver::{PythonOptimiser, PythonProblem};
use crate::task::document;
use crate::watched::watched;

type Read = driftless::experiment::Experiment;

/// An experiment, which optimisers and problems are entered into.
#[pyclass(module = "driftless._driftless", frozen)]
pub(crate) struct Experiment {
    experiment: Read,
    /// The file that it was read from.
    file: Option<PathBuf>,
}

/// Values of an identity.
fn identity(values: &Bound<'_, PyDict>) -> PyResult<Identity> {
    let mut identity = Identity::new();
    for (name, value) in values {
        let name: String = name.extract()?;
        let value = if value.is_none() {
            Value::None
        } else if let Ok(count) = value.extract::<u64>() {
            Value::from(count)
        } else if let Ok(number) = value.extract::<f64>() {
            Value::from(number)
        } else {
            Value::from(value.str()?.to_string())
        };
        identity = identity.with(&name, value);
    }
    Ok(identity)
}

fn count(number: u64, what: &str) -> PyResult<NonZeroU64> {
    NonZeroU64::new(number).ok_or_else(|| {
        pyo3::exceptions::PyValueError::new_err(format!("found {what} = 0, expected 1 or more"))
    })
}

/// A run that has ended: optimiser, instance, seed, what was found, and what was wrong.
type Line = (String, String, u64, String, String);

/// What is told of runs while they are done.
#[derive(Default)]
struct Told(Mutex<Vec<Line>>);

struct Teller<'a> {
    told: &'a Told,
    plan: &'a Plan,
}

impl Progress for Teller<'_> {
    fn finished(&self, run: &RunSpec, record: &Record) {
        let (optimiser, instance) =
            (&self.plan.optimisers[run.optimiser], &self.plan.instances[run.instance]);
        let found = match record.cost {
            cost if cost.is_finite() => {
                let (symbol, text) =
                    (instance.subject.cost_symbol(), instance.subject.cost_text(cost));
                format!("{symbol} {text}, {}", record.status.name())
            }
            _ => format!("nothing found, {}", record.status.name()),
        };
        let message = match &*record.message {
            "" if !record.cost.is_finite() => FOUND_NOTHING.to_owned(),
            message => message.to_owned(),
        };
        let line = (optimiser.label.clone(), instance.label.clone(), run.seed, found, message);
        if let Ok(mut told) = self.told.0.lock() {
            told.push(line);
        }
    }
}

impl Experiment {
    /// What the same file has become.
    fn changed(&self, experiment: Read) -> Self {
        Self { experiment, file: self.file.clone() }
    }
}

#[pymethods]
impl Experiment {
    /// Reads a file, which need not have optimisers.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let document = Document::read(&path).or_raise()?;
        let has_field = document.key("optimiser").or_raise()?.is_some();
        let document = if has_field {
            document
        } else {
            let text = format!("{}\n[[optimiser]]\nrandom = {{}}\n", document.text());
            Document::embedded(&path.display().to_string(), &text)
        };
        let experiment = Read::read(&document, &registry()).or_raise()?;
        let experiment = if has_field { experiment } else { experiment.without_optimisers() };
        Ok(Self { experiment, file: Some(path) })
    }

    #[staticmethod]
    fn parse(path: &str, text: &str) -> PyResult<Self> {
        let document = document(path, text);
        let experiment = Read::read(&document, &registry()).or_raise()?;
        Ok(Self { experiment, file: None })
    }

    #[new]
    fn new(name: &str) -> PyResult<Self> {
        let experiment = Read::new(name).or_raise()?;
        Ok(Self { experiment, file: None })
    }

    #[getter]
    fn name(&self) -> &str {
        self.experiment.name()
    }

    #[getter]
    fn imported(&self) -> Option<String> {
        self.experiment.imported()
    }

    /// The programs that it starts, in words, and whether a file of results names them.
    #[getter]
    fn programs(&self) -> Vec<(String, bool)> {
        let is_from_results = self
            .file
            .as_deref()
            .is_some_and(|file| Folder::has_runs(file.parent().unwrap_or(Path::new(""))));
        let told = self.experiment.programs().map(|(command, is_kept)| {
            let words = format!("`{command}` in {}", command.folder().display());
            (words, is_kept || is_from_results)
        });
        told.collect()
    }

    fn with_seeds(&self, seeds: u64) -> PyResult<Self> {
        Ok(self.changed(self.experiment.clone().with_seeds(count(seeds, "seeds")?)))
    }

    fn with_budget(&self, evaluations: u64) -> PyResult<Self> {
        Ok(self.changed(self.experiment.clone().with_budget(count(evaluations, "budget")?)))
    }

    fn without_optimisers(&self) -> Self {
        self.changed(self.experiment.clone().without_optimisers())
    }

    fn with_optimisers_of(&self, other: &Self) -> Self {
        self.changed(self.experiment.clone().with_optimisers_of(&other.experiment))
    }

    #[expect(clippy::too_many_arguments, reason = "Python calls it with keywords")]
    fn with_optimiser(
        &self,
        name: &str,
        label: Option<&str>,
        identity_of: &Bound<'_, PyDict>,
        function: Py<PyAny>,
        settings: Py<PyDict>,
        formulation: Option<String>,
        needs_derivatives: bool,
        seeds: Option<u64>,
        budget: Option<u64>,
    ) -> PyResult<Self> {
        let optimiser = PythonOptimiser { function, settings, formulation, needs_derivatives };
        let mut entrant = Entrant::new(name, identity(identity_of)?, optimiser);
        if let Some(label) = label {
            entrant = entrant.labelled(label);
        }
        entrant.seeds = seeds.map(|seeds| count(seeds, "seeds")).transpose()?;
        entrant.budget = budget.map(|budget| count(budget, "budget")).transpose()?;
        Ok(self.changed(self.experiment.clone().with_optimiser(entrant)))
    }

    #[expect(clippy::too_many_arguments, reason = "Python calls it with keywords")]
    fn with_function(
        &self,
        name: &str,
        identity_of: &Bound<'_, PyDict>,
        function: Py<PyAny>,
        is_batched: bool,
        lower: Vec<f64>,
        upper: Vec<f64>,
        least_cost: Option<f64>,
        targets: Vec<f64>,
    ) -> PyResult<Self> {
        let pairs = lower.into_iter().zip(upper).map(|(lower, upper)| [lower, upper]).collect();
        let bounds = Bounds::new(pairs).or_raise()?;
        let interrupted = Mutex::default();
        let problem = PythonProblem { function, is_batched, bounds, least_cost, interrupted };
        let instance = Instance::of_problem(name, identity(identity_of)?, problem);
        Ok(self.changed(self.experiment.clone().with_instance(instance.with_targets(targets))))
    }

    fn with_problem(&self, problem: &Problem, label: &str) -> Self {
        self.changed(self.experiment.clone().with_instance(problem.labelled(label)))
    }

    /// Does what is missing; `tick(evaluations, runs)` is called all along, `runs` being those that have ended since.
    fn run(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        jobs: Option<usize>,
        again: Option<&str>,
        begin: &Bound<'_, PyAny>,
        tick: &Bound<'_, PyAny>,
    ) -> PyResult<Results> {
        let watch = Watch::default();
        // On a thread of its own, too: problems that are functions are asked here, and Ctrl-C is not for them.
        let ready = || -> PyResult<Folder> {
            self.experiment.ask_programs().or_raise()?;
            let plan = self.experiment.plan().or_raise()?;
            if plan.optimisers.is_empty() {
                return Err(errors::usage("found no optimiser, expected at least one"));
            }
            let path = out.unwrap_or_else(|| Path::new("results").join(&plan.name));
            plan.check_possible(&path).or_raise()?;
            let folder = Folder::create(&path, plan).or_raise()?;
            let again = match again {
                Some("all") => Some(Again::All),
                Some("failed") => Some(Again::Failed),
                _ => None,
            };
            if let Some(again) = again {
                folder.forget(&folder.runs(None), again, &|| ()).or_raise()?;
            }
            Ok(folder)
        };
        let folder = watched(py, &watch, ready, |_| Ok(()))??;
        let missing = py.detach(|| folder.missing(None)).or_raise()?;
        let evaluations: u64 = missing.iter().map(|run| run.budget).sum();
        begin.call1((folder.path(), missing.len(), folder.plan.runs.len(), evaluations))?;
        let told = Told::default();
        let tell = |_: Python<'_>| {
            let lines = told.0.lock().map(|mut told| std::mem::take(&mut *told));
            tick.call1((watch.evaluations(), lines.unwrap_or_default())).map(drop)
        };
        let options = jobs.map_or_else(Options::default, |jobs| Options::default().with_jobs(jobs));
        let teller = Teller { told: &told, plan: &folder.plan };
        let work = || folder.run(options, &watch, &teller);
        watched(py, &watch, work, tell)?.or_raise()?;
        Ok(Results::new(folder))
    }
}

/// The problems of an experiment's instances.
#[pyfunction]
pub(crate) fn problems<'py>(
    py: Python<'py>,
    path: &str,
    text: &str,
    formulation: &str,
) -> PyResult<Bound<'py, PyList>> {
    let document = document(path, text);
    let plan = Read::read(&document, &registry()).and_then(|experiment| experiment.plan());
    let plan = plan.or_raise()?;
    let problem = |(instance, of): (usize, &Instance)| {
        let origin = Origin::Experiment { path: path.to_owned(), text: text.to_owned(), instance };
        Py::new(py, Problem::new(of.clone(), formulation, origin)?)
    };
    let all = plan.instances.iter().enumerate().map(problem);
    PyList::new(py, all.collect::<PyResult<Vec<_>>>()?)
}
