//! An optimiser that is a process.

use serde_json::Value;

use super::command::{Command, Patience};
use super::conversation::Conversation;
use super::session::{Session, opening};
use crate::optimiser::Optimiser;
use crate::search::{Oracle, Rng, Stop};

/// An optimiser that is a process of its own: each run starts it, and asks the oracle what it asks.
#[derive(Debug, Clone)]
pub struct Solver {
    command: Command,
    settings: Value,
    formulation: Option<String>,
    patience: Patience,
}

impl Solver {
    /// A command that speaks the protocol, and the settings that it is told, a JSON object.
    pub fn new(command: Command, settings: Value) -> Self {
        Self { command, settings, formulation: None, patience: Patience::default() }
    }

    /// The same in the variables of a formulation.
    #[must_use]
    pub fn in_formulation(self, formulation: Option<String>) -> Self {
        Self { formulation, ..self }
    }

    /// The same with other deadlines.
    #[must_use]
    pub fn with_patience(self, patience: Patience) -> Self {
        Self { patience, ..self }
    }

    /// What is started.
    pub fn command(&self) -> &Command {
        &self.command
    }
}

impl Optimiser for Solver {
    fn minimise(&self, oracle: &mut Oracle<'_>, rng: &mut Rng) -> Result<(), Stop> {
        let opening = opening(oracle, rng, &self.settings);
        self.command.check_files()?;
        let mut process =
            Conversation::open(&self.command, self.patience, "before it was done", opening)?;
        let mut session = Session::new(&mut process);
        let outcome = session.run(oracle);
        // A run of a program that was edited meanwhile is none of the one that the experiment names.
        let outcome = match outcome {
            Err(Stop::Interrupted) => outcome,
            _ => self.command.check_files().map_err(Stop::from).and(outcome),
        };
        session.tell_end(&outcome);
        process.close();
        outcome
    }

    fn formulation(&self) -> Option<&str> {
        self.formulation.as_deref()
    }
}
