//! The task in experiment files: its keys `task`, `trajectory` and `sweep`.

use std::sync::Arc;

use super::keys::{Sweep, TaskKeys};
use super::settings::DEFAULTS;
use super::subject::{KIND, SPACES};
use super::sweep;
use crate::experiment::{Instance, Kind, Source};
use crate::input::{Document, InputError};
use crate::robot::RobotFile;

/// The reorientation task. What an experiment file leaves out is the paper's.
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
        let keys: TaskKeys = document.parse_keys(self.keys(), &[DEFAULTS])?;
        Ok(Arc::new(keys))
    }
}

impl Source for TaskKeys {
    fn instances(&self, document: &Document) -> Result<Vec<Instance>, InputError> {
        sweep::instances(self, document)
    }

    fn written(&self) -> Result<String, String> {
        toml::to_string(self).map_err(|error| error.to_string())
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
        const ROBOT: &str = "robot.toml";
        let Some(path) = self.task.robot_file(document) else { return Ok(None) };
        let robot = RobotFile::read(&Document::read(&path)?)?;
        let text = toml::to_string(&robot).map_err(|error| {
            document.error_at(0..0, format!("cannot keep the robot: {error}"), None)
        })?;
        let keys = Self { task: self.task.clone().with_robot(ROBOT), ..self.clone() };
        Ok(Some((Arc::new(keys), vec![(ROBOT.to_owned(), text)])))
    }
}
