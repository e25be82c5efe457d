//! `driftless check`.

use std::path::PathBuf;
use std::sync::Arc;
#[cfg(feature = "harness")]
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use super::{CliError, read_robot_or, warn_of};
use crate::input::{Document, InputError};
use crate::reorientation::{ReplayFile, TaskFile};
use crate::robot::{Robot, RobotFile, ShapeSource};

/// Say what is wrong with an input file, or print it resolved
#[derive(Debug, Args)]
pub(super) struct Check {
    /// A task, robot, replay or experiment file, or a URDF
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Do not measure how long an experiment takes
    #[arg(long)]
    no_estimate: bool,
}

/// What a file is, told by its top-level keys.
enum Kind {
    Robot,
    Replay,
    Experiment,
    Task,
}

/// Keys that only an experiment has.
const EXPERIMENT_KEYS: [&str; 7] =
    ["name", "optimiser", "seeds", "budget", "sweep", "targets", "functions"];

impl Kind {
    fn of(document: &Document) -> Result<Self, InputError> {
        let has = |keys: &[&str]| -> Result<bool, InputError> {
            keys.iter().try_fold(false, |found, key| Ok(found || document.key(key)?.is_some()))
        };
        Ok(if document.is_xml() || has(&["joint", "base", "link", "urdf", "arm"])? {
            Self::Robot
        } else if has(&["motion"])? {
            Self::Replay
        } else if has(&EXPERIMENT_KEYS)? {
            Self::Experiment
        } else {
            Self::Task
        })
    }
}

/// Whether a file that is read as a task is one.
pub(super) fn expect_task(document: &Document, verb: &str) -> Result<(), CliError> {
    let found = match Kind::of(document)? {
        Kind::Task => return Ok(()),
        Kind::Robot => "a robot",
        Kind::Replay => "a motion to replay",
        Kind::Experiment => "an experiment",
    };
    Err(CliError::Usage {
        message: format!("{} is {found}, and `{verb}` takes a task", document.path.display()),
        help: (found == "a robot").then(|| {
            let robot = document.path.display();
            format!(
                "a task names it: `[task]` with `robot = \"{robot}\"`, a start, a goal and limits"
            )
        }),
    })
}

impl Check {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let document = read_robot_or(&self.file)?;
        match Kind::of(&document)? {
            Kind::Robot => {
                let file = RobotFile::read(&document)?;
                if let Some(root) = file.root_without_mass() {
                    print_resolved("robot", &file)?;
                    if let Some(meshes) = words_for_meshes(&file) {
                        say!("\n{meshes}");
                    }
                    note!(
                        "note: `{root}`, the root of the robot, has no mass; a task gives it a base by `[task.base]`"
                    );
                    return Ok(());
                }
                let robot = file.build(&document)?;
                print_resolved("robot", &file)?;
                say!("\n{}", words_for_shapes(&robot));
                if let Some(meshes) = words_for_meshes(&file) {
                    say!("{meshes}");
                }
                warn_of(&robot);
            }
            Kind::Replay => {
                let file = ReplayFile::read(&document)?;
                warn_of(&file.build(&document)?.problem.task().robot);
                print_resolved("motion to replay", &file)?;
            }
            Kind::Task => {
                let file = TaskFile::read(&document)?.planned();
                let problem = if file.task.is_mission() {
                    let mission = file.task.mission(&document)?;
                    file.trajectory.build(Arc::new(mission.ends), &document)?
                } else {
                    file.problem(&document)?
                };
                warn_of(&problem.task().robot);
                print_resolved("task", &file.resolved(&problem))?;
            }
            Kind::Experiment => check_experiment(&document, !self.no_estimate)?,
        }
        Ok(())
    }
}

