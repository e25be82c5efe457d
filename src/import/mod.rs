//! Runs of other programs, from the files of other tools: one file per format. What they come to is
//! [`Foreign`], which a folder of results is made of.

mod bbob;
mod coco;
mod collected;
mod error;
mod files;
mod ioh;
mod lines;
mod long;

use std::path::Path;

use crate::experiment::{DataFormat, Foreign};

pub use error::ImportError;

/// What was read, and what there is to say of it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Import {
    /// The runs.
    pub foreign: Foreign,
    /// What was not in the data and had to be worked out, one sentence each.
    pub notes: Vec<String>,
}

/// Reads a folder of data, or the one file that they are.
pub fn read(format: DataFormat, data: &Path) -> Result<Import, ImportError> {
    match format {
        DataFormat::Ioh => ioh::read(data),
        DataFormat::Coco => coco::read(data),
        DataFormat::Csv => long::read(data),
    }
}
