//! `driftless submit`.

use std::num::NonZeroUsize;
use std::path::Path;
use std::process::Command;

use clap::{Args, ValueEnum};
use serde_json::json;

use super::chosen::Chosen;
use super::run::default_jobs;
use super::warnings::warn_of_budgets;
use super::{CliError, say_json, start_worker_threads};
use crate::experiment::{Folder, FolderError, Plan, estimate};
use crate::process::is_on_path;
use crate::registry::registry;
use crate::words::plural;

/// Workers that are reckoned with where nobody says how many there are.
pub(super) const WORKERS: usize = 8;

/// How often GNU parallel tries a task; `HyperQueue` and Slurm begin those of lost workers again by themselves.
const TRIES: u32 = 3;

/// Print the job script that runs an experiment on a scheduler; with --go, submit it
#[derive(Debug, Args)]
pub(super) struct Submit {
    #[command(flatten)]
    chosen: Chosen,
    /// Scheduler to write the job for
    #[arg(long, value_enum, value_name = "SCHEDULER")]
    to: Scheduler,
    /// Number of shards, each a task of the scheduler [default: chosen from the estimated time of the runs]
    #[arg(long, value_name = "N")]
    shards: Option<NonZeroUsize>,
    /// Number of tasks that run at a time; it also sets the default of --shards. `HyperQueue` runs as many as its workers take
    /// [default: with GNU parallel, as many as the processors allow; with others unlimited, and --shards assumes 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=10_000))]
    workers: Option<u16>,
    /// Number of runs at a time in each task, and of processors that it asks for
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: u16,
    /// Submit the job
    #[arg(long)]
    go: bool,
    /// Print one JSON object instead of the job alone
    #[arg(long, conflicts_with = "go")]
    json: bool,
    /// Options to pass to the scheduler's command
    #[arg(last = true, value_name = "OPTION")]
    options: Vec<String>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Scheduler {
    /// `hq submit`
    #[value(name = "hyperqueue")]
    HyperQueue,
    /// `sbatch`
    Slurm,
    /// GNU parallel, on this machine or, with its own options, on others
    Parallel,
}

impl Submit {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_worker_threads()?;
        let experiment = self.chosen.read()?;
        let is_trusted = self.chosen.tell_programs(&experiment)?;
        let plan = experiment.plan()?;
        warn_of_budgets(&plan);
        let folder = self.chosen.folder(&plan);
        check_folder(&folder, &plan)?;
        let shards = self.shards(&plan)?;
        let task = self.task(&folder, is_trusted)?;
        let job = self.job(&plan.name, &absolute(&folder)?, shards, &task);
        let program = self.to.program();
        if self.go && !is_on_path(program) {
            return Err(CliError::Usage {
                message: format!("cannot start the job: found no `{program}` on the PATH"),
                help: Some("without --go the job is shown, to be started elsewhere".to_owned()),
            });
        }
        if self.json {
            return say_json(&json!({
                "experiment": plan.name,
                "folder": absolute(&folder)?,
                "scheduler": program,
                "runs": plan.runs.len(),
                "shards": shards,
                "jobs": self.jobs,
                "job": job,
            }));
        }
        say!("{job}");
        let (runs, each) = (plural(plan.runs.len(), "run"), plural(shards, "task"));
        if !self.go {
            note!("note: {runs} in {each}; pass --go to submit the job, or run it in a shell");
            return Ok(());
        }
        note!("note: {runs} in {each}");
        match Command::new("sh").args(["-c", &job]).status() {
            Ok(status) if status.success() => Ok(()),
            Ok(status) => Err(CliError::Job(format!("`{program}` ended with {status}"))),
            Err(error) => Err(CliError::Job(format!("cannot start a shell: {error}"))),
        }
    }

    /// Tasks that run at a time, as far as that is known.
    fn workers(&self) -> Option<usize> {
        let processors = || (default_jobs() / usize::from(self.jobs)).max(1);
        let is_here = matches!(self.to, Scheduler::Parallel);
        self.workers.map(usize::from).or_else(|| is_here.then(processors))
    }

    fn shards(&self, plan: &Plan) -> Result<usize, CliError> {
        let runs = plan.runs.len();
        match self.shards.map(NonZeroUsize::get) {
            Some(shards) if shards <= runs => Ok(shards),
            Some(shards) => Err(CliError::Usage {
                message: format!(
                    "found {shards} shards for {}, expected one per run at most",
                    plural(runs, "run")
                ),
                help: None,
            }),
            None => {
                let workers = self.workers().unwrap_or(WORKERS);
                Ok(estimate(plan, default_jobs())?.shards(workers, self.jobs.into()).most)
            }
        }
    }

