//! Running the command in a folder of its own.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// A folder with files, removed in the end.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn with(self, name: &str, content: impl AsRef<[u8]>) -> Self {
        std::fs::write(self.path().join(name), content).unwrap();
        self
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    /// Runs `driftless` here.
    pub(crate) fn run(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    /// `driftless`, to be run here with nothing of the caller's terminal in its output, and outside
    /// of any scheduler.
    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_driftless"));
        command.args(args).current_dir(self.path());
        // What is trusted is remembered there.
        command.env("XDG_STATE_HOME", self.path().join("state"));
        command.env("LC_ALL", "C.UTF-8").env("NO_COLOR", "1").env_remove("RUST_BACKTRACE");
        for variable in [
            "HQ_TASK_ID",
            "PARALLEL_SEQ",
            "JOB_COMPLETION_INDEX",
            "FLUX_JOB_CC",
            "SLURM_ARRAY_TASK_ID",
            "PBS_ARRAY_INDEX",
            "SGE_TASK_ID",
            "LSB_JOBINDEX",
        ] {
            command.env_remove(variable);
        }
        command
    }
}

pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
