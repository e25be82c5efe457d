//! Tasks, and planning their motions.

use std::path::Path;

use driftless::input::{Document, nearest};
use driftless::optimiser::Settings;
use driftless::reorientation::{
    Asked, FamilyChoice, FamilyName, Planner, TaskFile, TaskProblem, TaskSubject,
};
use driftless::search::Watch;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::errors::{self, OrRaise as _};
use crate::motion::Motion;
use crate::problem::{Origin, Problem};
use crate::watched::watched;

/// A task: robot, start, goal, limits, weights, and the family of motions that is searched.
#[pyclass(module = "driftless._driftless", frozen)]
pub(crate) struct Task {
    document: Document,
    file: TaskFile,
    problem: TaskProblem,
}

/// The document of a text, which names files from `path`.
pub(crate) fn document(path: &str, text: &str) -> Document {
    Document::embedded(path, text)
}

impl Task {
    /// The task as experiments have it.
    pub(crate) fn subject(&self) -> TaskSubject {
        self.problem.clone().into()
    }
}

#[pymethods]
impl Task {
    #[new]
    fn new(path: &str, text: &str) -> PyResult<Self> {
        let document = document(path, text);
        let file = TaskFile::read(&document).or_raise()?;
        let problem = file.problem(&document).or_raise()?;
        Ok(Self { document, file, problem })
    }

    #[staticmethod]
    fn read(path: &str) -> PyResult<Self> {
        let document = Document::read(Path::new(path)).or_raise()?;
        Self::new(path, document.text())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, (String, &str)) {
        (py.get_type::<Self>(), (self.path(), self.text()))
    }

    #[getter]
    fn path(&self) -> String {
        self.document.path.display().to_string()
    }

    #[getter]
    fn text(&self) -> &str {
        self.document.text()
    }

    #[getter]
    fn robot(&self) -> &str {
        self.problem.task().robot.name()
    }

    #[getter]
    fn joints(&self) -> Vec<String> {
        self.problem.task().robot.joints().map(|joint| joint.name.to_owned()).collect()
    }

    /// `[[lower, upper], …]` \[rad\].
    #[getter]
    fn ranges(&self) -> Vec<[f64; 2]> {
        self.problem.task().robot.joints().map(|joint| joint.range).collect()
    }

    /// `[[rate, acceleration, jerk], …]` \[rad/s, rad/s², rad/s³\].
    #[getter]
    fn limits(&self) -> Vec<[f64; 3]> {
        self.problem.task().limits.0.clone()
    }

    fn to_toml(&self) -> PyResult<String> {
        let file = self.file.clone().resolved(&self.problem);
        toml::to_string(&file).map_err(|error| errors::usage(&error.to_string()))
    }

    fn formulations(&self) -> Vec<String> {
        use driftless::experiment::Subject as _;
        self.subject().spaces()
    }

    fn problem(&self, formulation: &str) -> PyResult<Problem> {
        let origin = Origin::Task { path: self.path(), text: self.text().to_owned() };
        Problem::new(self.subject().into_instance(self.robot()), formulation, origin)
    }

    /// The motion with these coefficients, in `duration` seconds or the shortest time within the limits.
    fn motion(&self, coefficients: Vec<f64>, duration: Option<f64>) -> PyResult<Motion> {
        let problem = self.subject().reorientation().shared();
        if coefficients.len() != problem.dimension() {
            let (found, expected) = (coefficients.len(), problem.dimension());
            let message = format!("found {found} coefficients, expected {expected}");
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let source = (self.path(), self.text().to_owned());
        Ok(Motion::assessed(problem, coefficients, duration, Some(source)))
    }
}

fn family(name: &str) -> PyResult<FamilyName> {
    let all = [FamilyName::Spline, FamilyName::SinePolynomial];
    let found = all.into_iter().find(|family| family.name() == name);
    found.ok_or_else(|| {
        let message = format!("found family {name:?}, expected \"spline\" or \"sine-polynomial\"");
        errors::usage(&message)
    })
}

/// An optimiser of the catalogue with its default settings.
fn optimiser(name: &str) -> PyResult<Settings> {
    Settings::by_name(name).ok_or_else(|| {
        let all = Settings::all();
        let known: Vec<&str> = all.iter().map(Settings::name).collect();
        let hint = nearest(name, known.iter().copied());
        let hint = hint.map_or_else(String::new, |near| format!("; did you mean {near:?}?"));
        let known = known.join(", ");
        errors::usage(&format!("found no optimiser {name:?}, expected one of {known}{hint}"))
    })
}

/// Raises an error unless there is an optimiser of this name in the catalogue.
#[pyfunction]
pub(crate) fn check_optimiser(name: &str) -> PyResult<()> {
    optimiser(name).map(drop)
}

/// Plans the motion of a task.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python calls it with keywords")]
pub(crate) fn plan(
    py: Python<'_>,
    task: &Task,
    by: &str,
    seed: u64,
    budget: u64,
    family_name: Option<&str>,
    pieces: Option<usize>,
    degree: Option<usize>,
    progress: &Bound<'_, PyAny>,
) -> PyResult<Motion> {
    let settings = optimiser(by)?;
    let family = family_name.map(family).transpose()?;
    let choice = FamilyChoice { family, pieces, degree };
    let planner = Planner::read(&task.document, choice, settings).or_raise()?;
    if planner.is_mission() {
        let message = "this is a task of several motions, which the command's `plan` takes";
        return Err(errors::usage(message));
    }
    if let Some(residual) = planner.task().already_there() {
        return Err(errors::already_there(format!(
            "there is nothing to plan: all joints stand at their goals, and the base is {:.6}° from its goal",
            residual.to_degrees()
        )));
    }
    let watch = Watch::default();
    let tick = |_: Python<'_>| progress.call1((watch.evaluations(),)).map(drop);
    let found = watched(py, &watch, || planner.plan(seed, budget, &watch), tick)?;
    let found = found.or_raise()?;
    let json = found.json(Asked {
        task: task.path(),
        inherited: planner.file().task.inherited(),
        optimiser: by,
        seed,
    });
    let json = serde_json::to_value(&json).unwrap_or_default();
    let remark = found.remark(budget).or_else(|| found.overlap());
    let text = toml::to_string(planner.file());
    let text = text.map_err(|error| errors::usage(&error.to_string()))?;
    Ok(Motion::planned(found, json, remark, (task.path(), text)))
}