#[cfg(feature = "harness")]
fn check_experiment(document: &Document, estimate: bool) -> Result<(), CliError> {
    use super::run::default_jobs;
    use super::submit::WORKERS;
    use super::warnings::{warn_of_budgets, warn_of_subjects};
    use crate::exhibit::words::plural;
    use crate::experiment::{self, Experiment};
    use crate::registry::registry;
    use indicatif::HumanDuration;
    let experiment = Experiment::read(document, &registry())?;
    let plan = experiment.plan()?;
    warn_of_subjects(&plan);
    warn_of_budgets(&plan);
    for (command, _) in experiment.programs() {
        if let Err(failure) = command.check_program() {
            note!("warning: {failure}");
        }
    }
    let own = plan.optimisers.iter().map(|entrant| entrant.seeds.unwrap_or(experiment.seeds()));
    let seeds = match (own.clone().min(), own.max()) {
        (Some(fewest), Some(most)) if fewest < most => format!("{fewest} to {most}"),
        _ => experiment.seeds().to_string(),
    };
    say!("# experiment, with every default filled in");
    say!("{}", plan.experiment.to_toml().map_err(CliError::Resolved)?.trim_end());
    let (instances, optimisers) = (plan.instances.len(), plan.optimisers.len());
    say!(
        "\n# {}: {} × {} × {seeds} {}",
        plural(plan.runs.len(), "run"),
        plural(instances, "instance"),
        plural(optimisers, "optimiser"),
        if seeds == "1" { "seed" } else { "seeds" }
    );
    if estimate {
        let jobs = default_jobs();
        let estimate = experiment::estimate(&plan, jobs)?;
        let time = estimate.time(jobs).max(Duration::from_secs(1));
        let threads = if jobs == 1 { "thread" } else { "threads" };
        let rest =
            if estimate.is_partial() { ", without the runs that start programs" } else { "" };
        say!("# about {} on {jobs} {threads} (measured just now){rest}", HumanDuration(time));
        let shards = estimate.shards(WORKERS, 1);
        if shards.most > 1 {
            say!("# {}", words_for_shards(shards, WORKERS));
        }
    }
    Ok(())
}

/// How many shards make sense.
#[cfg(feature = "harness")]
fn words_for_shards(sensible: crate::experiment::Sensible, workers: usize) -> String {
    let crate::experiment::Sensible { fewest, most, idle_with_one_each, .. } = sensible;
    let idle = (100.0 * idle_with_one_each).max(0.0);
    let range = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    format!(
        "{range} shards make sense for {workers} workers of a scheduler; with one each they would be idle for {idle:.0} % \
         of the time"
    )
}

#[cfg(not(feature = "harness"))]
fn check_experiment(_: &Document, _: bool) -> Result<(), CliError> {
    let message = "this is an experiment; this build leaves experiments out".to_owned();
    Err(CliError::Usage { message, help: None })
}

/// Where a robot's shapes come from, and how many each body has.
fn words_for_shapes(robot: &Robot) -> String {
    let (shaped, source) = robot.with_shapes();
    let links = shaped.links().iter().map(|link| (link.name.as_str(), &link.body));
    let bodies = std::iter::once(("base", shaped.base())).chain(links);
    let counts: Vec<String> = bodies
        .filter(|(_, body)| !body.shapes.is_empty())
        .map(|(name, body)| format!("{name} {}", body.shapes.len()))
        .collect();
    let source = match source {
        ShapeSource::Stated => "stated",
        ShapeSource::Derived => "derived, since none are stated",
    };
    format!("# shapes ({source}): {}", counts.join(", "))
}

/// How many links have no shape for having meshes instead, if any.
fn words_for_meshes(file: &RobotFile) -> Option<String> {
    let (meshes, links) = file.links_with_meshes_alone();
    let verb = if meshes == 1 { "has" } else { "have" };
    (meshes > 0).then(|| {
        format!("# {meshes} of {links} links {verb} no shape: their collision geometry is a mesh")
    })
}

fn print_resolved(kind: &str, file: &impl Serialize) -> Result<(), CliError> {
    say!("# {kind}, with every default filled in");
    say!("{}", toml::to_string(file)?.trim_end());
    Ok(())
}
