//! The `external` table of an `[[optimiser]]` or a `[[problem]]`: a program that searches, or that is searched.

use std::any::Any;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::identity::Identity;
use super::plain::PLAIN;
use super::subject::{Instance, Subject};
use crate::input::{Document, InputError, positive};
use crate::process::{Command, Patience, Program, Solver, Told};
use crate::search::{Failure, Problem};

/// A program, and what it is told.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ExternalTable {
    /// What to call it; the first file's name or, without files, the program's where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    /// Program and arguments.
    command: Spanned<Vec<String>>,
    /// The files that determine what it does; without them the arguments that are files, or else the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    files: Option<Vec<String>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    formulation: Option<String>,
    /// Whether it is spoken with over a loopback socket.
    #[serde(default, skip_serializing_if = "is_false")]
    socket: bool,
    #[serde(default, skip_serializing_if = "timeouts_are_default")]
    timeout: TimeoutTable,
    /// In results: where it was started.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    folder: Option<String>,
    /// In results: the SHA-256 of each file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<BTreeMap<String, String>>,
    /// In results: what problem it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    told: Option<Told>,
    /// What it is told.
    #[serde(default, skip_serializing_if = "toml::Table::is_empty")]
    settings: toml::Table,
}

/// How long the program is waited for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
#[expect(clippy::struct_field_names, reason = "keys of a file with their unit")]
struct TimeoutTable {
    /// Until it is ready \[s\].
    #[serde(deserialize_with = "seconds")]
    start_s: f64,
    /// Between an answer and its next message \[s\].
    #[serde(deserialize_with = "seconds")]
    silence_s: f64,
    /// All of its own time \[s\].
    #[serde(deserialize_with = "some_seconds", skip_serializing_if = "Option::is_none")]
    search_s: Option<f64>,
}

impl Default for TimeoutTable {
    fn default() -> Self {
        let Patience { start, silence, search } = Patience::default();
        Self {
            start_s: start.as_secs_f64(),
            silence_s: silence.as_secs_f64(),
            search_s: search.map(|search| search.as_secs_f64()),
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_false(value: &bool) -> bool {
    !value
}

fn timeouts_are_default(timeout: &TimeoutTable) -> bool {
    *timeout == TimeoutTable::default()
}

/// Seconds that a clock can count.
fn seconds<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let seconds = positive(deserializer)?;
    match Duration::try_from_secs_f64(seconds) {
        Ok(_) => Ok(seconds),
        Err(error) => Err(serde::de::Error::custom(format!("found {seconds} s: {error}"))),
    }
}

fn some_seconds<'de, D: serde::Deserializer<'de>>(d: D) -> Result<Option<f64>, D::Error> {
    seconds(d).map(Some)
}

impl TimeoutTable {
    fn patience(self) -> Patience {
        Patience {
            start: Duration::from_secs_f64(self.start_s),
            silence: Duration::from_secs_f64(self.silence_s),
            search: self.search_s.map(Duration::from_secs_f64),
        }
    }
}

impl ExternalTable {
    /// What is started. Of results the files need not be there.
    fn command(&self, document: &Document) -> Result<Command, InputError> {
        let words = self.command.get_ref().clone();
        let here = document.resolve(".");
        let here = std::path::absolute(&here).unwrap_or(here);
        let command = match (&self.folder, &self.sha256) {
            (Some(folder), Some(files)) => Command::known(words, folder, files.clone()),
            _ => Command::new(words, &here, self.files.as_deref()),
        };
        match command {
            Ok(command) => Ok(command.over_socket(self.socket)),
            Err(error) => Err(document.error_at(self.command.span(), error.to_string(), None)),
        }
    }

    pub(super) fn name(&self, command: &Command) -> String {
        self.name.clone().unwrap_or_else(|| name_of(command))
    }

    /// What it is told, as JSON.
    fn told_settings(&self) -> serde_json::Value {
        serde_json::to_value(&self.settings).unwrap_or_default()
    }

    /// All that determines what it does.
    pub(super) fn identity(&self, command: &Command) -> Identity {
        let files = serde_json::to_value(command.files()).unwrap_or_default();
        Identity::of(serde_json::json!({
            "command": command.words(), "files": files, "settings": self.told_settings(),
        }))
    }

    /// The optimiser that it is.
    pub(super) fn solver(&self, document: &Document) -> Result<Solver, InputError> {
        if self.told.is_some() {
            let message = "found `told` in an optimiser, expected it in a problem only";
            return Err(document.error_at(self.command.span(), message, None));
        }
        let solver = Solver::new(self.command(document)?, self.told_settings())
            .in_formulation(self.formulation.clone());
        Ok(solver.with_patience(self.timeout.patience()))
    }

    /// The subject that it is.
    fn subject(self, document: &Document) -> Result<ExternalProblem, InputError> {
        if self.formulation.is_some() {
            let message = "found a `formulation` of a problem, expected it in an optimiser only";
            return Err(document.error_at(self.command.span(), message, None));
        }
        let command = self.command(document)?;
        let (name, identity) = (self.name(&command), self.identity(&command));
        let told = self.told.clone().map_or_else(OnceLock::new, OnceLock::from);
        // Its processes serve many runs.
        let patience = Patience { search: None, ..self.timeout.patience() };
        let program = Arc::new(Program::new(command, self.told_settings(), patience));
        Ok(ExternalProblem { name, identity, program, told, table: self })
    }

    /// The table as results have it.
    pub(super) fn kept(&self, command: &Command) -> Self {
        Self {
            folder: Some(command.folder().display().to_string()),
            sha256: Some(command.files().clone()),
            ..self.clone()
        }
    }

    /// Whether it is that of results, which may come from anybody.
    pub(super) fn is_kept(&self) -> bool {
        self.folder.is_some()
    }

    /// The settings, as a label has them.
    pub(super) fn settings(&self) -> Vec<String> {
        self.settings.iter().map(|(key, value)| format!("{key}={value}")).collect()
    }
}

/// A `[[problem]]` table with a program.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct ExternalProblemTable {
    /// What to call the instance; the program's name where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    label: Option<String>,
    external: ExternalTable,
}

impl ExternalProblemTable {
    /// The instance.
    pub(super) fn instance(self, document: &Document) -> Result<Instance, InputError> {
        let subject = self.external.subject(document)?;
        let label = self.label.unwrap_or_else(|| subject.name.clone());
        Ok(Instance::new(label, Arc::new(subject)))
    }

