//! A job's tasks as processes of this machine, whichever scheduler started them.

use std::fs::{read, read_dir, read_to_string};
use std::path::Path;

/// A running `driftless run`.
#[derive(Debug, Clone)]
pub(crate) struct Task {
    pub(crate) process: u32,
    /// Such as `3/16` or `/16`.
    pub(crate) shard: String,
}

impl Task {
    /// A variable of its environment.
    pub(crate) fn variable(&self, name: &str) -> Option<String> {
        let all = read(format!("/proc/{}/environ", self.process)).ok()?;
        let all = String::from_utf8_lossy(&all).into_owned();
        let mut all = all.split('\0').filter_map(|variable| variable.split_once('='));
        all.find(|(known, _)| *known == name).map(|(_, value)| value.to_owned())
    }

    /// The process that started it.
    pub(crate) fn parent(&self) -> Option<u32> {
        let stat = read_to_string(format!("/proc/{}/stat", self.process)).ok()?;
        // Behind the name, in brackets, stand the state and the parent.
        stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
    }
}

/// The tasks that store into a folder now.
pub(crate) fn running(results: &Path) -> Vec<Task> {
    let task = |process: u32| {
        let words = read(format!("/proc/{process}/cmdline")).ok()?;
        let words = String::from_utf8_lossy(&words).into_owned();
        let words: Vec<&str> = words.split('\0').collect();
        let value = |option| words.iter().skip_while(|word| **word != option).nth(1).copied();
        let is_task =
            words.first()?.ends_with("/driftless") && Path::new(value("--out")?) == results;
        is_task.then_some(Task { process, shard: value("--shard")?.to_owned() })
    };
    let processes = read_dir("/proc")
        .unwrap()
        .filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    processes.filter_map(task).collect()
}
