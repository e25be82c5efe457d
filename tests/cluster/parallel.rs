//! GNU parallel: each of its jobs is a process; how many run at a time is read from a file again whenever one ends.

use std::fs::{read_to_string, write};
use std::process::Stdio;

use crate::tasks::{Task, running};
use crate::{SHARDS, Trial, WORKERS, kill, until};

#[test]
#[ignore = "needs GNU parallel: tests/cluster/run.sh"]
fn parallel_with_a_process_killed_and_one_added() {
    let trial = Trial::new();
    let jobs = trial.folder.path().join("jobs");
    write(&jobs, WORKERS.to_string()).unwrap();
    let mut submit = trial.submit("parallel");
    submit.arg("--").arg(format!("--jobs={}", jobs.display()));
    let mut parallel = submit.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    trial.wait_for_a_third();

    let tasks = || running(&trial.results());
    write(&jobs, (WORKERS + 1).to_string()).unwrap();
    until("one more task runs", || tasks().len() == WORKERS + 1);
    let lost = tasks().remove(0);
    kill(lost.process);
    println!("process {} was killed within shard {}", lost.process, lost.shard);
    let is_again = |task: &Task| task.shard == lost.shard && task.process != lost.process;
    until("its shard is done again", || tasks().iter().any(is_again));

    assert!(parallel.wait().unwrap().success());
    // A header, and a line per task with exit status and signal in the seventh and eighth column.
    let log = read_to_string(trial.results().join("logs/parallel.tsv")).unwrap();
    let ends: Vec<_> =
        log.lines().skip(1).map(|line| line.split('\t').collect::<Vec<_>>()).collect();
    let done = ends.iter().filter(|columns| columns[6..8] == ["0", "0"]).count();
    assert_eq!(done, SHARDS, "{log}");
    trial.compare();
}
