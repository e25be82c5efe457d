//! Functions with a known minimum, to try optimisers on.

mod analytic;
#[cfg(feature = "harness")]
mod table;

pub use analytic::{Analytic, TestFunction};
#[cfg(feature = "harness")]
pub use table::Functions;
