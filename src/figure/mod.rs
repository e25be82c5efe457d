//! How charts are drawn: panels of marks on a sheet of millimetres, written as SVG, PNG and PDF.

pub(crate) mod axis;
mod error;
#[expect(clippy::module_inception, reason = "the main type of the module")]
mod figure;
pub(crate) mod marks;
pub(crate) mod panel;
pub(crate) mod sheet;
#[cfg(test)]
pub(crate) mod stored_pictures;
pub(crate) mod style;
pub(crate) mod text;

pub(crate) use error::FigureError;
pub(crate) use figure::Figure;