    /// As results have it, of an instance that is a program.
    pub(super) fn kept(instance: &Instance) -> Option<Self> {
        let subject = ExternalProblem::of(instance)?;
        let told = subject.told.get().cloned();
        let external = ExternalTable { told, ..subject.table.kept(subject.program.command()) };
        Some(Self { label: Some(instance.label.clone()), external })
    }
}

/// A problem that is a program. Nothing of it is known before the program is asked.
#[derive(Debug)]
pub(super) struct ExternalProblem {
    name: String,
    identity: Identity,
    program: Arc<Program>,
    told: OnceLock<Told>,
    table: ExternalTable,
}

impl ExternalProblem {
    /// The problem of an instance, where it is one.
    pub(super) fn of(instance: &Instance) -> Option<&Self> {
        instance.subject.as_any()?.downcast_ref()
    }

    /// The program, and whether a file of results names it.
    pub(super) fn program(&self) -> (&Command, bool) {
        (self.program.command(), self.table.is_kept())
    }

    /// Where its command stands in the file.
    pub(super) fn place(&self) -> Range<usize> {
        self.table.command.span()
    }

    /// Asks the program what problem it is, unless that is known.
    pub(super) fn ask(&self) -> Result<(), Failure> {
        if self.told.get().is_none() {
            let _ = self.told.set(self.program.ask()?);
        }
        Ok(())
    }
}

impl Subject for ExternalProblem {
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
        let told = self.told.get().ok_or_else(|| {
            Failure::new(format!(
                "nothing is known of `{}` before its program is started, which `driftless run` does",
                self.name
            ))
        })?;
        Ok(Arc::new(self.program.problem(told)?))
    }

    fn dimension(&self) -> usize {
        self.told.get().map_or(1, |told| told.lower.len())
    }

    fn least_cost(&self) -> Option<f64> {
        self.told.get().and_then(|told| told.least_cost)
    }

    fn start_cost(&self) -> f64 {
        self.told.get().map_or(f64::NAN, |told| told.start_cost)
    }

    fn as_any(&self) -> Option<&dyn Any> {
        Some(self)
    }
}

/// The name of the first word that is one of its files, or of the program.
fn name_of(command: &Command) -> String {
    let words = command.words();
    let script = words.iter().find(|word| command.files().contains_key(*word));
    let word = script.unwrap_or(&words[0]);
    let stem = Path::new(word).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    stem.unwrap_or_else(|| word.clone())
}
