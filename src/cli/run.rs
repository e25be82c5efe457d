//! `driftless run`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Bar;
use super::{CliError, read_or, warn_of, watch};
use crate::analysis::{self, best_run, convergence, render, summary};
use crate::experiment::{
    self, ExperimentFile, Instance, Plan, Progress, Record, RunSpec, Shard, Store,
};
use crate::input::Document;
use crate::output::write_file;
use crate::plot;
use crate::problem::{BestKnown, Motion};
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
    /// Only a disjoint part of the runs, such as 0/4
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Do again what is already stored
    #[arg(long)]
    fresh: bool,
}

/// Prints a line for every run that ends.
struct Lines<'a> {
    bar: &'a Bar,
    plan: &'a Plan,
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
        let store = Store::open(&folder)?;
        keep_inputs(file.with_targets(&plan), &document, &folder)?;
        self.run_missing(&plan, &store, &folder)?;
        report(&plan, &store, &folder)
    }

    fn run_missing(&self, plan: &Plan, store: &Store, folder: &Path) -> Result<(), CliError> {
        let watch = watch();
        let mine = |place: usize| self.shard.is_none_or(|shard| shard.holds(place));
        let places = plan.runs.iter().enumerate();
        let mine: Vec<&RunSpec> = places.filter(|(i, _)| mine(*i)).map(|(_, run)| run).collect();
        if self.fresh {
            store.remove(mine.iter().map(|run| &run.key))?;
        }
        let missing = mine.iter().filter(|run| !store.has(&run.key));
        let (count, evaluations) = missing.fold((0, 0), |(n, sum), run| (n + 1, sum + run.budget));
        if count < mine.len() {
            eprintln!("{} of {} runs are stored already", mine.len() - count, mine.len());
        }
        let jobs = self.jobs.map_or_else(default_jobs, usize::from);
        {
            let bar = Bar::new(evaluations, watch.clone());
            experiment::run(plan, &mine, store, jobs, &watch, &Lines { bar: &bar, plan })?;
        }
        if watch.is_interrupted() {
            let stored = mine.iter().filter(|run| store.has(&run.key)).count();
            return Err(CliError::Interrupted(format!(
                "{stored} of {} runs are stored in {}; the same command goes on from there",
                mine.len(),
                folder.display()
            )));
        }
        Ok(())
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
        write_file(&folder.join("robot.toml"), toml::to_string(&robot)?.as_bytes())?;
        file.task = file.task.map(|task| task.with_robot("robot.toml"));
    }
    let (path, text) = (folder.join("experiment.toml"), toml::to_string(&file)?);
    if std::fs::read_to_string(&path).is_ok_and(|before| before != text) {
        eprintln!(
            "note: {} holds runs of another version of this experiment; they stay there, and those \
             that no longer belong are left out of the summary",
            folder.display()
        );
    }
    Ok(write_file(&path, text.as_bytes())?)
}

/// Prints the summary of all stored runs of the plan and draws them.
fn report(plan: &Plan, store: &Store, folder: &Path) -> Result<(), CliError> {
    let keys = || plan.runs.iter().map(|run| run.key.as_str());
    let runs = analysis::runs(plan, &store.read("runs", keys())?)?;
    if runs.len() < plan.runs.len() {
        say!("{} of {} runs are stored so far", runs.len(), plan.runs.len());
    }
    say!("{}", render(&summary(plan, &runs)?)?);
    warn_of_budgets(plan);
    let figures = folder.join("figures");
    let curves = convergence(plan, &runs, &store.read("traces", keys())?)?;
    plot::convergence(&curves, plan.cost_symbol()).save(&figures, "convergence")?;
    for (i, instance) in plan.instances.iter().enumerate() {
        let (Some(problem), Some(best)) =
            (instance.reorientation(), best_run(runs.iter().filter(|run| run.instance == i)))
        else {
            continue;
        };
        let optimiser = &plan.optimisers[best.optimiser].label;
        let known = BestKnown::of(problem)
            .map_or_else(String::new, |known| format!(" ({})", known.compared_with(best.cost)));
        let on = if instance.label.is_empty() { "" } else { " for " };
        say!(
            "best motion{on}{}: {optimiser}, seed {}: J {:.6}{known}, t_f {:.4} s",
            instance.label,
            best.seed,
            best.cost,
            best.duration
        );
        // Costs of different instances do not compare, so there is no best of all to draw.
        if plan.instances.len() == 1 {
            let motion = Motion::sample(problem, &best.coefficients, best.duration, plot::SAMPLES);
            plot::write_motion_figures(&figures, &motion, problem.task())?;
        }
    }
    say!("results: {}, figures: {}", folder.display(), figures.display());
    let failed = runs.iter().filter(|run| run.cost.is_infinite()).count();
    if failed > 0 {
        eprintln!("warning: {failed} of {} runs failed or found nothing", runs.len());
    }
    Ok(())
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
        eprintln!(
            "warning: budgets differ within the field, so final costs do not compare; evaluations to a \
             target do"
        );
    }
}

pub(super) fn default_jobs() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}
