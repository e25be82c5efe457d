//! An experiment that `driftless submit` gives to a scheduler as many small shards, four at a time, gives the tables of one
//! process that nothing disturbed: also where a worker is killed on the way and another added. `run.sh` starts the schedulers.
#![cfg(feature = "harness")]

mod hyperqueue;
mod parallel;
mod slurm;
mod tables;
mod tasks;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use driftless::experiment::{Experiment, Store};
use driftless::input::Document;
use driftless::registry;
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_driftless");
const EXPERIMENT: &str = "tests/cluster/experiment.toml";
/// Where results go: a name that a shell would take apart.
const RESULTS: &str = "it's \"half\" done";
/// Tasks of each job.
const SHARDS: usize = 16;
/// Workers that a job begins with.
const WORKERS: usize = 4;
/// Longer than anything here takes.
const PATIENCE: Duration = Duration::from_mins(5);

/// The experiment as a job, in a folder of its own.
struct Trial {
    folder: TempDir,
    /// The runs, by key.
    keys: Vec<String>,
}

impl Trial {
    fn new() -> Self {
        let document = Document::read(&here(EXPERIMENT)).unwrap();
        let plan = Experiment::read(&document, &registry()).unwrap().plan().unwrap();
        let mut keys: Vec<String> = plan.runs.into_iter().map(|run| run.key).collect();
        keys.sort();
        Self { folder: tempfile::tempdir().unwrap(), keys }
    }

    fn results(&self) -> PathBuf {
        self.folder.path().join(RESULTS)
    }

    /// The command that submits the job, to which options of the scheduler's may be added.
    fn submit(&self, scheduler: &str) -> Command {
        let mut submit = Command::new(PROGRAM);
        submit.arg("submit").arg(here(EXPERIMENT)).args(["--out", RESULTS, "--to", scheduler]);
        submit.args(["--shards", &SHARDS.to_string(), "--workers", &WORKERS.to_string(), "--go"]);
        submit.current_dir(self.folder.path());
        submit
    }

    fn stored(&self) -> usize {
        Store::existing(&self.results()).keys().map_or(0, |keys| keys.len())
    }

    /// Waits until the job is well on its way, with enough left for a worker that is added.
    fn wait_for_a_third(&self) {
        until("a third of the runs is stored", || 3 * self.stored() >= self.keys.len());
        println!("{} of {} runs are stored", self.stored(), self.keys.len());
    }

    /// Every run is stored once, and all is as it is where nothing was disturbed.
    fn compare(&self) {
        static ALONE: LazyLock<TempDir> = LazyLock::new(|| {
            let folder = tempfile::tempdir().unwrap();
            let mut run = Command::new(PROGRAM);
            output(run.arg("run").arg(here(EXPERIMENT)).arg("--out").arg(folder.path()));
            folder
        });
        let stored = tables::keys(&tables::read(&self.results(), "runs"));
        assert_eq!(stored, self.keys, "every run once");
        for table in ["runs", "traces", "clocks"] {
            let [alone, job] =
                [ALONE.path(), &self.results()].map(|results| tables::read(results, table));
            println!("{table}: {} rows, {} columns compared", alone.height(), alone.width());
            assert!(alone.equals_missing(&job), "{table} differ:\n{alone}\n{job}");
        }
        assert!(self.results().join("report.html").is_file(), "no task took itself for the last");
    }
}

/// A file of the repository.
fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Runs a command that has to succeed; what it prints.
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// Waits until something is so.
fn until(what: &str, is_so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "waited in vain until {what}");
        sleep(Duration::from_millis(50));
    }
}

fn kill(process: u32) {
    output(Command::new("kill").args(["-KILL", &process.to_string()]));
}
