//! A problem as it is, as a subject.

use std::sync::Arc;

use super::identity::Identity;
use super::subject::{Instance, Subject};
use crate::search::{Failure, Problem};

/// The kind of such subjects, which show nothing of their own.
pub(super) const PLAIN: &str = "problem";

/// A problem of somebody's own in its own variables.
struct Plain {
    name: String,
    identity: Identity,
    problem: Arc<dyn Problem>,
}

impl Instance {
    /// An instance on a problem of one's own, with the name as label. `identity` is all that determines its costs,
    /// a version of its code included: see [`Subject::identity`].
    pub fn of_problem(name: &str, identity: Identity, problem: impl Problem + 'static) -> Self {
        let problem = Arc::new(problem);
        Self::new(name, Arc::new(Plain { name: name.to_owned(), identity, problem }))
    }
}

impl Subject for Plain {
    fn kind(&self) -> &'static str {
        PLAIN
    }

    fn name(&self) -> &str {
        &self.name
    }

    fn identity(&self) -> Identity {
        self.identity.clone()
    }

    fn problem(&self, _: &str) -> Result<Arc<dyn Problem>, Failure> {
        Ok(self.problem.clone())
    }
}
