//! Slurm's commands, as far as the test needs them.

use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longer than anything here takes.
const PATIENCE: Duration = Duration::from_mins(5);

/// Runs a command that has to succeed; what it prints.
pub(crate) fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap().trim().to_owned()
}

/// Waits until something is so.
pub(crate) fn until(what: &str, is_so: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < PATIENCE, "waited in vain until {what}");
        sleep(Duration::from_millis(50));
    }
}

/// An array of tasks.
pub(crate) struct Array(String);

impl Array {
    /// Submits a script with options of Slurm's and arguments of its own, to be run in a folder.
    pub(crate) fn submit(options: &[&str], script: &Path, args: &[&str], folder: &Path) -> Self {
        let mut sbatch = Command::new("sbatch");
        sbatch.arg("--parsable").args(options).arg(script).args(args).current_dir(folder);
        Self(output(&mut sbatch))
    }

    pub(crate) fn id(&self) -> &str {
        &self.0
    }

    fn task(&self, index: usize) -> String {
        format!("{}_{index}", self.0)
    }

    fn show(&self, index: usize, field: &str) -> String {
        let mut squeue = Command::new("squeue");
        squeue.args(["--noheader", "--states=all", "--format", field, "--jobs", &self.task(index)]);
        output(&mut squeue)
    }

    /// Such as `PENDING`, `RUNNING`, `FAILED` or `COMPLETED`.
    pub(crate) fn state(&self, index: usize) -> String {
        self.show(index, "%T")
    }

    /// Whether no task waits or runs.
    pub(crate) fn is_over(&self) -> bool {
        output(Command::new("squeue").args(["--noheader", "--jobs", &self.0])).is_empty()
    }

    /// Ends a task, if it runs, and has it begin again.
    pub(crate) fn requeue(&self, index: usize) {
        output(Command::new("scontrol").args(["requeue", &self.task(index)]));
    }

    /// Kills a task's program; Slurm has no hand in it.
    pub(crate) fn kill(&self, index: usize) {
        let job = self.show(index, "%A");
        let processes = output(Command::new("scontrol").args(["listpids", &job, "node"]));
        // Process, job, step, and the number of the task within the step.
        let program = processes.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        let program = program.into_iter().find(|process| process[2..4] == ["batch", "0"]).unwrap();
        output(Command::new("kill").args(["-KILL", program[0]]));
    }
}
