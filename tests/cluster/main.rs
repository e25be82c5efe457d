//! An experiment as a Slurm array, two of its tasks killed and begun again, gives the tables of a run that
//! nothing disturbed. `run.sh` starts a Slurm for it.
#![cfg(feature = "harness")]

mod slurm;
mod tables;

use std::path::{Path, PathBuf};
use std::process::Command;

use driftless::experiment::Experiment;
use driftless::input::Document;
use driftless::registry;
use slurm::{Array, output, until};
use tempfile::TempDir;

const PROGRAM: &str = env!("CARGO_BIN_EXE_driftless");
const EXPERIMENT: &str = "tests/cluster/experiment.toml";
/// Tasks of the array.
const TASKS: usize = 4;
/// The one whose program is killed.
const KILLED: usize = 1;
/// The one that is told to end and begin again.
const REQUEUED: usize = 2;

/// The experiment as an array, in a folder of its own.
struct Trial {
    folder: TempDir,
    tasks: Array,
    /// The runs of each task, by key.
    shares: [Vec<String>; TASKS],
}

impl Trial {
    fn submit() -> Self {
        let folder = tempfile::tempdir().unwrap();
        // The script calls `driftless`, and Slurm hands the environment on.
        let bin = Path::new(PROGRAM).parent().unwrap().display();
        let path = format!("--export=ALL,PATH={bin}:{}", std::env::var("PATH").unwrap());
        let tasks = Array::submit(
            &["--cpus-per-task=1", &path],
            &here("docs/driftless.sbatch"),
            &[here(EXPERIMENT).to_str().unwrap(), "--out", "results"],
            folder.path(),
        );
        Self { folder, tasks, shares: shares() }
    }

    fn results(&self) -> PathBuf {
        self.folder.path().join("results")
    }

    fn log(&self, task: usize) -> String {
        let name = format!("driftless-{}_{task}.log", self.tasks.id());
        std::fs::read_to_string(self.folder.path().join(name)).unwrap()
    }

    /// How many of a task's runs are stored.
    fn stored(&self, task: usize) -> usize {
        let path = |key: &String| self.results().join(format!("runs/{key}.parquet"));
        self.shares[task].iter().filter(|key| path(key).exists()).count()
    }

    /// Cuts two tasks in the midst of their runs and has them begin again; how many runs each task had
    /// stored by then.
    fn disturb(&self) -> [Option<usize>; TASKS] {
        for task in [KILLED, REQUEUED] {
            until("a task has stored some runs", || self.stored(task) >= 3);
        }
        self.tasks.kill(KILLED);
        self.tasks.requeue(REQUEUED);
        until("the task is killed", || self.tasks.state(KILLED) == "FAILED");
        until("the task has ended", || self.tasks.state(REQUEUED) == "PENDING");
        let mut stored = [None; TASKS];
        for task in [KILLED, REQUEUED] {
            let (count, all) = (self.stored(task), self.shares[task].len());
            println!("task {task} was cut when {count} of its {all} runs were stored");
            assert!(count < all, "nothing was left to do");
            stored[task] = Some(count);
        }
        self.tasks.requeue(KILLED);
        stored
    }

    fn finish(&self) {
        until("all tasks have ended", || self.tasks.is_over());
        for task in 0..TASKS {
            assert_eq!(self.tasks.state(task), "COMPLETED", "{}", self.log(task));
        }
    }

    /// Every task took its part from Slurm, those that were cut went on where they had been, and the last
    /// of all told the result.
    fn check_logs(&self, stored: [Option<usize>; TASKS]) {
        for (task, stored) in stored.into_iter().enumerate() {
            let log = self.log(task);
            let told = format!("shard {task}/{TASKS}, from SLURM_ARRAY_TASK_ID");
            let starts = log.lines().filter(|line| *line == told).count();
            assert_eq!(starts, if stored.is_some() { 2 } else { 1 }, "{log}");
            if let Some(stored) = stored {
                let all = self.shares[task].len();
                let resumed = format!("{stored} of {all} runs are stored already");
                assert!(log.contains(&resumed), "{log}");
            }
        }
        let log = self.log(REQUEUED);
        assert!(log.contains("interrupted: "), "{log}");
        assert!((0..TASKS).any(|task| self.log(task).contains("best motion")), "no summary");
    }
}

/// A file of the repository.
fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The runs of each task: those at every fourth place of the plan.
fn shares() -> [Vec<String>; TASKS] {
    let document = Document::read(&here(EXPERIMENT)).unwrap();
    let plan = Experiment::read(&document, &registry()).unwrap().plan().unwrap();
    let keys: Vec<String> = plan.runs.into_iter().map(|run| run.key).collect();
    std::array::from_fn(|task| keys.iter().skip(task).step_by(TASKS).cloned().collect())
}

#[test]
#[ignore = "needs a Slurm: tests/cluster/run.sh"]
fn a_disturbed_array_gives_the_tables_of_an_undisturbed_run() {
    let alone = tempfile::tempdir().unwrap();
    output(Command::new(PROGRAM).arg("run").arg(here(EXPERIMENT)).arg("--out").arg(alone.path()));
    let trial = Trial::submit();
    let stored = trial.disturb();
    trial.finish();
    trial.check_logs(stored);
    let mut keys = trial.shares.concat();
    keys.sort();
    assert_eq!(tables::keys(&tables::read(&trial.results(), "runs")), keys, "every run once");
    for table in ["runs", "traces", "clocks"] {
        let [alone, array] =
            [alone.path(), &trial.results()].map(|results| tables::read(results, table));
        println!("{table}: {} rows, {} columns compared", alone.height(), alone.width());
        assert!(alone.equals_missing(&array), "{table} differ:\n{alone}\n{array}");
    }
}