    /// The command that does one shard, all but the shard.
    fn task(&self, folder: &Path, is_trusted: bool) -> Result<String, CliError> {
        let program = std::env::current_exe();
        let program = program.map_err(|source| unreadable(Path::new("driftless"), source))?;
        let mut words = vec![absolute(&program)?, "run".to_owned()];
        words.extend(self.chosen.file.as_deref().map(absolute).transpose()?);
        words.extend(["--out".to_owned(), absolute(folder)?]);
        let jobs = Some(self.jobs.into());
        let options =
            [("--seeds", self.chosen.seeds), ("--budget", self.chosen.budget), ("--jobs", jobs)];
        for (option, number) in options {
            let number = number.map(|number| number.to_string());
            words.extend(number.into_iter().flat_map(|number| [option.to_owned(), number]));
        }
        // Tasks have nobody to ask, and go by what is remembered.
        words.extend(is_trusted.then(|| "--trust".to_owned()));
        words.extend(self.chosen.retry.then(|| "--retry".to_owned()));
        if matches!(self.to, Scheduler::Parallel) {
            check_braces(&words)?;
        }
        Ok(shell_words::join(words))
    }

    /// The job, as lines for a shell.
    fn job(&self, name: &str, folder: &str, shards: usize, task: &str) -> String {
        let quoted = |text: &str| shell_words::quote(text).into_owned();
        let (name, last, jobs) = (quoted(name), shards - 1, self.jobs);
        let logs = format!("{folder}/logs");
        let options = match &*self.options {
            [] => String::new(),
            options => format!(" {}", shell_words::join(options)),
        };
        let workers = self.workers();
        let job = match self.to {
            Scheduler::HyperQueue => {
                let output = quoted(&format!("{logs}/%{{TASK_ID}}.out"));
                let errors = quoted(&format!("{logs}/%{{TASK_ID}}.err"));
                format!(
                    "hq submit --name {name} --array 0-{last} --cpus {jobs} --stdout {output} --stderr {errors}{options} \\\n    \
                     -- {task} --shard /{shards}"
                )
            }
            Scheduler::Slurm => {
                let limit = workers.map_or_else(String::new, |workers| format!("%{workers}"));
                let log = quoted(&format!("{}/%A_%a.log", logs.replace('%', "%%")));
                // `exec`: Slurm's signals reach the program itself, and the task ends as the program does.
                let task = quoted(&format!("exec {task} --shard /{shards}"));
                format!(
                    "sbatch --job-name {name} --array 0-{last}{limit} --cpus-per-task {jobs} --requeue --open-mode append \
                     --output {log}{options} \\\n    --wrap {task}"
                )
            }
            Scheduler::Parallel => {
                let (workers, log) =
                    (workers.unwrap_or(1), quoted(&format!("{logs}/parallel.tsv")));
                format!(
                    "seq 0 {last} | parallel --jobs {workers} --joblog {log} --retries {TRIES} --quote{options} \\\n    \
                     {task} --shard {{}}/{shards}"
                )
            }
        };
        format!("mkdir -p {} &&\n{job}", quoted(&logs))
    }
}

impl Scheduler {
    /// The command that starts its jobs.
    fn program(self) -> &'static str {
        match self {
            Self::HyperQueue => "hq",
            Self::Slurm => "sbatch",
            Self::Parallel => "parallel",
        }
    }
}

/// Whether the results may go there, as far as can be told before anything is written.
fn check_folder(folder: &Path, plan: &Plan) -> Result<(), CliError> {
    match Folder::open(folder, &registry()) {
        Ok(other) if other.plan.name != plan.name => Err(FolderError::Another {
            path: folder.to_owned(),
            found: other.plan.name,
            expected: plan.name.clone(),
        }
        .into()),
        // What else is wrong with it, the tasks say.
        _ => Ok(()),
    }
}

/// Whether GNU parallel leaves the words of a command as they are: it has no quoting for the places of its arguments.
fn check_braces(words: &[String]) -> Result<(), CliError> {
    words.iter().find(|word| word.contains('{')).map_or(Ok(()), |word| {
        Err(CliError::Usage {
            message: format!("found `{{` in `{word}`, which GNU parallel may replace"),
            help: Some("expected paths without it".to_owned()),
        })
    })
}

/// A path that means the same in every folder.
fn absolute(path: &Path) -> Result<String, CliError> {
    let absolute = std::path::absolute(path).map_err(|source| unreadable(path, source))?;
    absolute.into_os_string().into_string().map_err(|path| CliError::Usage {
        message: format!("found the path {}, expected one in UTF-8", path.display()),
        help: None,
    })
}

fn unreadable(path: &Path, source: std::io::Error) -> CliError {
    CliError::Unreadable { path: path.to_owned(), source }
}
