//! A folder of results: an experiment with its stored runs.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::file::Experiment;
use super::foreign::Foreign;
use super::kind::Registry;
use super::plan::Plan;
use super::runner::{Progress, RunError, run};
use super::shard::Shard;
use super::specs::RunSpec;
use super::standing::standing;
use super::store::{Store, StoreError};
use crate::digest::digest;
use crate::input::{Document, InputError};
use crate::output::{FileError, check_writable, create_folder, write_file, write_folder};
use crate::search::Watch;

/// Where other versions of the experiment are kept.
const EARLIER: &str = "earlier";

/// What the experiment is kept in.
const EXPERIMENT: &str = "experiment.toml";

/// A folder of results.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// The experiment spelt out.
    pub plan: Plan,
    /// Its stored runs.
    pub store: Store,
    /// Of a folder that holds runs of another version of the experiment, which are not this one's: where its files have been
    /// put.
    pub earlier: Option<PathBuf>,
}

/// How to do what is missing.
#[derive(Debug, Clone, Copy, Default)]
#[non_exhaustive]
pub struct Options {
    /// Runs at a time; as many as there are processors where none is given.
    pub jobs: Option<usize>,
    /// The part of the runs to do; all without one.
    pub shard: Option<Shard>,
}

impl Options {
    /// The same with so many runs at a time.
    #[must_use]
    pub fn with_jobs(self, jobs: usize) -> Self {
        Self { jobs: Some(jobs), ..self }
    }

    /// The same for a part of the runs.
    #[must_use]
    pub fn with_shard(self, shard: Shard) -> Self {
        Self { shard: Some(shard), ..self }
    }
}

/// Which stored runs are done again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Again {
    /// Those that failed.
    Failed,
    /// All.
    All,
}

/// A folder that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The experiment cannot be used.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The folder has no experiment.
    #[error("found no {EXPERIMENT} in {}, expected the results of an experiment", .0.display())]
    NoResults(PathBuf),
    /// Results of several experiments in one folder would leave all but one without their definition.
    #[error("{} holds the results of the experiment `{found}`, expected those of `{expected}`", .path.display())]
    Another {
        /// The folder.
        path: PathBuf,
        /// The experiment there.
        found: String,
        /// The experiment wanted.
        expected: String,
    },
    /// Imported results are read only.
    #[error("{} holds the imported results `{name}`, expected another folder", .path.display())]
    Imported {
        /// The folder.
        path: PathBuf,
        /// What they are called.
        name: String,
    },
    /// A file that is there and is no experiment would be lost.
    #[error("{} has no name that can be read, expected the experiment `{expected}`, or no such file", .path.display())]
    Unnamed {
        /// The file.
        path: PathBuf,
        /// The experiment wanted.
        expected: String,
    },
    /// A file of somebody's own would be lost.
    #[error("{} exists without results beside it and would be overwritten", .0.display())]
    Own(PathBuf),
    /// The experiment could not be put into words.
    #[error("cannot write the experiment: {0}")]
    Written(String),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A stored result could not be read or written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

impl Folder {
    /// Keeps a plan's experiment in a folder, made if need be, for its runs to be stored beside it. The folder
    /// may hold runs of the experiment already. Those that only another version of it has stay there, and that version's files
    /// are kept in `earlier/`.
    pub fn create(path: &Path, plan: Plan) -> Result<Self, FolderError> {
        check_name(path, &plan.name)?;
        let (experiment, mut files) = plan.experiment.clone().kept()?;
        files.push((EXPERIMENT.to_owned(), experiment.to_toml().map_err(FolderError::Written)?));
        let files: Vec<_> = files.into_iter().map(|(name, text)| (path.join(name), text)).collect();
        if !Store::is_in(path) {
            // What stands there without results is somebody's own.
            let differs = |file: &Path, text: &str| {
                file.exists() && std::fs::read_to_string(file).ok().as_deref() != Some(text)
            };
            if let Some((own, _)) = files.iter().find(|(file, text)| differs(file, text)) {
                return Err(FolderError::Own(own.clone()));
            }
        }
        // Read before the store is, which takes a while: another shard may be about to write the new files.
        let before = stored_files(path);
        let store = Store::open(path)?.knowing_lengths_of(&plan);
        let earlier = keep_earlier(path, &before, &files, &plan, &store)?;
        for (file, text) in files {
            keep(&file, &text)?;
        }
        store.list_plan(&plan)?;
        Ok(Self { path: path.to_owned(), plan, store, earlier })
    }

