//! `driftless plan`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use super::family::FamilyOptions;
use super::found::{mission_told, told};
use super::kind::read_task;
use super::motion::MotionFiles;
use super::progress::Bar;
use super::{CliError, say_json, shown, start_worker_threads, warn_of, watch};
use crate::optimiser::Settings;
use crate::reorientation::{
    Accuracy, Asked, BestKnown, FamilySpec, LegMotion, Planned, Planner, Reach,
};
use crate::task::{Task, TaskTable};

/// Find the best motion for one task
#[derive(Debug, Args)]
pub(super) struct Plan {
    /// Task file, or the name of a shipped robot, which has its own task [default: the paper's task]
    #[arg(value_name = "TASK")]
    file: Option<PathBuf>,
    /// Optimiser, with its default settings. Optimisers other than `scp` search sine polynomials, which
    /// have few variables, unless --family or the file says otherwise
    #[arg(long, value_name = "NAME", default_value = "scp", value_parser = optimisers())]
    optimiser: Settings,
    #[command(flatten)]
    family: FamilyOptions,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Maximum number of evaluations
    #[arg(long, value_name = "N", default_value_t = 150_000, value_parser = clap::value_parser!(u64).range(1..))]
    budget: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Exit with status 3 unless the motion reaches its goal within all limits and joint ranges
    #[arg(long)]
    require: bool,
    /// Also print the motion as an entry for results/best-known.toml
    #[arg(long)]
    entry: bool,
    #[command(flatten)]
    files: MotionFiles,
}

/// Says what is doubtful about a task's weights.
pub(super) fn warn_of_weights(task: &Task) {
    if task.base_weight >= 1.0 {
        note!("warning: `weights.base` is 1, so time weighs nothing and the duration is arbitrary");
    }
}

