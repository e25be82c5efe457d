//! A problem as it is, as a subject.

use std::sync::Arc;

use serde_json::Value;

use super::subject::{Subject, Unavailable};
use crate::search::Problem;

/// A problem of somebody's own in its own variables.
pub(super) struct Plain {
    name: String,
    identity: Value,
    problem: Arc<dyn Problem>,
}

impl Plain {
    pub(super) fn new(name: &str, identity: Value, problem: Arc<dyn Problem>) -> Self {
        Self { name: name.to_owned(), identity, problem }
    }
}

impl Subject for Plain {
    fn kind(&self) -> &'static str {
        "problem"
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> Value {
        self.identity.clone()
    }

    fn problem(&self, _: &str) -> Result<Arc<dyn Problem>, Unavailable> {
        Ok(self.problem.clone())
    }
}
