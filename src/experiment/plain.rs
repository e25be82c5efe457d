//! A problem as it is, as a subject.

use std::sync::Arc;

use serde_json::Value;

use super::subject::{Instance, Subject, Unavailable};
use crate::search::Problem;

/// A problem of somebody's own in its own variables.
struct Plain {
    name: String,
    identity: Value,
    problem: Arc<dyn Problem>,
}

impl Instance {
    /// An instance on a problem of one's own, with the name as label. `identity` is all that determines its costs,
    /// a version of its code included: see [`Subject::identity`].
    pub fn of_problem(
        name: &str,
        identity: impl Into<Value>,
        problem: impl Problem + 'static,
    ) -> Self {
        let (identity, problem) = (identity.into(), Arc::new(problem));
        Self::new(name, Arc::new(Plain { name: name.to_owned(), identity, problem }))
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
