//! `driftless run`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Bar;
use super::report::report;
use super::results::EXPERIMENT;
use super::{CliError, read_or, warn_of, watch};
use crate::analysis;
use crate::experiment::{
    self, ExperimentFile, Instance, Plan, Progress, Record, RunSpec, Shard, ShardChoice, Store,
};
use crate::input::Document;
use crate::output::{check_writable, write_file};
use crate::robot::RobotFile;

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
    /// Evaluations a run, instead of the file's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    budget: Option<u64>,
    /// Runs at a time [default: one a processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Only a disjoint part of the runs, such as 0/4; /4 takes the index from the scheduler that runs
    /// this, and --shard alone the count too
    #[arg(long, value_name = "I/N", num_args = 0..=1, default_missing_value = "")]
    shard: Option<ShardChoice>,
    /// Do again what is already stored
    #[arg(long)]
    fresh: bool,
    /// Say nothing of runs that end as they should
    #[arg(long)]
    quiet: bool,
}

/// Prints a line for every run that ends.
struct Lines<'a> {
    bar: &'a Bar,
    plan: &'a Plan,
    quiet: bool,
}

impl Progress for Lines<'_> {
    fn finished(&self, run: &RunSpec, record: &Record) {
        let optimiser = &self.plan.optimisers[run.optimiser].label;
        let instance = &self.plan.instances[run.instance].label;
        let space = if instance.is_empty() { "" } else { " " };
        let found = match record.cost {
            cost if !cost.is_finite() => "nothing found".to_owned(),
            cost if self.plan.instances[run.instance].is_task() => format!("J {cost:.6}"),
            cost => format!("f {cost:.3e}"),
        };
        let (status, message) = (record.status.name(), record.status.message());
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
}

impl Run {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let shard = self.shard.map(told).transpose()?;
        let document = read_or(self.file.as_deref(), ExperimentFile::embedded)?;
        let mut file = ExperimentFile::read(&document)?;
        if let Some(seeds) = self.seeds.and_then(NonZeroU64::new) {
            file = file.with_seeds(seeds);
        }
        if let Some(evaluations) = self.budget.and_then(NonZeroU64::new) {
            file = file.with_budget(evaluations);
        }
        let plan = Plan::new(&file, &document)?;
        warn_of_robot(&plan);
        let folder = self.out.clone().unwrap_or_else(|| Path::new("results").join(&file.name));
        check_folder(&folder, &file.name)?;
        let store = Store::open(&folder)?;
        keep_inputs(file.with_targets(&plan), &document, &folder)?;
        let mine = |place: usize| shard.is_none_or(|shard| shard.holds(place));
        let places = plan.runs.iter().enumerate();
        let mine: Vec<&RunSpec> = places.filter(|(i, _)| mine(*i)).map(|(_, run)| run).collect();
        self.run_missing(&plan, &mine, &store, &folder)?;
        let stored = store.keys()?;
        let stored = plan.runs.iter().filter(|run| stored.contains(&run.key)).count();
        match shard {
            Some(shard) if stored < plan.runs.len() => {
                say!(
                    "shard {shard}: its {} runs are stored in {}, {stored} of the experiment's {}; \
                     summary and figures come with the last",
                    mine.len(),
                    folder.display(),
                    plan.runs.len()
                );
                Ok(())
            }
            _ => report(&plan, &store, &analysis::load(&plan, &store)?, &folder),
        }
    }

    fn run_missing(
        &self,
        plan: &Plan,
        mine: &[&RunSpec],
        store: &Store,
        folder: &Path,
    ) -> Result<(), CliError> {
        let watch = watch();
        if self.fresh {
            store.remove(&mine.iter().map(|run| run.key.as_str()).collect())?;
        }
        let stored = store.keys()?;
        let missing = mine.iter().filter(|run| !stored.contains(&run.key));
        let (count, evaluations) = missing.fold((0, 0), |(n, sum), run| (n + 1, sum + run.budget));
        if count < mine.len() {
            note!("{} of {} runs are stored already", mine.len() - count, mine.len());
        }
        let jobs = self.jobs.map_or_else(default_jobs, usize::from);
        {
            let bar = Bar::new(evaluations, watch.clone());
            experiment::run(
                plan,
                mine,
                store,
                jobs,
                &watch,
                &Lines { bar: &bar, plan, quiet: self.quiet },
            )?;
        }
        if watch.is_interrupted() {
            let stored = store.keys()?;
            let stored = mine.iter().filter(|run| stored.contains(&run.key)).count();
            let without = if self.fresh { " without --fresh" } else { "" };
            return Err(CliError::Interrupted(format!(
                "{stored} of {} runs are stored in {}; the same command{without} goes on from there",
                mine.len(),
                folder.display()
            )));
        }
        Ok(())
    }
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

/// Results of several experiments in one folder would leave all but one without their definition.
fn check_folder(folder: &Path, name: &str) -> Result<(), CliError> {
    let Ok(document) = Document::read(&folder.join(EXPERIMENT)) else { return Ok(()) };
    match ExperimentFile::read(&document) {
        Ok(before) if before.name != name => Err(CliError::Usage {
            message: format!(
                "{} holds the results of the experiment `{}`, expected those of `{name}`",
                folder.display(),
                before.name
            ),
            help: Some("choose another folder with --out".to_owned()),
        }),
        _ => Ok(()),
    }
}

/// Keeps what the experiment was, so that it can be run again from its results.
fn keep_inputs(
    mut file: ExperimentFile,
    document: &Document,
    folder: &Path,
) -> Result<(), CliError> {
    let robot = file.task.as_ref().and_then(|task| task.robot_file(document));
    if let Some(path) = robot {
        let robot = RobotFile::read(&Document::read(&path)?)?;
        keep(&folder.join("robot.toml"), &toml::to_string(&robot)?)?;
        file.task = file.task.map(|task| task.with_robot("robot.toml"));
    }
    if keep(&folder.join(EXPERIMENT), &toml::to_string(&file)?)? {
        note!(
            "note: {} holds runs of another version of this experiment; they stay there, and those \
             that no longer belong are left out of the summary",
            folder.display()
        );
    }
    Ok(())
}

/// Writes a text, unless it is there already: then other shards may be reading it. Whether another
/// text gave way to it.
fn keep(path: &Path, text: &str) -> Result<bool, CliError> {
    let before = std::fs::read_to_string(path).ok();
    if before.as_deref() == Some(text) {
        check_writable(path)?;
    } else {
        write_file(path, text.as_bytes())?;
    }
    Ok(before.is_some_and(|before| before != text))
}

/// Says what is unphysical about an experiment's robot.
pub(super) fn warn_of_robot(plan: &Plan) {
    // A sweep has one robot.
    if let Some(problem) = plan.instances.iter().find_map(Instance::reorientation) {
        warn_of(&problem.task().robot);
    }
}

/// Says when a comparison is not one at the same price.
pub(super) fn warn_of_budgets(plan: &Plan) {
    if plan.is_uneven() {
        note!(
            "warning: budgets differ within the field, so final costs do not compare; evaluations to a \
             target do"
        );
    }
}

pub(super) fn default_jobs() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}
