//! `driftless run`.

use std::num::{NonZeroU64, NonZeroUsize};
use std::path::{Path, PathBuf};

use clap::Args;

use super::progress::Bar;
use super::{CliError, read_or, warn_of, watch};
use crate::analysis::{BestRun, best_run, convergence, render, summary};
use crate::experiment::{self, ExperimentFile, Plan, Progress, Record, Shard, Store};
use crate::output::{create_folder, write_file};
use crate::plot;
use crate::problem::Motion;

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
    #[arg(long, value_name = "N")]
    seeds: Option<NonZeroU64>,
    /// Evaluations a run, instead of the file's
    #[arg(long, value_name = "N")]
    budget: Option<NonZeroU64>,
    /// Runs at a time [default: one a processor]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
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
}

impl Progress for Lines<'_> {
    fn finished(&self, record: &Record) {
        let Record { optimiser, instance, seed, cost, status, .. } = record;
        let space = if instance.is_empty() { "" } else { " " };
        self.bar.line(&format!(
            "{optimiser}{space}{instance} seed {seed}: J {cost:.6}, {}",
            status.name()
        ));
    }
}

impl Run {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let document = read_or(self.file.as_deref(), ExperimentFile::embedded)?;
        let mut file = ExperimentFile::read(&document)?;
        file.seeds = self.seeds.unwrap_or(file.seeds);
        file.budget.evaluations = self.budget.unwrap_or(file.budget.evaluations);
        let mut plan = Plan::new(&file, &document)?;
        if let Some(shard) = self.shard {
            plan = plan.shard(shard);
        }
        warn_of(&plan.instances[0].problem.task().robot);

        let folder = self.out.clone().unwrap_or_else(|| Path::new("results").join(&file.name));
        let store = Store::open(&folder)?;
        write_file(
            &folder.join("experiment.toml"),
            toml::to_string(&file).unwrap_or_default().as_bytes(),
        )?;
        if self.fresh {
            store.remove(plan.runs.iter().map(|run| &run.key))?;
        }
        self.run_missing(&plan, &store, &folder)?;

        let keys = || plan.runs.iter().map(|run| run.key.as_str());
        let runs = store.read("runs", keys())?;
        println!("{}", render(&summary(&runs, &plan.targets)?)?);
        let figures = folder.join("figures");
        create_folder(&figures)?;
        let curves = convergence(&runs, &store.read("traces", keys())?)?;
        plot::convergence(&curves).save(&figures, "convergence")?;
        if let Some(best) = best_run(&runs)? {
            show_best(&plan, &best, &figures)?;
        }
        println!("results: {}", folder.display());
        Ok(())
    }

    fn run_missing(&self, plan: &Plan, store: &Store, folder: &Path) -> Result<(), CliError> {
        let watch = watch();
        let missing = plan.runs.iter().filter(|run| !store.has(&run.key));
        let (count, evaluations) =
            missing.fold((0, 0), |(n, sum), run| (n + 1, sum + run.budget.evaluations));
        let stored = plan.runs.len() - count;
        if stored > 0 {
            eprintln!("{stored} of {} runs are stored already", plan.runs.len());
        }
        let jobs = self.jobs.map_or_else(default_jobs, NonZeroUsize::get);
        {
            let bar = Bar::new(evaluations, watch.clone());
            experiment::run(plan, store, jobs, &watch, &Lines { bar: &bar })?;
        }
        if watch.is_interrupted() {
            let stored = plan.runs.iter().filter(|run| store.has(&run.key)).count();
            return Err(CliError::Interrupted(format!(
                "{stored} of {} runs are stored in {}; the same command goes on from there",
                plan.runs.len(),
                folder.display()
            )));
        }
        Ok(())
    }
}

fn default_jobs() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Says which motion is best and draws it.
fn show_best(plan: &Plan, best: &BestRun, figures: &Path) -> Result<(), CliError> {
    let Some(instance) = plan.instances.iter().find(|i| i.label == best.instance) else {
        return Ok(());
    };
    println!(
        "best motion: {}{}{}, seed {}: J {:.6}, t_f {:.4} s",
        best.optimiser,
        if best.instance.is_empty() { "" } else { " on " },
        best.instance,
        best.seed,
        best.certified_cost,
        best.duration
    );
    let problem = &instance.problem;
    let motion = Motion::sample(problem, &best.coefficients, best.duration, plot::SAMPLES);
    Ok(plot::write_motion_figures(figures, &motion, problem.task())?)
}
