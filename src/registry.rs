//! The kinds of subjects that come with this crate.

use std::sync::Arc;

use crate::experiment::Registry;
use crate::functions::Functions;
use crate::reorientation::ReorientationTask;

/// The reorientation task, which an experiment file is on unless it says otherwise, and test functions.
pub fn registry() -> Registry {
    Registry::new().with(Arc::new(ReorientationTask)).with(Arc::new(Functions))
}
