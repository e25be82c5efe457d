//! The extension module of the Python package `driftless`: what of the library Python calls. The package around it, which users see, is
//! Python and stands beside this crate, in `driftless/`.

mod arrays;
mod errors;
mod experiment;
mod json;
mod motion;
mod oracle;
mod problem;
mod results;
mod solver;
mod task;
mod watched;

use pyo3::prelude::*;

/// The compiled part of `driftless`.
#[pymodule]
mod _driftless {
    use super::{Bound, PyModule, PyModuleMethods as _, PyResult};

    #[pymodule_export]
    use crate::command;
    #[pymodule_export]
    use crate::experiment::{Experiment, problems};
    #[pymodule_export]
    use crate::motion::Motion;
    #[pymodule_export]
    use crate::oracle::Oracle;
    #[pymodule_export]
    use crate::problem::{Linearisation, Problem, Term};
    #[pymodule_export]
    use crate::results::Results;
    #[pymodule_export]
    use crate::task::{Task, check_optimiser, plan};
    #[pymodule_export]
    use crate::watched::end;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// The command `driftless`; its exit status.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| driftless::cli::main_with(arguments))
}
