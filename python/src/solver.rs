//! Optimisers and problems that are functions in Python.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use driftless::optimiser::Optimiser;
use driftless::search::{Bounds, Evaluation, Failure, Points, Problem, Rng, Stop, Watch};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use crate::arrays;
use crate::oracle::{Desk, Oracle};

/// How often a run looks whether it is interrupted.
const TICK: Duration = Duration::from_millis(100);

/// How long a solver may go on after its search is over.
const GRACE: Duration = Duration::from_secs(10);

/// An optimiser that is a function `f(oracle, rng, **settings)`.
pub(crate) struct PythonOptimiser {
    pub(crate) function: Py<PyAny>,
    pub(crate) settings: Py<PyDict>,
    pub(crate) formulation: Option<String>,
    pub(crate) needs_derivatives: bool,
}

/// How a solver has ended.
pub(crate) enum Ended {
    /// It returned, or raised an exception, which is told.
    Returned(Result<(), String>),
    /// It goes on although its search is over.
    WentOn,
}

/// What a solver's thread calls when it has ended.
#[pyclass(frozen)]
struct Tell(Sender<Ended>);

#[pymethods]
impl Tell {
    fn __call__(&self, py: Python<'_>, error: Option<&Bound<'_, PyAny>>) {
        let ended = error.map_or(Ok(()), |error| Err(told(py, &PyErr::from_value(error.clone()))));
        // The run may have gone on without its solver.
        let _ = self.0.send(Ended::Returned(ended));
    }
}

impl PythonOptimiser {
    /// Calls the function in a thread of Python's, which can be left behind when Python ends.
    fn start(&self, desk: &Arc<Desk>, seed: u64, sender: Sender<Ended>) -> Result<(), Failure> {
        Python::attach(|py| {
            let start = || -> PyResult<()> {
                let oracle = Py::new(py, Oracle(desk.clone()))?;
                let rng = py.import("numpy.random")?.call_method1("default_rng", (seed,))?;
                let tell = Py::new(py, Tell(sender))?;
                let arguments = (&self.function, oracle, rng, &self.settings, tell);
                py.import("driftless._solver")?.call_method1("start", arguments)?;
                Ok(())
            };
            start().map_err(|error| Failure::new(told(py, &error)))
        })
    }
}

/// Waits for a solver to end; what it told, unless it is left behind.
fn wait(desk: &Desk, receiver: &Receiver<Ended>) -> Option<Result<(), String>> {
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(Ended::Returned(ended)) => return Some(ended),
            Ok(Ended::WentOn) | Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => {
                desk.look_for_interruption();
                if desk.over_for().is_some_and(|time| time > GRACE) {
                    break;
                }
            }
        }
    }
    desk.leave();
    None
}

