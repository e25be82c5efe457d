//! The task in experiment files: its keys `task`, `trajectory` and `sweep`.

use std::sync::Arc;

use super::bases;
use super::keys::{Sweep, TaskKeys, WrittenKeys};
use super::subject::{KIND, SPACES};
use super::sweep;
use crate::experiment::{Instance, Kind, Source};
use crate::input::{Document, InputError};

/// The reorientation task. What an experiment file leaves out is that of its robot's own task.
#[derive(Debug, Clone, Copy, Default)]
pub struct ReorientationTask;

impl Kind for ReorientationTask {
    fn name(&self) -> &'static str {
        KIND
    }

    fn keys(&self) -> &'static [&'static str] {
        &["task", "trajectory", "sweep"]
    }

    fn spaces(&self) -> &'static [&'static str] {
        &SPACES
    }

    fn read(&self, document: &Document) -> Result<Arc<dyn Source>, InputError> {
        Ok(Arc::new(TaskKeys::read(self.keys(), document)?))
    }
}

impl Source for TaskKeys {
    fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
        sweep::instances(self, document)
    }

    fn count(&self) -> u64 {
        self.sweep.count()
    }

    fn written(&self) -> Result<String, String> {
        // Robots of a sweep that come with a task each have their own where the file states nothing.
        let stated = (!self.sweep.robot.is_empty()).then(|| self.task.stated());
        let task = self.sweep.task.is_empty().then(|| stated.as_ref().unwrap_or(&self.task));
        let written = WrittenKeys { task, trajectory: &self.trajectory, sweep: &self.sweep };
        toml::to_string(&written).map_err(|error| error.to_string())
    }

    fn sets_budgets(&self) -> bool {
        !self.sweep.budget.is_empty()
    }

    fn without_budgets(&self) -> Option<Arc<dyn Source>> {
        let sweep = Sweep { budget: Vec::new(), ..self.sweep.clone() };
        self.sets_budgets().then(|| Arc::new(Self { sweep, ..self.clone() }) as Arc<dyn Source>)
    }

    fn kept(
        &self,
        document: &Document,
    ) -> Result<Option<(Arc<dyn Source>, Vec<(String, String)>)>, InputError> {
        let (keys, files) = bases::kept(self, document)?;
        Ok((!files.is_empty()).then(|| (Arc::new(keys) as Arc<dyn Source>, files)))
    }
}
