//! What a file is, so that a verb given another than it takes can say so.

use std::path::Path;

use super::CliError;
use crate::input::{Document, InputError, nearest};
use crate::reorientation::{GivenTrajectory, TaskFile};
use crate::robot::Robot;

/// What a file or folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Robot,
    /// A file with a table `[motion]`.
    Motion,
    Experiment,
    Task,
    /// A motion of another program, or one written by `--motion`.
    Trajectory,
    Results,
    /// A folder that no experiment has made.
    Folder,
    /// Any file that describes something: what `check` takes.
    Description,
}

/// Keys that only an experiment has.
const EXPERIMENT_KEYS: [&str; 9] = [
    "name",
    "optimiser",
    "seeds",
    "budget",
    "sweep",
    "targets",
    "functions",
    "problem",
    "imported",
];

impl Kind {
    /// What a file is, by its top-level keys; none where these do not tell.
    pub(super) fn of(document: &Document) -> Result<Option<Self>, InputError> {
        let has = |keys: &[&str]| -> Result<bool, InputError> {
            keys.iter().try_fold(false, |found, key| Ok(found || document.key(key)?.is_some()))
        };
        Ok(if document.is_xml() || has(&["joint", "base", "link", "urdf", "arm"])? {
            Some(Self::Robot)
        } else if has(&["motion"])? {
            Some(Self::Motion)
        } else if has(&EXPERIMENT_KEYS)? {
            Some(Self::Experiment)
        } else {
            has(&["task", "trajectory"])?.then_some(Self::Task)
        })
    }

    /// What a path is that need not be read for it.
    fn of_path(path: &Path) -> Option<Self> {
        if path.is_dir() {
            let is_results = path.join("experiment.toml").is_file();
            return Some(if is_results { Self::Results } else { Self::Folder });
        }
        if path.is_file() {
            return GivenTrajectory::has_name(path).then_some(Self::Trajectory);
        }
        path.to_str().and_then(Robot::embedded).map(|_| Self::Robot)
    }

    /// With its article.
    fn described(self) -> &'static str {
        match self {
            Self::Robot => "a robot",
            Self::Motion => "a motion file",
            Self::Experiment => "an experiment file",
            Self::Task => "a task file",
            Self::Trajectory => "a trajectory",
            Self::Results => "a folder of results",
            Self::Folder => "a folder",
            Self::Description => "a task, robot, motion or experiment file",
        }
    }

    /// Which verbs take it, and what is missing for the one that was asked for.
    fn help(self, expected: Self, path: &Path) -> Option<String> {
        let path = path.display();
        let help = match (self, expected) {
            (Self::Robot, Self::Task) => format!(
                "a task names it: `[task]` with `robot = \"{path}\"`, a start, a goal and limits"
            ),
            (Self::Robot, _) => {
                "`driftless check` and `driftless robot convert` take it".to_owned()
            }
            (Self::Task, Self::Experiment) => {
                "`driftless plan` takes it; an experiment file also has `name` and `[[optimiser]]`"
                    .to_owned()
            }
            (Self::Task, Self::Motion) => {
                "`driftless plan` takes it; a motion file also has a table `[motion]`".to_owned()
            }
            (Self::Task, _) => "`driftless plan` takes it".to_owned(),
            (Self::Motion, _) => "`driftless replay` and `animate` take it".to_owned(),
            (Self::Trajectory, _) => {
                "`driftless replay` and `animate` take it, with the task of `--task`".to_owned()
            }
            (Self::Experiment, _) => "`driftless run`, `submit` and `check` take it".to_owned(),
            (Self::Results, _) => {
                "`driftless report`, `status`, `export`, `compact` and `animate` take it".to_owned()
            }
            (Self::Folder | Self::Description, _) => return None,
        };
        Some(help)
    }
}

/// The error of a path that is of another kind.
fn another(path: &Path, found: Kind, expected: Kind) -> CliError {
    CliError::Usage {
        message: format!(
            "{} is {}, expected {}",
            path.display(),
            found.described(),
            expected.described()
        ),
        help: found.help(expected, path),
    }
}

/// Reads a file of a kind.
pub(super) fn read(path: &Path, expected: Kind) -> Result<Document, CliError> {
    refuse_others(path, expected)?;
    let document = Document::read(path)?;
    expect(&document, expected)?;
    Ok(document)
}

/// Whether a path, of which nothing is read, may be what is expected.
pub(super) fn refuse_others(path: &Path, expected: Kind) -> Result<(), CliError> {
    match Kind::of_path(path) {
        Some(found) if found != expected => Err(another(path, found, expected)),
        _ => Ok(()),
    }
}

/// Whether a file is of a kind, as far as its keys tell.
pub(super) fn expect(document: &Document, expected: Kind) -> Result<(), CliError> {
    match Kind::of(document)? {
        Some(found) if found != expected => Err(another(&document.path, found, expected)),
        _ => Ok(()),
    }
}

/// Whether a file, where folders are expected, is of a kind that can be named.
#[cfg(feature = "harness")]
pub(super) fn refuse_file(path: &Path, expected: Kind) -> Result<(), CliError> {
    let read = Document::read(path).and_then(|document| Kind::of(&document));
    match Kind::of_path(path).or(read.ok().flatten()) {
        Some(found) => Err(another(path, found, expected)),
        None => Ok(()),
    }
}

/// The file named, of a kind, or a text that comes with the program.
pub(super) fn read_or(
    file: Option<&Path>,
    kind: Kind,
    embedded: impl FnOnce() -> Document,
) -> Result<Document, CliError> {
    file.map_or_else(|| Ok(embedded()), |file| read(file, kind))
}

/// A task: its file, the name of a robot that comes with one, or the paper's.
pub(super) fn read_task(file: Option<&Path>) -> Result<Document, CliError> {
    let Some(file) = file else { return Ok(TaskFile::paper()) };
    match shipped(file) {
        Some((robot, _)) => Ok(Document::embedded(robot, &format!("[task]\nrobot = {robot:?}\n"))),
        None => read(file, Kind::Task).map_err(|error| match (error, nearest_robot(file)) {
            (CliError::Unreadable { .. }, Some(robot)) => CliError::Usage {
                message: format!("found neither a file nor a robot `{}`", file.display()),
                help: Some(format!("did you mean the robot `{robot}`?")),
            },
            (error, _) => error,
        }),
    }
}

/// The robot that comes with the program and whose name is nearest to what is no file.
fn nearest_robot(path: &Path) -> Option<&'static str> {
    let name = path.to_str().filter(|_| !path.exists())?;
    nearest(name, Robot::embedded_names())
}

/// A robot that comes with the program and its file, where a path is its name and no file's.
pub(super) fn shipped(path: &Path) -> Option<(&str, Document)> {
    let name = path.to_str().filter(|_| !path.is_file())?;
    Robot::embedded(name).map(|document| (name, document))
}
