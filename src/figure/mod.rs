//! How charts are drawn: panels of marks on a sheet of millimetres, written as SVG, PNG and PDF.

pub(crate) mod axis;
mod error;
#[expect(clippy::module_inception, reason = "the main type of the module")]
mod figure;
pub(crate) mod marks;
pub(crate) mod panel;
pub(crate) mod sheet;
pub(crate) mod style;

pub use error::FigureError;
pub use figure::Figure;
#[cfg(test)]
pub(crate) use figure::png;
