//! The library's errors as Python's exceptions, which are classes of `driftless/_errors.py`.

use driftless::experiment::{FolderError, RunError, StoreError};
use driftless::input::InputError;
use driftless::reorientation::{ExportError, PlanError};
use driftless::report::ReportError;
use driftless::search::{BoundsError, Failure, Stop};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

const MODULE: &str = "driftless._errors";

/// An exception of the package.
fn exception(name: &'static str, cell: &'static PyOnceLock<Py<PyType>>, message: String) -> PyErr {
    Python::attach(|py| match cell.import(py, MODULE, name) {
        Ok(class) => PyErr::from_type(class.clone(), message),
        Err(error) => error,
    })
}

macro_rules! exceptions {
    ($($function:ident $name:literal;)*) => {$(
        pub(crate) fn $function(message: impl ToString) -> PyErr {
            static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
            exception($name, &CLASS, message.to_string())
        }
    )*};
}

exceptions! {
    results "ResultsError";
    search "SearchError";
    already_there "AlreadyThere";
    no_derivatives "NoDerivatives";
    closed "RunEnded";
    budget_spent "BudgetSpent";
    interrupted "Interrupted";
}

/// An input error, with its place.
pub(crate) fn input(error: &InputError) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let made = Python::attach(|py| {
        let class = CLASS.import(py, MODULE, "InputError")?;
        let (file, place, message, hint) = match error {
            InputError::Content(mistake) => (
                mistake.path.display().to_string(),
                mistake.line_and_column(),
                mistake.message.clone(),
                mistake.help.clone(),
            ),
            InputError::Read { path, source } => {
                let file = path.display().to_string();
                (file, None, format!("cannot be read: {source}"), None)
            }
            other => (String::new(), None, other.to_string(), None),
        };
        let (line, column) = place.unzip();
        Ok::<_, PyErr>(PyErr::from_value(class.call1((message, file, line, column, hint))?))
    });
    made.unwrap_or_else(|error| error)
}

/// An input error that is about no file.
pub(crate) fn usage(message: &str) -> PyErr {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let made = Python::attach(|py| {
        let class = CLASS.import(py, MODULE, "InputError")?;
        Ok::<_, PyErr>(PyErr::from_value(class.call1((message,))?))
    });
    made.unwrap_or_else(|error| error)
}

/// A library error that Python knows by an exception.
pub(crate) trait Raised {
    fn raised(self) -> PyErr;
}

/// The value, or the exception.
pub(crate) trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

impl<T, E: Raised> OrRaise<T> for Result<T, E> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(Raised::raised)
    }
}

impl Raised for InputError {
    fn raised(self) -> PyErr {
        input(&self)
    }
}

impl Raised for BoundsError {
    fn raised(self) -> PyErr {
        usage(&self.to_string())
    }
}

impl Raised for Failure {
    fn raised(self) -> PyErr {
        search(self)
    }
}

impl Raised for Stop {
    fn raised(self) -> PyErr {
        match self {
            Self::BudgetSpent => budget_spent("every evaluation of the budget is spent"),
            Self::Interrupted => interrupted("the experiment is interrupted"),
            Self::NoDerivatives => no_derivatives("the problem has no derivatives of this kind"),
            Self::Failed(failure) => failure.raised(),
        }
    }
}

impl Raised for PlanError {
    fn raised(self) -> PyErr {
        match self {
            Self::Input(error) => error.raised(),
            Self::ForSplines(choice) => {
                usage(&format!("found `{choice}`, which is for family=\"spline\" alone"))
            }
            Self::Interrupted => pyo3::exceptions::PyKeyboardInterrupt::new_err(()),
            other => search(other),
        }
    }
}

impl Raised for FolderError {
    fn raised(self) -> PyErr {
        match self {
            Self::Input(error) => error.raised(),
            other => results(other),
        }
    }
}

impl Raised for ExportError {
    fn raised(self) -> PyErr {
        results(told(&self))
    }
}

impl Raised for StoreError {
    fn raised(self) -> PyErr {
        results(told(&self))
    }
}

impl Raised for RunError {
    fn raised(self) -> PyErr {
        results(told(&self))
    }
}

impl Raised for ReportError {
    fn raised(self) -> PyErr {
        results(told(&self))
    }
}

/// An error with what caused it, in one line.
fn told(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let told = error.to_string();
        if !text.ends_with(&told) {
            text = format!("{text}: {told}");
        }
        cause = error.source();
    }
    text
}
