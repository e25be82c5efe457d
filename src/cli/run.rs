//! `driftless run`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::chosen::Chosen;
use super::progress::Bar;
use super::report::report;
use super::results::start_all_threads;
use super::{CliError, say_json, watch};
use crate::experiment::{
    Again, Damage, Folder, Options, Plan, Progress, Record, RunSpec, Shard, ShardChoice,
};
use crate::report::Target;
use crate::words::plural;

/// Run an experiment: every optimiser on every instance for every seed
#[derive(Debug, Args)]
pub(super) struct Run {
    #[command(flatten)]
    chosen: Chosen,
    /// Number of runs at a time [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Do only one of N disjoint parts of the runs, such as 0/4. With /4 the index comes from the scheduler's environment
    /// variables, with --shard alone the number of parts as well
    #[arg(long, value_name = "I/N", num_args = 0..=1, default_missing_value = "")]
    shard: Option<ShardChoice>,
    /// Repeat all stored runs
    #[arg(long)]
    fresh: bool,
    /// Print only runs with warnings, not every run that ends
    #[arg(long)]
    quiet: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
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
        let experiment = self.chosen.read()?;
        self.chosen.tell_programs(&experiment)?;
        experiment.ask_programs()?;
        let plan = experiment.plan()?;
        let path = self.chosen.folder(&plan);
        plan.check_possible(&path)?;
        let folder = Folder::create(&path, plan)?;
        if let Some(earlier) = &folder.earlier {
            note!(
                "note: {} holds runs of another version of this experiment; they stay there and are left out of the summary. \
                 That version is kept as {}",
                path.display(),
                earlier.join("experiment.toml").display()
            );
        }
        let is_idle = self.run_missing(&folder, shard)? == 0;
        let (plan, stored) = (&folder.plan, folder.store.keys()?);
        let stored = plan.runs.iter().filter(|run| stored.contains(&run.key)).count();
        let is_shard = shard.is_some_and(|_| stored < plan.runs.len() || is_idle);
        if self.json && is_shard {
            return say_json(&json!({
                "experiment": plan.name,
                "folder": path.display().to_string(),
                "runs": plan.runs.len(),
                "stored": stored,
                "shard": shard.map(|shard| shard.to_string()),
                "shard_runs": folder.runs(shard).len(),
            }));
        }
        match shard {
            Some(shard) if stored < plan.runs.len() => {
                say!(
                    "shard {shard}: {}, all stored in {}, which has {stored} of the experiment's {}; \
                     summary and figures come with the last",
                    plural(folder.runs(Some(shard)).len(), "run"),
                    path.display(),
                    plan.runs.len()
                );
                Ok(())
            }
            // The task that stored the last run has made the report.
            Some(shard) if is_idle => {
                say!("shard {shard}: nothing is left to do");
                Ok(())
            }
            _ => {
                if let Some(kept) =
                    report(&folder.plan, &[&folder.store], &Target::of(&path), self.json)?
                {
                    note!("note: {kept}; `driftless report --replace` replaces it");
                }
                Ok(())
            }
        }
    }

    /// Does what is missing; how many runs that were.
    fn run_missing(&self, folder: &Folder, shard: Option<Shard>) -> Result<usize, CliError> {
        let (watch, mine, store) = (watch(), folder.runs(shard), &folder.store);
        let again = match (self.fresh, self.chosen.retry) {
            (true, _) => Some(Again::All),
            (false, true) => Some(Again::Failed),
            (false, false) => None,
        };
        if let Some(again) = again {
            folder.forget(&mine, again, &|| note!("{WAITING}"))?;
        }
        let missing = folder.missing(shard)?;
        let (count, evaluations) = (missing.len(), missing.iter().map(|run| run.budget).sum());
        if count < mine.len() {
            let all = plural(mine.len(), "run");
            let stored = mine.len() - count;
            let are = if mine.len() == 1 { "is" } else { "are" };
            note!("{stored} of {all} {are} stored already");
        }
        {
            let bar = Bar::new(evaluations, watch.clone());
            let damaged = store.damaged_folder();
            let lines = Lines { bar: &bar, plan: &folder.plan, damaged, quiet: self.quiet };
            let jobs = Some(self.jobs.map_or_else(default_jobs, usize::from));
            folder.run(Options { jobs, shard }, &watch, &lines)?;
        }
        if watch.is_interrupted() {
            let stored = mine.len() - folder.missing(shard)?.len();
            let without = match (self.fresh, self.chosen.retry) {
                (true, _) => " without --fresh",
                (false, true) => " without --retry",
                (false, false) => "",
            };
            return Err(CliError::Interrupted(format!(
                "{stored} of {} are stored in {}; the same command{without} goes on from there",
                plural(mine.len(), "run"),
                folder.path().display()
            )));
        }
        Ok(count)
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

pub(super) fn default_jobs() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}
