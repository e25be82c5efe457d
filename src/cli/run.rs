//! `driftless run`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Bar;
use super::report::report;
use super::results::start_all_threads;
use super::warnings::warn_of_subjects;
use super::{CliError, read_or, watch};
use crate::experiment::{
    Damage, Experiment, Folder, Options, Plan, Progress, Record, RunError, RunSpec, Shard,
    ShardChoice, Store,
};
use crate::output::folder_of;
use crate::registry::registry;
use crate::report::Target;

/// Run an experiment: every optimiser on every instance for every seed
#[derive(Debug, Args)]
pub(super) struct Run {
    /// Experiment file; without one, a small experiment on the paper's task
    #[arg(value_name = "EXPERIMENT.toml")]
    file: Option<PathBuf>,
    /// Folder for the results [default: results/NAME]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of seeds, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    seeds: Option<u64>,
    /// Evaluations per run, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    budget: Option<u64>,
    /// Runs at a time [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Only a disjoint part of the runs, such as 0/4; /4 takes the index from the scheduler that runs
    /// this, and --shard alone the count too
    #[arg(long, value_name = "I/N", num_args = 0..=1, default_missing_value = "")]
    shard: Option<ShardChoice>,
    /// Do again what is already stored
    #[arg(long)]
    fresh: bool,
    /// Start the programs that a file of results names
    #[arg(long)]
    trust: bool,
    /// Say nothing of runs that end as they should
    #[arg(long)]
    quiet: bool,
}

const WAITING: &str = "note: another process is merging files; waiting until it is done";

/// Prints a line for every run that ends.
struct Lines<'a> {
    bar: &'a Bar,
    plan: &'a Plan,
    damaged: PathBuf,
    quiet: bool,
}

impl Progress for Lines<'_> {
    fn finished(&self, run: &RunSpec, record: &Record) {
        let optimiser = &self.plan.optimisers[run.optimiser].label;
        let instance = &self.plan.instances[run.instance];
        let (instance, subject) = (&instance.label, &instance.subject);
        let space = if instance.is_empty() { "" } else { " " };
        let found = match record.cost {
            cost if !cost.is_finite() => "nothing found".to_owned(),
            cost => format!("{} {}", subject.cost_symbol(), subject.cost_text(cost)),
        };
        let (status, message) = (record.status.name(), &record.message);
        if self.quiet && message.is_empty() {
            return;
        }
        let (warning, colon) = if message.is_empty() { ("", "") } else { ("warning: ", ": ") };
        let message = message.lines().next().unwrap_or_default();
        self.bar.line(&format!(
            "{warning}{optimiser}{space}{instance} seed {}: {found}, {status}{colon}{message}",
            run.seed
        ));
    }

    fn waiting(&self) {
        self.bar.line(WAITING);
    }

    fn set_aside(&self, damage: &Damage) {
        self.bar.line(&format!(
            "warning: {damage}; its batch was moved to {}, and its runs are done again",
            self.damaged.display()
        ));
    }
}

