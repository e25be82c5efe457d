//! The tasks that a sweep begins with: the experiment's own, the same on other robots, or those of task files.

use std::borrow::Cow;
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::keys::{Sweep, TaskKeys};
use super::settings::DEFAULTS;
use crate::input::{Document, InputError};
use crate::robot::{Robot, RobotFile};
use crate::task::TaskTable;

/// A task, and the file it stands in.
pub(super) struct Base<'a> {
    /// The setting that it is a value of, and what labels call it.
    pub(super) setting: Option<(&'static str, String)>,
    pub(super) task: TaskTable,
    pub(super) document: Cow<'a, Document>,
}

/// A file with a task and nothing else.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct TaskAlone {
    task: TaskTable,
}

impl TaskAlone {
    fn read(document: &Document) -> Result<Self, InputError> {
        if let Some((key, place)) = document.keys()?.into_iter().find(|(key, _)| key != "task") {
            let message = format!("found `{key}`, expected a file with a `[task]` alone");
            let help = "how to search stands in the experiment".to_owned();
            return Err(document.error_at(place, message, Some(help)));
        }
        document.parse_keys(&["task"], &[DEFAULTS])
    }
}

/// The tasks, at least one.
pub(super) fn bases<'a>(
    keys: &TaskKeys,
    document: &'a Document,
) -> Result<Vec<Base<'a>>, InputError> {
    let Sweep { robot, task, .. } = &keys.sweep;
    let own = |setting, task| Base { setting, task, document: Cow::Borrowed(document) };
    if let (false, Some(first)) = (robot.is_empty(), task.first()) {
        let message = "found both `robot` and `task` in the sweep, expected one of them";
        return Err(document.error_at(first.span(), message, None));
    }
    if !robot.is_empty() {
        let with = |robot: &Spanned<String>| {
            let setting = Some(("robot", called(robot.get_ref())));
            own(setting, keys.task.clone().with_robot(robot.clone()))
        };
        return Ok(robot.iter().map(with).collect());
    }
    if task.is_empty() {
        return Ok(vec![own(None, keys.task.clone())]);
    }
    let read = |file: &Spanned<String>| {
        let document = task_document(file, document)?;
        let TaskAlone { task } = TaskAlone::read(&document)?;
        let setting = Some(("task", called(file.get_ref())));
        Ok(Base { setting, task, document: Cow::Owned(document) })
    };
    task.iter().map(read).collect()
}

fn task_document(file: &Spanned<String>, document: &Document) -> Result<Document, InputError> {
    let path = document.resolve(file.get_ref());
    if !path.is_file() {
        let message = format!("no task file at {}", path.display());
        return Err(document.error_at(file.span(), message, None));
    }
    Document::read(&path)
}

/// What labels call a robot or a task: its file's name without its end.
fn called(name: &str) -> String {
    let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str());
    stem.filter(|_| Robot::embedded(name).is_none()).unwrap_or(name).to_owned()
}

/// The keys as they stand in a folder of results, and the files that they need there, by name, with their texts.
pub(super) fn kept(
    keys: &TaskKeys,
    document: &Document,
) -> Result<(TaskKeys, Vec<(String, String)>), InputError> {
    let (mut kept, mut files) = (keys.clone(), Vec::new());
    if !keys.sweep.robot.is_empty() {
        for robot in &mut kept.sweep.robot {
            let file = format!("robots/{}.toml", called(robot.get_ref()));
            let task = keys.task.clone().with_robot(robot.clone());
            if let Some(text) = robot_text(&task, document)? {
                files.push((file.clone(), text));
                *robot = Spanned::new(0..0, file);
            }
        }
        // Left to the sweep.
        kept.task = kept.task.with_robot_file(kept.sweep.robot[0].get_ref().clone());
        return Ok((kept, files));
    }
    for file in &mut kept.sweep.task {
        let name = called(file.get_ref());
        let document = task_document(file, document)?;
        let TaskAlone { mut task } = TaskAlone::read(&document)?;
        if let Some(text) = robot_text(&task, &document)? {
            let robot = format!("robots/{name}.toml");
            files.push((robot.clone(), text));
            task = task.with_robot_file(format!("../{robot}"));
        }
        let path = format!("tasks/{name}.toml");
        files.push((path.clone(), text(&TaskAlone { task }, &document)?));
        *file = Spanned::new(0..0, path);
    }
    if keys.sweep.task.is_empty()
        && let Some(text) = robot_text(&keys.task, document)?
    {
        let robot = "robot.toml";
        files.push((robot.to_owned(), text));
        kept.task = kept.task.with_robot_file(robot.to_owned());
    }
    Ok((kept, files))
}

/// The text of a task's robot, unless that comes with the program.
fn robot_text(task: &TaskTable, document: &Document) -> Result<Option<String>, InputError> {
    let Some(path) = task.robot_file(document) else { return Ok(None) };
    text(&RobotFile::read(&Document::read(&path)?)?, document).map(Some)
}

fn text(value: &impl Serialize, document: &Document) -> Result<String, InputError> {
    toml::to_string(value)
        .map_err(|error| document.error_at(0..0, format!("cannot keep a file: {error}"), None))
}