    /// Makes a folder of results of another program, called as the folder is, whole or not at all. The folder may exist, but only
    /// empty.
    pub fn import(path: &Path, foreign: &Foreign) -> Result<Plan, FolderError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let plan = foreign.experiment(&name)?.plan()?;
        write_folder(path, |folder| {
            let folder = Self::create(folder, plan.clone())?;
            folder.store.write_imported(&folder.plan, foreign)?;
            Ok::<_, FolderError>(())
        })?;
        Ok(plan)
    }

    /// Opens a folder of results to read them; nothing is written. Subjects and optimisers that this program does not
    /// have can be reported and not be run.
    pub fn open(path: &Path, registry: &Registry) -> Result<Self, FolderError> {
        let file = path.join(EXPERIMENT);
        if !file.is_file() {
            return Err(FolderError::NoResults(path.to_owned()));
        }
        let plan = Experiment::read(&Document::read(&file)?, registry)?.plan()?;
        let store = Store::existing(path).knowing_lengths_of(&plan);
        Ok(Self { path: path.to_owned(), plan, store, earlier: None })
    }

    /// Whether there are tables of runs in a folder, whatever its experiment says.
    pub fn has_runs(path: &Path) -> bool {
        Store::is_in(path)
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The experiment's file.
    pub fn experiment_file(&self) -> PathBuf {
        self.path.join(EXPERIMENT)
    }

    /// The runs of a shard, or all.
    pub fn runs(&self, shard: Option<Shard>) -> Vec<&RunSpec> {
        let mine = |place: usize| shard.is_none_or(|shard| shard.holds(place));
        let places = self.plan.runs.iter().enumerate();
        places.filter(|(place, _)| mine(*place)).map(|(_, run)| run).collect()
    }

    /// Those runs of a shard, or of all, that are not stored.
    pub fn missing(&self, shard: Option<Shard>) -> Result<Vec<&RunSpec>, StoreError> {
        let stored = self.store.keys()?;
        let mine = self.runs(shard).into_iter();
        Ok(mine.filter(|run| !stored.contains(&run.key)).collect())
    }

    /// Removes those of `runs` from the store that are to be done again; `waiting` is told where another process is waited for. What
    /// cannot be done again is kept.
    pub fn forget(
        &self,
        runs: &[&RunSpec],
        again: Again,
        waiting: &dyn Fn(),
    ) -> Result<(), StoreError> {
        let mut keys: HashSet<&str> = runs.iter().map(|run| run.key.as_str()).collect();
        if again == Again::Failed {
            let failures = standing(&self.plan, &self.store)?.failures;
            let failed = failures.iter().map(|run| self.plan.runs[run.run].key.as_str());
            let failed: HashSet<&str> = failed.collect();
            keys.retain(|key| failed.contains(key));
        }
        for run in runs.iter().filter(|run| self.plan.obstacle(run).is_some()) {
            keys.remove(run.key.as_str());
        }
        self.store.remove(&keys, waiting)
    }

    /// Does what is missing; what is stored is not done again. Where `watch` is interrupted, runs that have not
    /// ended leave nothing behind.
    pub fn run(
        &self,
        options: Options,
        watch: &Watch,
        progress: &dyn Progress,
    ) -> Result<(), RunError> {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        let jobs = options.jobs.unwrap_or_else(all).max(1);
        run(&self.plan, &self.runs(options.shard), &self.store, jobs, watch, progress)
    }
}