impl Optimiser for PythonOptimiser {
    fn minimise(
        &self,
        oracle: &mut driftless::search::Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<(), Stop> {
        let (sender, receiver) = channel();
        let desk = Arc::new(Desk::new(oracle, sender.clone()));
        let seed = rng.seed();
        let returned = desk.open(oracle, || -> Result<_, Failure> {
            self.start(&desk, seed, sender)?;
            Ok(wait(&desk, &receiver))
        })?;
        let (stop, outside) = desk.outcome();
        oracle.remark_outside(outside);
        if returned.is_none() {
            let remark = "the solver went on after its search was over, and was left behind";
            oracle.remark(remark.to_owned());
        }
        match (stop, returned) {
            (Some(stop), _) => Err(stop),
            (None, Some(Err(told))) => Err(Failure::new(told).into()),
            (None, Some(Ok(()))) => Ok(()),
            (None, None) => Err(Failure::new("the solver's thread ended without a word").into()),
        }
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }

    fn needs_derivatives(&self) -> bool {
        self.needs_derivatives
    }
}

/// A problem that is a function of a point or of many.
pub(crate) struct PythonProblem {
    pub(crate) function: Py<PyAny>,
    /// Whether the function takes many points, one per row.
    pub(crate) is_batched: bool,
    pub(crate) bounds: Bounds,
    pub(crate) least_cost: Option<f64>,
    /// True once the user wants the experiment to end.
    pub(crate) interrupted: Mutex<Arc<AtomicBool>>,
}

/// A number, or a cost and a violation.
fn evaluation(answer: &Bound<'_, PyAny>) -> Result<Evaluation, Failure> {
    if let Ok(cost) = answer.extract::<f64>() {
        return Ok(cost.into());
    }
    let pair = answer.cast::<PyTuple>().ok().and_then(|pair| pair.extract::<(f64, f64)>().ok());
    pair.map(|(cost, violation)| Evaluation::new(cost, violation)).ok_or_else(|| {
        let kind = answer.get_type().name();
        let kind = kind.map_or_else(|_| "something".to_owned(), |kind| kind.to_string());
        Failure::new(format!("the problem returned {kind}, expected a number or (cost, violation)"))
    })
}

impl PythonProblem {
    fn all(&self, py: Python<'_>, points: &Points) -> Result<Vec<Evaluation>, Failure> {
        let failed = |error: PyErr| Failure::new(told(py, &error));
        let numbers = points.iter().flatten().copied().collect();
        let x = arrays::matrix(py, points.len(), points.dimension(), numbers).map_err(failed)?;
        let answer = self.function.bind(py).call1((x,)).map_err(failed)?;
        let column = |part: &Bound<'_, PyAny>, what| {
            let numbers = arrays::point(part, points.len());
            numbers.map_err(|error| {
                Failure::new(format!("the problem returned no {what}: {}", error.value(py)))
            })
        };
        match answer.cast::<PyTuple>() {
            Ok(pair) if pair.len() == 2 => {
                let [costs, violations] = [(0, "costs"), (1, "violations")]
                    .map(|(k, what)| column(&pair.get_item(k).map_err(failed)?, what));
                let both = costs?.into_iter().zip(violations?);
                Ok(both.map(|(cost, violation)| Evaluation::new(cost, violation)).collect())
            }
            _ => Ok(column(&answer, "costs")?.into_iter().map(Evaluation::from).collect()),
        }
    }
}

impl Problem for PythonProblem {
    fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        Python::attach(|py| {
            if self.is_batched {
                let mut points = Points::zeros(x.len(), 1);
                points[0].copy_from_slice(x);
                return self.all(py, &points).map(|found| found[0]);
            }
            let answer = self.function.bind(py).call1((arrays::vector(py, x.to_vec()),));
            evaluation(&answer.map_err(|error| Failure::new(told(py, &error)))?)
        })
    }

    fn evaluate_batch(
        &self,
        points: &Points,
        each: &mut dyn FnMut(Evaluation),
    ) -> Result<(), Failure> {
        if self.is_batched {
            let found = Python::attach(|py| self.all(py, points))?;
            found.into_iter().for_each(each);
            return Ok(());
        }
        let interrupted = self.interrupted.lock().unwrap_or_else(PoisonError::into_inner).clone();
        points.iter().try_for_each(|x| {
            if interrupted.load(Ordering::Relaxed) {
                return Err(Failure::new("interrupted"));
            }
            each(self.evaluate(x)?);
            Ok(())
        })
    }

    fn prepare(&self, watch: &Watch) {
        *self.interrupted.lock().unwrap_or_else(PoisonError::into_inner) = watch.flag();
    }

    fn least_cost(&self) -> Option<f64> {
        self.least_cost
    }
}

/// An exception in a line: its class, its message, and where it was raised.
fn told(py: Python<'_>, error: &PyErr) -> String {
    let name = error.get_type(py).name();
    let name = name.map_or_else(|_| "an exception".to_owned(), |name| name.to_string());
    let message = error.value(py).str().map_or_else(|_| String::new(), |text| text.to_string());
    let colon = if message.is_empty() { "" } else { ": " };
    let place = place(py, error).map_or_else(String::new, |place| format!(" ({place})"));
    format!("{name}{colon}{message}{place}")
}

/// File and line of the innermost frame.
fn place(py: Python<'_>, error: &PyErr) -> Option<String> {
    let mut frame = error.traceback(py)?.into_any();
    while let Some(next) = frame.getattr("tb_next").ok().filter(|next| !next.is_none()) {
        frame = next;
    }
    let line: u32 = frame.getattr("tb_lineno").ok()?.extract().ok()?;
    let code = frame.getattr("tb_frame").ok()?.getattr("f_code").ok()?;
    let file = code.getattr("co_filename").ok()?;
    let file = file.cast::<PyString>().ok()?.to_string();
    let name = file.rsplit(['/', '\\']).next().unwrap_or(&file);
    Some(format!("{name}, line {line}"))
}