impl Run {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_all_threads()?;
        let shard = self.shard.map(told).transpose()?;
        let (document, registry) =
            (read_or(self.file.as_deref(), Experiment::embedded)?, registry());
        let mut experiment = Experiment::read(&document, &registry)?;
        if let Some(from) = experiment.imported() {
            let message = format!("these results were imported, from {from}, and cannot be run");
            let help = Some("`driftless report` reports them, also beside others".to_owned());
            return Err(CliError::Usage { message, help });
        }
        if let Some(seeds) = self.seeds.and_then(NonZeroU64::new) {
            experiment = experiment.with_seeds(seeds);
        }
        if let Some(evaluations) = self.budget.and_then(NonZeroU64::new) {
            experiment = experiment.with_budget(evaluations);
        }
        self.tell_programs(&experiment)?;
        experiment.ask_programs()?;
        let plan = experiment.plan()?;
        warn_of_subjects(&plan);
        let path = self.out.clone().unwrap_or_else(|| Path::new("results").join(&plan.name));
        check_possible(&plan, &path)?;
        let folder = Folder::create(&path, plan)?;
        if let Some(earlier) = &folder.earlier {
            note!(
                "note: {} holds runs of another version of this experiment; they stay there and are left out of the summary. \
                 That version is kept as {}",
                path.display(),
                earlier.join("experiment.toml").display()
            );
        }
        self.run_missing(&folder, shard)?;
        let (plan, stored) = (&folder.plan, folder.store.keys()?);
        let stored = plan.runs.iter().filter(|run| stored.contains(&run.key)).count();
        match shard {
            Some(shard) if stored < plan.runs.len() => {
                say!(
                    "shard {shard}: its {} runs are stored in {}, {stored} of the experiment's {}; \
                     summary and figures come with the last",
                    folder.runs(Some(shard)).len(),
                    path.display(),
                    plan.runs.len()
                );
                Ok(())
            }
            _ => {
                if let Some(kept) = report(&folder.plan, &[&folder.store], &Target::of(&path))? {
                    note!("note: {kept}; `driftless report --replace` replaces it");
                }
                Ok(())
            }
        }
    }

    /// Says which programs the experiment starts. Those that a file of results names may come from anybody, and are started only
    /// where the user says so.
    fn tell_programs(&self, experiment: &Experiment) -> Result<(), CliError> {
        let mut told = Vec::new();
        // A file need not say where it comes from.
        let folder = self.file.as_deref().map(folder_of);
        let mut is_from_results = folder.is_some_and(Folder::has_runs);
        for (command, is_kept) in experiment.programs() {
            is_from_results |= is_kept;
            let program = format!("`{command}` in {}", command.folder().display());
            if !told.contains(&program) {
                told.push(program);
            }
        }
        for program in &told {
            note!("note: this experiment starts {program}");
        }
        if told.is_empty() || !is_from_results || self.trust {
            return Ok(());
        }
        if confirmed("Start what these results name? [y/N] ") {
            return Ok(());
        }
        Err(CliError::Usage {
            message: "these programs are named by a file of results, which may come from anybody"
                .to_owned(),
            help: Some("look at them, and pass --trust to start them".to_owned()),
        })
    }

    fn run_missing(&self, folder: &Folder, shard: Option<Shard>) -> Result<(), CliError> {
        let (watch, mine, store) = (watch(), folder.runs(shard), &folder.store);
        if self.fresh {
            let own = mine.iter().filter(|run| folder.plan.obstacle(run).is_none());
            let waiting = || note!("{WAITING}");
            store.remove(&own.map(|run| run.key.as_str()).collect(), &waiting)?;
        }
        let stored = store.keys()?;
        let missing = mine.iter().filter(|run| !stored.contains(&run.key));
        let (count, evaluations) = missing.fold((0, 0), |(n, sum), run| (n + 1, sum + run.budget));
        if count < mine.len() {
            note!("{} of {} runs are stored already", mine.len() - count, mine.len());
        }
        {
            let bar = Bar::new(evaluations, watch.clone());
            let damaged = store.damaged_folder();
            let lines = Lines { bar: &bar, plan: &folder.plan, damaged, quiet: self.quiet };
            let jobs = Some(self.jobs.map_or_else(default_jobs, usize::from));
            folder.run(Options { jobs, shard }, &watch, &lines)?;
        }
        if watch.is_interrupted() {
            let stored = store.keys()?;
            let stored = mine.iter().filter(|run| stored.contains(&run.key)).count();
            let without = if self.fresh { " without --fresh" } else { "" };
            return Err(CliError::Interrupted(format!(
                "{stored} of {} runs are stored in {}; the same command{without} goes on from there",
                mine.len(),
                folder.path().display()
            )));
        }
        Ok(())
    }
}

/// Whether this program can do any of what is missing, before anything is written.
fn check_possible(plan: &Plan, path: &Path) -> Result<(), CliError> {
    if plan.runs.iter().all(|run| plan.obstacle(run).is_none()) {
        return Ok(());
    }
    let stored = Store::existing(path).keys()?;
    let missing = plan.runs.iter().filter(|run| !stored.contains(&run.key));
    let obstacles: Option<Vec<_>> = missing.map(|run| plan.obstacle(run)).collect();
    match obstacles.as_deref() {
        Some([reason, ..]) => Err(RunError::foreign(reason).into()),
        _ => Ok(()),
    }
}

/// Asks the user, where there is one.
fn confirmed(question: &str) -> bool {
    use std::io::{IsTerminal as _, Write as _};
    if !std::io::stdin().is_terminal() || !std::io::stderr().is_terminal() {
        return false;
    }
    let mut line = String::new();
    let mut errors = std::io::stderr();
    let asked = errors.write_all(question.as_bytes()).and_then(|()| errors.flush());
    asked.and_then(|()| std::io::stdin().read_line(&mut line)).is_ok()
        && ["y", "yes"].contains(&line.trim().to_lowercase().as_str())
}

/// The shard that `--shard` means here.
fn told(choice: ShardChoice) -> Result<Shard, CliError> {
    let variable = |name: &str| Some(std::env::var_os(name)?.to_string_lossy().into_owned());
    let (shard, variable) = choice.resolve(variable)?;
    if let Some(variable) = variable {
        note!("shard {shard}, from {variable}");
    }
    Ok(shard)
}

pub(super) fn default_jobs() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}
