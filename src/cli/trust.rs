//! Programs that files of results name, which may come from anybody: those that the user lets start, and has let start before.

use std::collections::BTreeSet;
use std::fs;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use super::CliError;
use crate::digest::sha256;
use crate::experiment::{Experiment, Folder};
use crate::output::folder_of;
use crate::process::Command;

/// Says which programs an experiment starts. Those that a file of results names are started only where the user says so, by
/// `--trust`, now or once before. Whether `--trust` has to be given again.
pub(super) fn tell_programs(
    experiment: &Experiment,
    file: Option<&Path>,
    is_trusted: bool,
) -> Result<bool, CliError> {
    // A file need not say where it comes from.
    let mut is_from_results = file.map(folder_of).is_some_and(Folder::has_runs);
    let (mut told, mut identities) = (BTreeSet::new(), BTreeSet::new());
    for (command, is_kept) in experiment.programs() {
        is_from_results |= is_kept;
        let words = shell_words::join(command.words());
        told.insert(format!("`{words}` in {}", command.folder().display()));
        identities.insert(identity_of(command));
    }
    for program in &told {
        note!("note: this experiment starts {program}");
    }
    // Of a command without files, such as a module of an interpreter, it is not known what it starts.
    let is_known = experiment.programs().all(|(command, _)| !command.files().is_empty());
    let digest = sha256(identities.into_iter().collect::<String>().as_bytes());
    if told.is_empty() || !is_from_results || is_known && is_remembered(&digest) {
        return Ok(false);
    }
    if is_trusted || confirmed("Start what these results name? [y/N] ") {
        if !is_known {
            note!("note: this is not remembered, as some of these programs name no files");
        } else if let Err(error) = remember(&digest) {
            note!("warning: this cannot be remembered: {error}");
        }
        return Ok(!is_known);
    }
    Err(CliError::Usage {
        message: "these programs are named by a file of results, which may come from anybody"
            .to_owned(),
        help: Some("look at them, and pass --trust to start them".to_owned()),
    })
}

/// All that determines which program a command starts.
fn identity_of(command: &Command) -> String {
    let folder = command.folder().display();
    format!("{:?} {folder} {:?}\n", command.words(), command.files())
}

/// The file of what was trusted, in no folder that may come from others.
fn memory() -> Option<PathBuf> {
    let state = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from).filter(|p| p.is_absolute());
    let home = || Some(std::env::home_dir()?.join(".local/state"));
    Some(state.or_else(home)?.join("driftless").join("trusted"))
}

fn is_remembered(digest: &str) -> bool {
    let text = memory().and_then(|path| fs::read_to_string(path).ok()).unwrap_or_default();
    text.lines().any(|line| line == digest)
}

/// Remembers what was trusted.
fn remember(digest: &str) -> std::io::Result<()> {
    let path = memory().ok_or_else(|| std::io::Error::other("found no home folder"))?;
    let written = fs::create_dir_all(folder_of(&path)).and_then(|()| {
        let mut file = fs::OpenOptions::new().append(true).create(true).open(&path)?;
        // In one piece, as others may do the same.
        file.write_all(format!("{digest}\n").as_bytes())
    });
    written.map_err(|error| std::io::Error::other(format!("{}: {error}", path.display())))
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
