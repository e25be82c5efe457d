//! `HyperQueue`: a server and workers of its Python package, each a process. `hq.py` stands in for the command.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use crate::tasks::{Task, running};
use crate::{Trial, WORKERS, here, kill, output, until};

/// A process that ends with the test.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The server, in the folder of a trial.
struct Server {
    folder: PathBuf,
    _process: Process,
}

impl Server {
    fn start(trial: &Trial) -> Self {
        let folder = trial.folder.path().join("server");
        std::fs::create_dir(&folder).unwrap();
        let process = Process(hq(&folder).arg("server").stdout(Stdio::null()).spawn().unwrap());
        until("the server is there", || folder.join("hq-current/access.json").is_file());
        Self { folder, _process: process }
    }

    fn start_worker(&self, number: usize) -> Process {
        let own = self.folder.with_file_name(format!("worker-{number}"));
        let log = own.with_extension("log");
        let mut worker = hq(&self.folder);
        worker.arg("worker").arg(own).stdout(std::fs::File::create(&log).unwrap());
        let process = Process(worker.spawn().unwrap());
        until("the worker is there", || std::fs::read_to_string(&log).unwrap().contains("started"));
        process
    }
}

/// The stand-in, with the interpreter that has the package.
fn hq(server: &PathBuf) -> Command {
    let python = std::env::var("DRIFTLESS_HYPERQUEUE").expect("run by tests/cluster/run.sh");
    let mut hq = Command::new(python);
    hq.arg(here("tests/cluster/hq.py")).env("HQ_SERVER_DIR", server);
    hq
}

#[test]
#[ignore = "needs HyperQueue: tests/cluster/run.sh"]
fn hyperqueue_with_a_worker_killed_and_one_added() {
    let trial = Trial::new();
    let server = Server::start(&trial);
    let mut workers: Vec<Process> = (0..WORKERS).map(|i| server.start_worker(i)).collect();
    // `hq` is on the PATH by run.sh.
    output(trial.submit("hyperqueue").env("HQ_SERVER_DIR", &server.folder));
    trial.wait_for_a_third();

    let of = |worker: &Process| -> Vec<Task> {
        let tasks = running(&trial.results()).into_iter();
        tasks.filter(|task| task.parent() == Some(worker.0.id())).collect()
    };
    until("the first worker has a task", || !of(&workers[0]).is_empty());
    let lost = of(&workers[0]).remove(0);
    let number = lost.variable("HQ_TASK_ID").unwrap();
    kill(workers[0].0.id());
    until("its task is gone", || {
        running(&trial.results()).iter().all(|t| t.process != lost.process)
    });
    workers.push(server.start_worker(WORKERS));
    println!("worker {} was killed within task {number}", workers[0].0.id());
    let is_again = |task: &Task| {
        task.variable("HQ_TASK_ID").as_ref() == Some(&number)
            && task.variable("HQ_INSTANCE_ID").is_some_and(|instance| instance != "0")
    };
    until("another worker does it", || running(&trial.results()).iter().any(is_again));
    until("the new worker has a task", || !of(&workers[WORKERS]).is_empty());
    output(hq(&server.folder).args(["wait", "1"]));
    trial.compare();
}
