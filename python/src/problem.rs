//! Problems that Python asks.

use std::sync::Arc;

use driftless::experiment::Instance;
use driftless::reorientation::TaskSubject;
use driftless::search::{Evaluation, Oracle, Points, Shape, Stop, Watch};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays;
use crate::errors::{self, OrRaise as _, Raised as _};
use crate::motion::Motion;

/// Points of a batch between two looks for Ctrl-C.
const CHUNK: usize = 16_384;

/// Where a problem comes from, for `pickle`.
#[derive(Clone)]
pub(crate) enum Origin {
    /// A task's document and a formulation.
    Task { path: String, text: String },
    /// An experiment's document and the number of an instance.
    Experiment { path: String, text: String, instance: usize },
}

/// A cost to minimise in a box.
///
/// `Task.problem`, `functions` and `problems` make problems. Calls beyond the box cost infinitely much, as they do in a run; so does NaN.
#[pyclass(module = "driftless", frozen)]
pub(crate) struct Problem {
    asked: Arc<dyn driftless::search::Problem>,
    instance: Instance,
    space: String,
    origin: Origin,
}

impl Problem {
    pub(crate) fn new(instance: Instance, space: &str, origin: Origin) -> PyResult<Self> {
        let spaces = instance.subject.spaces();
        let space =
            if space.is_empty() { spaces.first().map_or("", String::as_str) } else { space };
        if !(spaces.is_empty() && space.is_empty() || spaces.iter().any(|own| own == space)) {
            let expected = if spaces.is_empty() {
                "none, since it has but one".to_owned()
            } else {
                format!("one of {}", spaces.join(", "))
            };
            return Err(errors::usage(&format!(
                "found formulation {space:?}, expected {expected}"
            )));
        }
        let asked = instance.subject.problem(space).or_raise()?;
        let space = space.to_owned();
        Ok(Self { asked, instance, space, origin })
    }

    /// What it is in a race, under a label.
    pub(crate) fn labelled(&self, label: &str) -> Instance {
        if label == self.instance.label {
            return self.instance.clone();
        }
        let Instance { subject, targets, budget, .. } = self.instance.clone();
        let mut instance = Instance::new(label, subject).with_targets(targets);
        instance.budget = budget;
        instance
    }

    fn dimension(&self) -> usize {
        self.asked.bounds().len()
    }

    fn at(&self, x: &Bound<'_, PyAny>) -> PyResult<Evaluation> {
        let mut x = arrays::point(x, self.dimension())?;
        if !self.asked.bounds().snap(&mut x) {
            return Ok(Evaluation::new(f64::INFINITY, f64::INFINITY));
        }
        self.asked.evaluate(&x).or_raise()
    }

    fn at_all(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Vec<Evaluation>> {
        let points = arrays::points(x, self.dimension())?;
        let mut found = Vec::with_capacity(points.len());
        if points.len() <= CHUNK {
            py.detach(|| self.at_part(points, &mut found)).or_raise()?;
            return Ok(found);
        }
        for begin in (0..points.len()).step_by(CHUNK) {
            let part = cut(&points, begin, CHUNK.min(points.len() - begin));
            py.detach(|| self.at_part(part, &mut found)).or_raise()?;
            py.check_signals()?;
        }
        Ok(found)
    }

    fn at_part(&self, mut points: Points, found: &mut Vec<Evaluation>) -> Result<(), Stop> {
        let bounds = self.asked.bounds();
        if points.iter_mut().all(|x| bounds.snap(x)) {
            return Ok(self.asked.evaluate_batch(&points, &mut |one| found.push(one))?);
        }
        let watch = Watch::default();
        Oracle::new(&*self.asked, points.len() as u64, &watch).evaluate_anywhere(points, found).1
    }

    /// A point within the box, where alone there are derivatives.
    fn inside(&self, x: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        inside(self.asked.bounds(), x)
    }
}

/// A point within a box.
pub(crate) fn inside(
    bounds: &driftless::search::Bounds,
    x: &Bound<'_, PyAny>,
) -> PyResult<Vec<f64>> {
    let mut x = arrays::point(x, bounds.len())?;
    if bounds.snap(&mut x) {
        return Ok(x);
    }
    let places = bounds.iter().zip(&x).enumerate();
    let mut outside = places.filter(|(_, ([lower, upper], x))| !(lower..=upper).contains(x));
    let told = outside.next().map(|(k, ([lower, upper], x))| {
        format!("found x[{k}] = {x}, expected {lower} to {upper}: there are derivatives within the box alone")
    });
    Err(pyo3::exceptions::PyValueError::new_err(told.unwrap_or_default()))
}

fn cut(points: &Points, begin: usize, count: usize) -> Points {
    let mut part = Points::zeros(points.dimension(), count);
    (0..count).for_each(|i| part[i].copy_from_slice(&points[begin + i]));
    part
}

/// Costs and violations.
pub(crate) type Pair = (Py<PyArray1<f64>>, Py<PyArray1<f64>>);

/// Costs and violations of some points as arrays.
pub(crate) fn both(py: Python<'_>, found: &[Evaluation]) -> Pair {
    let costs = found.iter().map(|found| found.cost).collect();
    let violations = found.iter().map(|found| found.violation).collect();
    (arrays::vector(py, costs).unbind(), arrays::vector(py, violations).unbind())
}

#[pymethods]
impl Problem {
    /// What it is called.
    #[getter]
    fn name(&self) -> &str {
        self.instance.subject.name()
    }

