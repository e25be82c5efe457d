//! Folders of results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use driftless::exhibit::Table;
use driftless::experiment::{Folder, Instance, Kind as _, Run, Subject as _, standing};
use driftless::registry;
use driftless::reorientation::{ReorientationTask, TaskSubject};
use driftless::report::{self, Target};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors::{self, OrRaise as _};
use crate::motion::Motion;
use crate::task::Task;

/// A folder of results as it was when it was opened.
#[pyclass(module = "driftless._driftless", frozen)]
pub(crate) struct Results {
    folder: Folder,
    tables: OnceLock<Vec<Table>>,
}

impl Results {
    pub(crate) fn new(folder: Folder) -> Self {
        Self { folder, tables: OnceLock::new() }
    }

    /// Whether the folder is still there.
    fn check(&self) -> PyResult<()> {
        if self.folder.experiment_file().is_file() {
            return Ok(());
        }
        let path = self.folder.path().display();
        Err(errors::results(format!(
            "the results in {path} are gone: found no experiment.toml there"
        )))
    }

    /// The instance of a label. The only one of an experiment has none, and may be called by its robot.
    fn instance(&self, label: &str) -> PyResult<&Instance> {
        let all = &self.folder.plan.instances;
        let is_robot = |only: &Instance| {
            let task = TaskSubject::of(only).map(|task| task.reorientation().task());
            task.is_some_and(|task| task.robot.name() == label)
        };
        let found = all.iter().find(|instance| instance.label == label);
        let found = found.or_else(|| all.first().filter(|only| all.len() == 1 && is_robot(only)));
        found.ok_or_else(|| {
            let labels: Vec<String> = all.iter().map(|i| format!("{:?}", i.label)).collect();
            let expected = labels.join(", ");
            PyKeyError::new_err(format!("found no instance {label:?}, expected one of {expected}"))
        })
    }

    /// The task of an instance.
    fn subject<'a>(
        &self,
        of: &'a Instance,
        given: Option<&'a TaskSubject>,
    ) -> PyResult<&'a TaskSubject> {
        let label = &of.label;
        if let Some(given) = given {
            if given.identity().to_string() == of.subject.identity().to_string() {
                return Ok(given);
            }
            return Err(errors::usage(&format!("found another task than that of {label:?}")));
        }
        TaskSubject::of(of).ok_or_else(|| {
            if of.subject.kind() == ReorientationTask.name() {
                return PyKeyError::new_err(format!(
                    "these results do not hold the task of {label:?}: pass it, as in `motion({label:?}, task)`"
                ));
            }
            let all = self.folder.plan.instances.iter();
            let tasks = all.filter(|one| one.subject.kind() == ReorientationTask.name());
            let tasks: Vec<String> = tasks.map(|task| format!("{:?}", task.label)).collect();
            let tasks = match tasks.as_slice() {
                [] => String::new(),
                tasks => format!("; tasks are {}", tasks.join(", ")),
            };
            PyKeyError::new_err(format!("{label:?} is no task, and has no motion{tasks}"))
        })
    }

    fn tables(&self, py: Python<'_>) -> PyResult<&[Table]> {
        self.check()?;
        if let Some(tables) = self.tables.get() {
            return Ok(tables);
        }
        let folder = &self.folder;
        let tables = py.detach(|| report::tables(&folder.plan, &[&folder.store]));
        let tables = tables.or_raise()?;
        Ok(self.tables.get_or_init(|| tables))
    }
}

#[pymethods]
impl Results {
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let folder = py.detach(|| Folder::open(&path, &registry()));
        Ok(Self::new(folder.or_raise()?))
    }

    #[getter]
    fn path(&self) -> &Path {
        self.folder.path()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.folder.plan.name
    }

    #[getter]
    fn instances(&self) -> Vec<&str> {
        self.folder.plan.instances.iter().map(|instance| &*instance.label).collect()
    }

    #[getter]
    fn optimisers(&self) -> Vec<&str> {
        self.folder.plan.optimisers.iter().map(|entrant| &*entrant.label).collect()
    }

    /// Planned, stored and failed runs.
    #[getter]
    fn counts(&self, py: Python<'_>) -> PyResult<[usize; 3]> {
        self.check()?;
        let planned = self.folder.plan.runs.len();
        let found = py.detach(|| standing(&self.folder.plan, &self.folder.store));
        let failed = found.or_raise()?.failures.len();
        let missing = self.folder.missing(None).or_raise()?.len();
        Ok([planned, planned - missing, failed])
    }

    /// What is wrong with stored files, of those that have been read.
    #[getter]
    fn damage(&self) -> Vec<String> {
        self.folder.store.damaged().iter().map(ToString::to_string).collect()
    }

    fn captions(&self, py: Python<'_>) -> PyResult<BTreeMap<String, String>> {
        let tables = self.tables(py)?.iter();
        Ok(tables.map(|table| (table.name().to_owned(), table.caption().to_owned())).collect())
    }

    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.tables(py)?.iter().map(|table| table.name().to_owned()).collect())
    }

    /// A table as a Parquet file.
    fn table<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let Some(table) = self.tables(py)?.iter().find(|table| table.name() == name) else {
            return Ok(None);
        };
        let bytes = py.detach(|| table.parquet()).map_err(errors::results)?;
        Ok(Some(PyBytes::new(py, &bytes)))
    }

    fn report<'py>(
        &self,
        py: Python<'py>,
        out: Option<PathBuf>,
        replace: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        self.check()?;
        let folder = &self.folder;
        let report = py.detach(|| {
            let results = folder.path();
            let mut target = Target::of_all(vec![results], out.as_deref().unwrap_or(results));
            if replace {
                target = target.replacing();
            }
            report::write(&folder.plan, &folder.store, &target)
        });
        let report = report.or_raise()?;
        let dict = PyDict::new(py);
        dict.set_item("page", &report.page)?;
        dict.set_item("summary", &report.summary)?;
        dict.set_item("kept", report.kept)?;
        let findings = report.findings.iter().map(|f| (f.question.clone(), f.answer.clone()));
        dict.set_item("findings", findings.collect::<Vec<_>>())?;
        Ok(dict)
    }

    /// The best motion of an instance that is a task: its own, or where that is not stored the one given.
    fn motion(&self, py: Python<'_>, label: &str, task: Option<&Task>) -> PyResult<Py<PyAny>> {
        self.check()?;
        let plan = &self.folder.plan;
        let instance = self.instance(label)?;
        let given = task.map(Task::subject);
        let task = self.subject(instance, given.as_ref())?;
        let runs = py.detach(|| driftless::experiment::load(plan, &self.folder.store));
        let runs = runs.or_raise()?;
        let results = plan.results(&runs);
        let best = results.best_runs_with_points().into_iter();
        let of = |run: &&Run| results.instance(run).label == instance.label;
        let found = best.into_iter().find(of).and_then(|run| {
            let space = results.space(run);
            let duration = (space != "time-free").then(|| run.x.last().copied()).flatten();
            Some((task.coefficients(&space, &run.x)?, duration))
        });
        let Some((coefficients, duration)) = found else {
            let message = format!("found no motion of {label:?}: no run has found any");
            return Err(PyKeyError::new_err(message));
        };
        let problem = task.reorientation().shared();
        Motion::assessed(problem, coefficients, duration, None).shown(py)
    }
}