impl Plan {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_worker_threads()?;
        self.files.check()?;
        let document = read_task(self.file.as_deref())?;
        let planner = Planner::read(&document, self.family.choice(), self.optimiser.clone())?;
        warn_of(&planner.task().robot);
        self.files.check_joints(&planner.task().robot)?;
        if planner.changes_load() {
            self.files.check_changing_load()?;
        }
        if planner.is_mission() {
            return self.plan_mission(&planner);
        }
        if let Some(residual) = planner.task().already_there() {
            return self.tell_already_there(planner.task(), residual);
        }
        warn_of_weights(planner.task());
        let found = {
            let watch = watch();
            let _bar = Bar::new(self.budget, watch.clone());
            planner.plan(self.seed, self.budget, &watch)?
        };
        self.finish(&found, &planner.file().task)
    }

    /// Plans a task of several motions.
    fn plan_mission(&self, planner: &Planner) -> Result<(), CliError> {
        warn_of_weights(planner.task());
        let found = {
            let watch = watch();
            let _bar = Bar::new(self.budget, watch.clone());
            planner.plan_mission(self.seed, self.budget, &watch)?
        };
        if found.is_complete && found.legs.is_empty() {
            let Task { start, goal, .. } = &**planner.task();
            return self.tell_already_there(planner.task(), start.base.angle_to(&goal.base));
        }
        if self.entry {
            note!("note: a task of several motions has no entry");
        }
        let task = &planner.file().task;
        if self.json {
            let json = found.json(&self.asked(task));
            say_json(&json)?;
        } else {
            say!(
                "{} by {}, seed {}",
                shown(self.file.as_ref(), ""),
                self.optimiser.name(),
                self.seed
            );
            if let Some(inheritance) = task.inheritance() {
                say!("  not stated     {inheritance}");
            }
            say!("{}", mission_told(&found));
        }
        for leg in &found.legs {
            let LegMotion::Planned(planned) = &leg.motion else { continue };
            if let Some(failure) = &planned.failure {
                note!("{}: warning: the search failed: {failure}", leg.name);
            }
            let budget = self.budget / planner.stops() as u64;
            for remark in planned.remark(budget).into_iter().chain(planned.overlap()) {
                note!("{}: {remark}", leg.name);
            }
        }
        let record = |sampling| found.record(sampling);
        let sample = |intervals| found.sample(|_| intervals);
        self.files.write_samples(planner.task(), record, sample)?;
        if found.interrupted {
            return Err(CliError::Interrupted("these are the motions so far".to_owned()));
        }
        if self.require && !found.is_reached() {
            let message = "does not reach all stops within all limits and ranges";
            return Err(CliError::Required(message.to_owned()));
        }
        Ok(())
    }

    fn asked(&self, task: &TaskTable) -> Asked<'_> {
        Asked {
            task: shown(self.file.as_ref(), "xiao2023"),
            inherited: task.inherited(),
            optimiser: self.optimiser.name(),
            seed: self.seed,
        }
    }

    /// Says that there is nothing to plan.
    fn tell_already_there(&self, task: &Task, residual: f64) -> Result<(), CliError> {
        self.files.tell_unwritten();
        let (residual_deg, tolerance_deg) = (residual.to_degrees(), task.goal_tolerance_deg());
        if self.json {
            let json = serde_json::json!({
                "task": shown(self.file.as_ref(), "xiao2023"),
                "already_there": true,
                "status": Reach::Reached,
                "reached": true,
                "tolerance_deg": tolerance_deg,
                "within_limits": true,
                "t_f": 0.0,
                "residual_deg": residual_deg,
            });
            say_json(&json)?;
        } else {
            say!(
                "{}: already there: all joints stand at their goals, and the base is {residual_deg:.6}° from its goal (within \
                 {tolerance_deg}°)",
                shown(self.file.as_ref(), "the paper's task")
            );
        }
        Ok(())
    }

    /// Says what was found, as JSON or to people, and writes the files that were asked for.
    fn finish(&self, found: &Planned, task: &TaskTable) -> Result<(), CliError> {
        if self.json {
            let json = found.json(self.asked(task));
            say_json(&json)?;
        } else {
            let file = shown(self.file.as_ref(), "the paper's task");
            say!("{file} by {}, seed {}", self.optimiser.name(), self.seed);
            if let Some(inheritance) = task.inheritance().filter(|_| self.file.is_some()) {
                say!("  not stated     {inheritance}");
            }
            say!("{}", told(found));
        }
        if let Some(failure) = &found.failure {
            note!("warning: the search failed: {failure}");
        }
        for remark in found.remark(self.budget).into_iter().chain(found.overlap()) {
            note!("{remark}");
        }
        self.say_entry(found, task);
        self.files.write(&*found.problem, &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        if self.require && found.reach != Reach::Reached {
            return Err(CliError::Required(found.verdict()));
        }
        Ok(())
    }

    /// Says how the motion stands in the file of the best known: where it should, or was asked to.
    fn say_entry(&self, found: &Planned, task: &TaskTable) {
        let (problem, cost) = (&*found.problem, found.assessment.cost);
        let beaten = BestKnown::of(problem).filter(|known| known.is_beaten_by(cost));
        if let Some(known) = beaten {
            note!("warning: J {cost:.9} is below the best known, {}", known.j);
        }
        if self.entry || beaten.is_some() {
            let Accuracy { attitude_steps, peak_intervals } = problem.accuracy();
            let family = match problem.spec() {
                FamilySpec::SinePolynomial { .. } => String::new(),
                FamilySpec::Spline { pieces, degree } => {
                    format!(" --family spline --pieces {pieces} --degree {degree}")
                }
            };
            let found_by = format!(
                "driftless plan --optimiser {} --seed {} --budget {}{family}, attitude_steps = \
                 {attitude_steps}, peak_intervals = {peak_intervals}",
                self.optimiser.name(),
                self.seed,
                self.budget
            );
            let (coefficients, assessment) = (&found.coefficients, &found.assessment);
            // A goal of the tool has several configurations, and the motion ends in one of them.
            let task = task.ending_with(problem.task());
            let entry = BestKnown::new(problem, task, coefficients, assessment, found_by);
            note!("the entry for results/best-known.toml:\n\n{entry}");
        }
    }
}

/// Reads the name of an optimiser.
fn optimisers() -> impl TypedValueParser<Value = Settings> {
    let names: Vec<&str> = Settings::all().iter().map(Settings::name).collect();
    PossibleValuesParser::new(names)
        .try_map(|name| Settings::by_name(&name).ok_or("expected the name of an optimiser"))
}