    /// What tells it from others of its experiment; empty where there is but one.
    #[getter]
    fn label(&self) -> &str {
        &self.instance.label
    }

    /// The variables that it is searched in, where there are several.
    #[getter]
    fn formulation(&self) -> Option<&str> {
        Some(&*self.space).filter(|space| !space.is_empty())
    }

    /// The number of variables, n.
    #[getter(dimension)]
    fn get_dimension(&self) -> usize {
        self.dimension()
    }

    /// Lower bounds, shape (n,).
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::walls(py, self.asked.bounds(), 0)
    }

    /// Upper bounds, shape (n,).
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::walls(py, self.asked.bounds(), 1)
    }

    /// The least cost that anybody has found.
    #[getter]
    fn best_known(&self) -> Option<f64> {
        self.instance.subject.known_cost()
    }

    /// Whether there are subgradients.
    #[getter]
    fn has_subgradient(&self) -> bool {
        self.asked.slopes().is_some()
    }

    /// Whether the cost is a sum of terms with smooth pieces.
    #[getter]
    fn has_linearise(&self) -> bool {
        self.asked.composite().is_some()
    }

    /// The cost of a point, shape (n,).
    fn __call__(&self, x: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.at(x)?.cost)
    }

    /// By how much a point violates limits; zero within.
    fn violation(&self, x: &Bound<'_, PyAny>) -> PyResult<f64> {
        Ok(self.at(x)?.violation)
    }

    /// Cost and violation of a point.
    fn evaluate(&self, x: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let found = self.at(x)?;
        Ok((found.cost, found.violation))
    }

    /// Costs of points, shape (m, n) to shape (m,). Other threads of Python run meanwhile.
    fn batch<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.at_all(py, x)?;
        Ok(arrays::vector(py, found.into_iter().map(|found| found.cost).collect()))
    }

    /// Costs and violations of points, shape (m, n) to shape (m,) each.
    fn evaluate_batch(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Pair> {
        Ok(both(py, &self.at_all(py, x)?))
    }

    /// The cost of a point within the box, with a subgradient, shape (n,).
    ///
    /// Raises
    /// ------
    /// NoDerivatives
    ///     There are none.
    fn subgradient<'py>(
        &self,
        py: Python<'py>,
        x: &Bound<'py, PyAny>,
    ) -> PyResult<(f64, Bound<'py, PyArray1<f64>>)> {
        let x = self.inside(x)?;
        let slopes = self.asked.slopes().ok_or_else(|| Stop::NoDerivatives.raised())?;
        let found = slopes.at(&x).or_raise()?;
        Ok((found.evaluation.cost, arrays::vector(py, found.slopes.as_slice().to_vec())))
    }

    /// The cost of a point within the box as a sum of terms.
    ///
    /// Raises
    /// ------
    /// NoDerivatives
    ///     The cost is no such sum.
    fn linearise(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Linearisation> {
        let x = self.inside(x)?;
        let composite = self.asked.composite().ok_or_else(|| Stop::NoDerivatives.raised())?;
        let found = composite.linearise(&x).or_raise()?;
        Linearisation::of(py, &found, x.len())
    }

    /// Seconds that the library takes for all points, one by one or as a batch, without Python: what benchmarks compare with.
    fn _native_seconds(
        &self,
        py: Python<'_>,
        x: &Bound<'_, PyAny>,
        is_batch: bool,
    ) -> PyResult<f64> {
        let points = arrays::points(x, self.dimension())?;
        py.detach(|| {
            let mut sum = 0.0;
            let clock = std::time::Instant::now();
            if is_batch {
                self.asked.evaluate_batch(&points, &mut |found| sum += found.cost)?;
            } else {
                for x in &points {
                    sum += self.asked.evaluate(x)?.cost;
                }
            }
            let seconds = clock.elapsed().as_secs_f64();
            std::hint::black_box(sum);
            Ok(seconds)
        })
        .map_err(|failure: driftless::search::Failure| failure.raised())
    }

    /// Where the task that it is stands, and its text; none of other problems.
    #[getter]
    fn _file(&self) -> Option<(&str, &str)> {
        match &self.origin {
            Origin::Task { path, text } => Some((path, text)),
            Origin::Experiment { .. } => None,
        }
    }

    /// Whether its variables are those that its subject is searched in unless an optimiser asks for others.
    #[getter]
    fn _is_preferred(&self) -> bool {
        self.instance.space(None) == self.space
    }

    /// The motion that a point stands for, evaluated finely. Of tasks alone.
    fn motion(&self, py: Python<'_>, x: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        let x = arrays::point(x, self.dimension())?;
        if let Some(k) = x.iter().position(|x| !x.is_finite()) {
            let message = format!("found x[{k}] = {}, expected a number", x[k]);
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let task = TaskSubject::of(&self.instance)
            .ok_or_else(|| errors::usage("the problem is no task, so its points are no motions"))?;
        let coefficients = task.coefficients(&self.space, &x).unwrap_or_default();
        let duration = (self.space != "time-free").then(|| x.last().copied()).flatten();
        if let Some(duration) = duration.filter(|duration| *duration <= 0.0) {
            let message = format!("found a duration of {duration} s, expected one above zero");
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        let source = match &self.origin {
            Origin::Task { path, text } => Some((path.clone(), text.clone())),
            Origin::Experiment { .. } => None,
        };
        Motion::assessed(task.reorientation().shared(), coefficients, duration, source).shown(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let restore = py.import("driftless._restore")?;
        match &self.origin {
            Origin::Task { path, text } => {
                let arguments = (path, text, &self.space);
                (restore.getattr("task_problem")?, arguments).into_pyobject(py)
            }
            Origin::Experiment { path, text, instance } => {
                let arguments = (path, text, instance, &self.space);
                (restore.getattr("experiment_problem")?, arguments).into_pyobject(py)
            }
        }
    }

    fn __repr__(&self) -> String {
        let label = if self.label().is_empty() { self.name() } else { self.label() };
        let formulation = self.formulation().map_or_else(String::new, |own| format!(", {own}"));
        format!("<driftless.Problem {label}{formulation}, {} variables>", self.dimension())
    }
}

/// Terms of a cost at a point, with values and slopes of their smooth pieces.
#[pyclass(module = "driftless", frozen, get_all)]
pub(crate) struct Linearisation {
    /// The sum of the terms.
    cost: f64,
    /// The terms.
    terms: Vec<Py<Term>>,
}

/// One term of a cost: a weight times a convex function of smooth pieces.
#[pyclass(module = "driftless", frozen, get_all)]
pub(crate) struct Term {
    /// The weight.
    weight: f64,
    /// The convex function: ``"norm"``, ``"max"``, or ``"hinge"``, which is the sum of what is above zero.
    shape: &'static str,
    /// What the convex function never falls below.
    floor: f64,
    /// What tells pieces from each other at different points, k numbers.
    tracks: Vec<u64>,
    /// Where on its track each piece is, shape (k,).
    places: Py<PyArray1<f64>>,
    /// Values of the pieces, shape (k,).
    values: Py<PyArray1<f64>>,
    /// Gradients of the pieces, shape (k, n).
    gradients: Py<PyArray2<f64>>,
}

impl Linearisation {
    pub(crate) fn of(
        py: Python<'_>,
        found: &driftless::search::Linearisation,
        dimension: usize,
    ) -> PyResult<Self> {
        let terms = found.terms.iter().map(|term| Py::new(py, Term::of(py, term, dimension)?));
        Ok(Self { cost: found.cost(), terms: terms.collect::<PyResult<_>>()? })
    }
}

impl Term {
    fn of(py: Python<'_>, term: &driftless::search::Term, dimension: usize) -> PyResult<Self> {
        let shape = match term.shape {
            Shape::Norm => "norm",
            Shape::Max => "max",
            Shape::Hinge => "hinge",
        };
        let pieces = || term.pieces.iter();
        let gradients = pieces().flat_map(|piece| piece.gradient.iter().copied()).collect();
        Ok(Self {
            weight: term.weight,
            shape,
            floor: term.floor,
            tracks: pieces().map(|piece| piece.id.track).collect(),
            places: arrays::vector(py, pieces().map(|piece| piece.id.place).collect()).unbind(),
            values: arrays::vector(py, pieces().map(|piece| piece.value).collect()).unbind(),
            gradients: arrays::matrix(py, term.pieces.len(), dimension, gradients)?.unbind(),
        })
    }
}

#[pymethods]
impl Linearisation {
    fn __repr__(&self) -> String {
        format!("<driftless.Linearisation cost {}, {} terms>", self.cost, self.terms.len())
    }
}

#[pymethods]
impl Term {
    fn __repr__(&self) -> String {
        format!("<driftless.Term {} × {} of {} pieces>", self.weight, self.shape, self.tracks.len())
    }
}
