//! What is started, and what determines what it does.

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::digest::sha256;
use crate::search::Failure;

/// A program with its arguments, and the files that determine what it does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Command {
    /// Program and arguments.
    words: Vec<String>,
    /// Where it is started, and where relative paths begin.
    folder: PathBuf,
    /// The SHA-256 of each file, by its name.
    files: BTreeMap<String, String>,
    /// Whether it is spoken with over a socket.
    has_socket: bool,
}

/// How long a process is waited for; the time that this side takes does not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// Until it says `hello`.
    pub start: Duration,
    /// Between an answer and its next message.
    pub silence: Duration,
    /// All of its own time after `hello`; `None` for no limit.
    pub search: Option<Duration>,
}

impl Default for Patience {
    fn default() -> Self {
        Self { start: Duration::from_mins(1), silence: Duration::from_mins(1), search: None }
    }
}

/// A command that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// There is no program.
    #[error("found an empty command, expected a program and its arguments")]
    Empty,
    /// A file that determines what it does cannot be read.
    #[error("cannot read {}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What came of it.
        source: std::io::Error,
    },
}

impl Command {
    /// Program and arguments, started in `folder`. Where no files are named they are the arguments that are files there, such as a
    /// script, or else the program.
    pub fn new(
        words: Vec<String>,
        folder: &Path,
        files: Option<&[String]>,
    ) -> Result<Self, CommandError> {
        check(&words)?;
        let named = match files {
            Some(files) => files.to_vec(),
            None => scripts(&words, folder),
        };
        let digest = |name: String| {
            let path = folder.join(&name);
            match digest_of(&path) {
                Ok(digest) => Ok((name, digest)),
                Err(source) => Err(CommandError::File { path, source }),
            }
        };
        let files = named.into_iter().map(digest).collect::<Result<_, _>>()?;
        Ok(Self { words, folder: folder.to_owned(), files, has_socket: false })
    }

    /// One whose files are known by their digests, whether they are still there or not.
    pub fn known(
        words: Vec<String>,
        folder: &str,
        files: BTreeMap<String, String>,
    ) -> Result<Self, CommandError> {
        check(&words)?;
        Ok(Self { words, folder: folder.into(), files, has_socket: false })
    }

    /// The same, spoken with over a loopback socket and not over its standard streams.
    #[must_use]
    pub fn over_socket(self, has_socket: bool) -> Self {
        Self { has_socket, ..self }
    }

    /// Whether it is spoken with over a socket.
    pub(super) fn has_socket(&self) -> bool {
        self.has_socket
    }

    /// Program and arguments.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// Where it is started.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The SHA-256 of each file, by its name.
    pub fn files(&self) -> &BTreeMap<String, String> {
        &self.files
    }

    /// Whether there is such a program: in the folder, where its name has a separator, else in the search path.
    pub fn check_program(&self) -> Result<(), Failure> {
        let program = Path::new(&self.words[0]);
        if program.components().count() > 1 {
            return found_program(&self.folder.join(program));
        }
        // Elsewhere names have endings that the system adds.
        if cfg!(not(unix)) || is_on_path(&self.words[0]) {
            return Ok(());
        }
        Err(format!("found no program `{}` in the search path", self.words[0]).into())
    }

    /// Whether the files are what they were when the command was made.
    pub(crate) fn check_files(&self) -> Result<(), Failure> {
        for (name, digest) in &self.files {
            let path = self.folder.join(name);
            let found = digest_of(&path);
            let path = path.display();
            match found {
                Err(error) => return Err(format!("cannot read {path}: {error}").into()),
                Ok(found) if found != *digest => {
                    let told =
                        format!("{path} is not what it was when the experiment was first read");
                    return Err(told.into());
                }
                Ok(_) => {}
            }
        }
        Ok(())
    }

    /// The program as the system is asked for it. One with a separator in its name is sought in the folder, others in the search
    /// path.
    pub(super) fn to_std(&self) -> std::process::Command {
        let program = Path::new(&self.words[0]);
        let is_path = program.components().count() > 1;
        let mut command = if is_path {
            std::process::Command::new(self.folder.join(program))
        } else {
            std::process::Command::new(program)
        };
        command.args(&self.words[1..]).current_dir(&self.folder);
        command
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words.join(" "))
    }
}

/// Whether the search path has such a program.
pub(crate) fn is_on_path(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| found_program(&folder.join(program)).is_ok())
}

/// The SHA-256 of a file.
fn digest_of(path: &Path) -> std::io::Result<String> {
    // What is not a file may have no end.
    if std::fs::metadata(path)?.is_file() {
        Ok(sha256(&std::fs::read(path)?))
    } else {
        Err(std::io::Error::other("it is not a file"))
    }
}

/// Whether a path is that of a program.
fn found_program(path: &Path) -> Result<(), Failure> {
    let shown = path.display();
    match std::fs::metadata(path) {
        Err(error) => Err(format!("cannot start {shown}: {error}").into()),
        Ok(found) if !found.is_file() => {
            Err(format!("cannot start {shown}: it is not a file").into())
        }
        Ok(found) if !is_executable(&found) => {
            Err(format!("cannot start {shown}: it is not executable").into())
        }
        Ok(_) => Ok(()),
    }
}

#[cfg(unix)]
fn is_executable(found: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    found.permissions().mode() & 0o111 != 0
}

#[cfg(not(unix))]
fn is_executable(_: &std::fs::Metadata) -> bool {
    true
}

/// The arguments that are files, such as a script for an interpreter; without any the program, if it is a file.
fn scripts(words: &[String], folder: &Path) -> Vec<String> {
    let files = |words: &[String]| -> Vec<String> {
        words.iter().filter(|word| folder.join(word).is_file()).cloned().collect()
    };
    let arguments = files(&words[1..]);
    if arguments.is_empty() { files(&words[..1]) } else { arguments }
}

fn check(words: &[String]) -> Result<(), CommandError> {
    if words.first().is_none_or(String::is_empty) {
        return Err(CommandError::Empty);
    }
    Ok(())
}