impl Plan {
    /// Whether this program can do any of what is missing from a folder, before anything is written.
    pub fn check_possible(&self, folder: &Path) -> Result<(), RunError> {
        if self.runs.iter().all(|run| self.obstacle(run).is_none()) {
            return Ok(());
        }
        let stored = Store::existing(folder).keys()?;
        let missing = self.runs.iter().filter(|run| !stored.contains(&run.key));
        let obstacles: Option<Vec<_>> = missing.map(|run| self.obstacle(run)).collect();
        match obstacles.as_deref() {
            Some([reason, ..]) => Err(RunError::foreign(reason)),
            _ => Ok(()),
        }
    }
}

/// Whether a folder has no experiment or one of this name, of whatever kind.
fn check_name(folder: &Path, name: &str) -> Result<(), FolderError> {
    #[derive(Deserialize)]
    struct Named {
        name: String,
        imported: Option<toml::Value>,
    }
    let path = folder.join(EXPERIMENT);
    if !path.exists() {
        return Ok(());
    }
    let expected = name.to_owned();
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    match toml::from_str::<Named>(&text) {
        Ok(Named { name, imported: Some(_) }) => {
            Err(FolderError::Imported { path: folder.to_owned(), name })
        }
        Ok(Named { name: found, .. }) if found == name => Ok(()),
        Ok(Named { name: found, .. }) => {
            Err(FolderError::Another { path: folder.to_owned(), found, expected })
        }
        Err(_) => Err(FolderError::Unnamed { path, expected }),
    }
}

/// Writes a text, unless it is there already: then other shards may be reading it.
fn keep(path: &Path, text: &str) -> Result<(), FolderError> {
    if let Some(folder) = path.parent() {
        create_folder(folder)?;
    }
    if std::fs::read_to_string(path).ok().as_deref() == Some(text) {
        return Ok(check_writable(path)?);
    }
    Ok(write_file(path, text.as_bytes())?)
}

/// The files of the experiment that a folder has, its robots and tasks included: names and texts.
fn stored_files(folder: &Path) -> Vec<(PathBuf, String)> {
    let mut names = vec![PathBuf::from(EXPERIMENT), PathBuf::from("robot.toml")];
    for part in ["robots", "tasks"] {
        let entries = std::fs::read_dir(folder.join(part)).into_iter().flatten().flatten();
        names.extend(entries.map(|entry| Path::new(part).join(entry.file_name())));
    }
    names.sort();
    let read = |name: PathBuf| {
        let text = std::fs::read_to_string(folder.join(&name)).ok()?;
        Some((name, text))
    };
    names.into_iter().filter_map(read).collect()
}

/// Copies the files that a folder had into `earlier/`, where those of the plan differ and some of the stored runs are not the
/// plan's. Where to. The name of a copy follows from all that is in it, so no copy takes the place of another.
fn keep_earlier(
    folder: &Path,
    before: &[(PathBuf, String)],
    files: &[(PathBuf, String)],
    plan: &Plan,
    store: &Store,
) -> Result<Option<PathBuf>, FolderError> {
    let differs = |(name, text): &(PathBuf, String)| {
        files.iter().any(|(path, new)| *path == folder.join(name) && new != text)
    };
    if !before.iter().any(differs) {
        return Ok(None);
    }
    let planned = plan.places();
    if store.keys()?.iter().all(|key| planned.contains_key(key.as_str())) {
        return Ok(None);
    }
    let all: Vec<String> =
        before.iter().map(|(name, text)| format!("{}\0{text}", name.display())).collect();
    let copy = folder.join(EARLIER).join(digest(&all.join("\0")));
    for (name, text) in before {
        keep(&copy.join(name), text)?;
    }
    Ok(Some(copy))
}
