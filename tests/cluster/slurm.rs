//! Slurm: five nodes of one processor on one machine, of which `run.sh` starts the first four.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::tasks::{Task, running};
use crate::{SHARDS, Trial, kill, output, until};

/// The daemon of a node, which ends with the test.
struct Node(Child);

impl Node {
    fn start(name: &str) -> Self {
        let mut slurmd = Command::new("slurmd");
        slurmd.args(["-D", "-N", name]).stdout(Stdio::null()).stderr(Stdio::null());
        Self(slurmd.spawn().unwrap())
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Which node a task runs on.
fn node(task: &Task) -> Option<String> {
    task.variable("SLURMD_NODENAME")
}

/// What the queue says of a job, a line per task.
fn queue(job: &str, field: &str) -> String {
    output(Command::new("squeue").args([
        "--noheader",
        "--states=all",
        "--array",
        "--format",
        field,
        "--jobs",
        job,
    ]))
}

#[test]
#[ignore = "needs a Slurm: tests/cluster/run.sh"]
fn slurm_with_a_node_lost_and_one_added() {
    let trial = Trial::new();
    let submitted = output(&mut trial.submit("slurm"));
    let job = submitted.rsplit(' ').next().unwrap().to_owned();
    trial.wait_for_a_third();

    let tasks = || running(&trial.results());
    let on = |name: &str| tasks().into_iter().find(|task| node(task).as_deref() == Some(name));
    until("a node has a task", || on("node0").is_some());
    let lost = on("node0").unwrap();
    let number = lost.variable("SLURM_ARRAY_TASK_ID").unwrap();
    // A node that is lost takes its daemon, and that of the task, and the task with it.
    let folder = std::env::var("DRIFTLESS_SLURM").expect("run by tests/cluster/run.sh");
    let daemon = std::fs::read_to_string(Path::new(&folder).join("node0.pid")).unwrap();
    kill(daemon.trim().parse().unwrap());
    kill(lost.parent().unwrap());
    kill(lost.process);
    output(Command::new("scontrol").args([
        "update",
        "nodename=node0",
        "state=down",
        "reason=lost",
    ]));
    println!("node0 was lost within task {number}");
    let _node = Node::start("node4");
    until("the new node has a task", || on("node4").is_some());

    until("all tasks have ended", || queue(&job, "%T").lines().all(|state| state == "COMPLETED"));
    let log = trial.results().join(format!("logs/{job}_{number}.log"));
    let log = std::fs::read_to_string(log).unwrap();
    let told = format!("shard {number}/{SHARDS}, from SLURM_ARRAY_TASK_ID");
    assert_eq!(log.lines().filter(|line| *line == told).count(), 2, "{log}");
    assert_eq!(queue(&job, "%T").lines().count(), SHARDS);
    trial.compare();
}
