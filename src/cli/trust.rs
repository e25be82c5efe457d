//! Programs that files of results name, which may come from anybody: those that the user lets start, and has let start before.

use std::fs;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use super::CliError;
use crate::digest::sha256;
use crate::experiment::{Experiment, Folder};
use crate::output::folder_of;
use crate::process::Command;

/// Says which programs an experiment starts. Those that a file of results names are started only where the user says so, by
/// `--trust`, now or once before. Whether there are any.
pub(super) fn tell_programs(
    experiment: &Experiment,
    file: Option<&Path>,
    is_trusted: bool,
) -> Result<bool, CliError> {
    let mut told = Vec::new();
    let mut identity = String::new();
    // A file need not say where it comes from.
    let mut is_from_results = file.map(folder_of).is_some_and(Folder::has_runs);
    for (command, is_kept) in experiment.programs() {
        is_from_results |= is_kept;
        let program = format!("`{command}` in {}", command.folder().display());
        if !told.contains(&program) {
            identity += &identity_of(command);
            told.push(program);
        }
    }
    for program in &told {
        note!("note: this experiment starts {program}");
    }
    let digest = sha256(identity.as_bytes());
    if told.is_empty() || !is_from_results || is_remembered(&digest) {
        return Ok(!told.is_empty());
    }
    if is_trusted || confirmed("Start what these results name? [y/N] ") {
        remember(&digest);
        return Ok(true);
    }
    Err(CliError::Usage {
        message: "these programs are named by a file of results, which may come from anybody"
            .to_owned(),
        help: Some("look at them, and pass --trust to start them".to_owned()),
    })
}

/// All that determines what a command starts.
fn identity_of(command: &Command) -> String {
    format!("{:?} {:?} {:?}\n", command.words(), command.folder(), command.files())
}

/// Where it stands what was trusted, in no folder that may come from others.
fn memory() -> Option<PathBuf> {
    let state = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from).filter(|p| p.is_absolute());
    let home = || Some(std::env::home_dir()?.join(".local/state"));
    Some(state.or_else(home)?.join("driftless").join("trusted"))
}

fn is_remembered(digest: &str) -> bool {
    let text = memory().and_then(|path| fs::read_to_string(path).ok()).unwrap_or_default();
    text.lines().any(|line| line == digest)
}

/// Remembers what was trusted; where that cannot be written, the user is asked again.
fn remember(digest: &str) {
    let Some(path) = memory() else { return };
    let _ = fs::create_dir_all(folder_of(&path));
    let file = fs::OpenOptions::new().append(true).create(true).open(path);
    let _ = file.and_then(|mut file| writeln!(file, "{digest}"));
}

/// Asks the user, where there is one.
fn confirmed(question: &str) -> bool {
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return false;
    }
    let mut line = String::new();
    let mut errors = std::io::stderr();
    let asked = errors.write_all(question.as_bytes()).and_then(|()| errors.flush());
    asked.and_then(|()| std::io::stdin().read_line(&mut line)).is_ok()
        && ["y", "yes"].contains(&line.trim().to_lowercase().as_str())
}
