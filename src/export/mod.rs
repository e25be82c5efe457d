//! The runs of an experiment in formats that other tools read.

mod coco;
mod ioh;
mod suite;

use std::path::Path;

use crate::output::{FileError, write_folder};
pub use suite::{Algorithm, ExportedRun, Function, Objective, Suite, SuiteError};

/// A format for the runs of an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SuiteFormat {
    /// IOHprofiler, read by iohinspector.
    Ioh,
    /// COCO, read by cocopp.
    Coco,
}

/// Writes the runs of an experiment into a folder of their own, whole or not at all.
pub fn write_suite(folder: &Path, format: SuiteFormat, suite: &Suite) -> Result<(), SuiteError> {
    write_folder(folder, |folder| match format {
        SuiteFormat::Ioh => ioh::write(suite, folder),
        SuiteFormat::Coco => coco::write(suite, folder),
    })
}

/// Writes a file of a folder that is renamed when all are written.
fn write_plain(path: &Path, text: &str) -> Result<(), FileError> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    std::fs::write(path, text).map_err(error)
}
