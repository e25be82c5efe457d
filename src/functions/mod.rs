//! Functions with a known minimum, to try optimisers on.

mod analytic;
#[cfg(feature = "harness")]
mod table;

pub use analytic::{Analytic, TestFunction};
#[cfg(feature = "harness")]
pub(crate) use table::DEFAULTS;
#[cfg(feature = "harness")]
pub use table::{Dimension, FunctionTable};
