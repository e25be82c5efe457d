//! `driftless check`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
#[cfg(feature = "harness")]
use std::time::Duration;

use clap::Args;
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::kind::{self, Kind, shipped};
use super::{CliError, say_json, warn_of};
use crate::input::Document;
use crate::reorientation::{ReplayFile, TaskFile};
use crate::robot::{Robot, RobotFile, ShapeSource};
use crate::words::plural;

/// Validate an input file and print it with every default filled in
#[derive(Debug, Args)]
pub(super) struct Check {
    /// Task, robot, motion or experiment file, or a URDF
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Do not estimate how long an experiment takes
    #[arg(long)]
    no_estimate: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What there is to say of a file that is as it should be.
struct Checked {
    kind: &'static str,
    /// The file with every default filled in, in TOML.
    resolved: String,
    /// For people, below it.
    remarks: Vec<String>,
    /// For programs, beside it.
    facts: Map<String, Value>,
}

impl Checked {
    fn new(kind: &'static str, file: &impl Serialize) -> Result<Self, CliError> {
        let resolved = toml::to_string(file)?;
        Ok(Self { kind, resolved, remarks: Vec::new(), facts: Map::new() })
    }

    fn with(mut self, key: &str, value: impl Into<Value>) -> Self {
        self.facts.insert(key.to_owned(), value.into());
        self
    }

    fn json(self, file: &Path) -> Result<Value, CliError> {
        let unreadable = |error: toml::de::Error| CliError::Resolved(error.to_string());
        let resolved: Value = toml::from_str(&self.resolved).map_err(unreadable)?;
        let mut json = json!({ "file": file.display().to_string(), "kind": self.kind });
        if let Some(json) = json.as_object_mut() {
            json.extend(self.facts);
            json.insert("resolved".to_owned(), resolved);
        }
        Ok(json)
    }

    fn say(&self) -> Result<(), CliError> {
        say!("# {}, with every default filled in", self.kind);
        say!("{}", self.resolved.trim_end());
        if !self.remarks.is_empty() {
            say!("\n# {}", self.remarks.join("\n# "));
        }
        Ok(())
    }
}

impl Check {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let document = if let Some((_, document)) = shipped(&self.file) {
            document
        } else {
            kind::refuse_others(&self.file, Kind::Description)?;
            Document::read(&self.file)?
        };
        let checked = match Kind::of(&document)? {
            Some(Kind::Robot) => check_robot(&document)?,
            Some(Kind::Motion) => {
                let file = ReplayFile::read(&document)?;
                warn_of(&file.build(&document)?.problem.task().robot);
                Checked::new("motion", &file)?
            }
            Some(Kind::Experiment) => check_experiment(&document, !self.no_estimate)?,
            _ => check_task(&document)?,
        };
        if self.json { say_json(&checked.json(&self.file)?) } else { checked.say() }
    }
}

fn check_robot(document: &Document) -> Result<Checked, CliError> {
    let file = RobotFile::read(document)?;
    let mut checked = Checked::new("robot", &file)?;
    let (meshes, links) = file.links_with_meshes_alone();
    let meshes_told = words_for_meshes(meshes, links);
    if let Some(root) = file.root_without_mass() {
        note!(
            "note: `{root}`, the root of the robot, has no mass; a task gives it a base by `[task.base]`"
        );
        checked.remarks.extend(meshes_told);
        return Ok(checked.with("root_without_mass", root).with("links_with_meshes_alone", meshes));
    }
    let robot = file.build(document)?;
    warn_of(&robot);
    let (source, counts) = shapes(&robot);
    checked.remarks.push(words_for_shapes(source, &counts));
    checked.remarks.extend(meshes_told);
    let counts: Map<String, Value> =
        counts.into_iter().map(|(name, count)| (name, count.into())).collect();
    Ok(checked
        .with("name", robot.name())
        .with("joints", robot.joint_count())
        .with("mass_kg", robot.total_mass())
        .with("shapes", json!({ "source": source, "bodies": counts }))
        .with("links_with_meshes_alone", meshes))
}

fn check_task(document: &Document) -> Result<Checked, CliError> {
    let file = TaskFile::read(document)?.planned();
    let problem = if file.task.is_mission() {
        let mission = file.task.mission(document)?;
        file.trajectory.build(Arc::new(mission.ends), document)?
    } else {
        file.problem(document)?
    };
    let robot = &problem.task().robot;
    warn_of(robot);
    let mut checked = Checked::new("task", &file.resolved(&problem))?;
    let tool = problem.task().tool_at_start();
    let position = tool.translation.vector;
    let (roll, pitch, yaw) = tool.rotation.euler_angles();
    let zyx_deg = [yaw, pitch, roll].map(f64::to_degrees);
    checked.remarks.push(format!(
        "the tool starts at position_m = [{:.4}, {:.4}, {:.4}], zyx_deg = [{:.3}, {:.3}, {:.3}] in inertial axes",
        position.x, position.y, position.z, zyx_deg[0], zyx_deg[1], zyx_deg[2]
    ));
    Ok(checked
        .with("robot", robot.name())
        .with("joints", robot.joint_count())
        .with("tool_at_start", json!({ "position_m": position.as_slice(), "zyx_deg": zyx_deg })))
}

#[cfg(feature = "harness")]
fn check_experiment(document: &Document, estimate: bool) -> Result<Checked, CliError> {
    use super::run::default_jobs;
    use super::submit::WORKERS;
    use super::warnings::{warn_of_budgets, warn_of_subjects};
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
    let fewest = own.clone().min().unwrap_or(experiment.seeds());
    let most = own.max().unwrap_or(experiment.seeds());
    let seeds = if fewest < most { format!("{fewest} to {most}") } else { most.to_string() };
    let (instances, optimisers) = (plan.instances.len(), plan.optimisers.len());
    let mut remarks = vec![format!(
        "{}: {} × {} × {seeds} {}",
        plural(plan.runs.len(), "run"),
        plural(instances, "instance"),
        plural(optimisers, "optimiser"),
        if seeds == "1" { "seed" } else { "seeds" }
    )];
    let resolved = plan.experiment.to_toml().map_err(CliError::Resolved)?;
    let checked = Checked { kind: "experiment", resolved, remarks: Vec::new(), facts: Map::new() };
    let mut checked = checked
        .with("name", plan.name.as_str())
        .with("runs", plan.runs.len())
        .with("instances", instances)
        .with("optimisers", optimisers)
        .with("seeds", json!([fewest, most]));
    if estimate {
        let jobs = default_jobs();
        let estimate = experiment::estimate(&plan, jobs)?;
        let time = estimate.time(jobs).max(Duration::from_secs(1));
        let rest =
            if estimate.is_partial() { ", without the runs that start programs" } else { "" };
        remarks.push(format!(
            "about {} on {} (measured just now){rest}",
            HumanDuration(time),
            plural(jobs, "thread")
        ));
        let shards = estimate.shards(WORKERS, 1);
        if shards.most > 1 {
            remarks.push(words_for_shards(shards, WORKERS));
        }
        checked = checked
            .with("jobs", jobs)
            .with("time_s", estimate.time(jobs).as_secs_f64())
            .with("is_partial", estimate.is_partial())
            .with("shards", json!([shards.fewest, shards.most]));
    }
    checked.remarks = remarks;
    Ok(checked)
}

/// How many shards make sense.
#[cfg(feature = "harness")]
fn words_for_shards(sensible: crate::experiment::Sensible, workers: usize) -> String {
    let crate::experiment::Sensible { fewest, most, idle_with_one_each, .. } = sensible;
    let idle = (100.0 * idle_with_one_each).max(0.0);
    let range = if fewest == most { most.to_string() } else { format!("{fewest} to {most}") };
    format!(
        "{range} shards make sense for {workers} workers of a scheduler; with one shard each, the workers would be idle for {idle:.0} % \
         of the time"
    )
}

#[cfg(not(feature = "harness"))]
fn check_experiment(_: &Document, _: bool) -> Result<Checked, CliError> {
    let message = "this is an experiment; this build leaves experiments out".to_owned();
    Err(CliError::Usage { message, help: None })
}

/// Where a robot's shapes come from, and how many each body that has some has.
fn shapes(robot: &Robot) -> (ShapeSource, Vec<(String, usize)>) {
    let (shaped, source) = robot.with_shapes();
    let links = shaped.links().iter().map(|link| (link.name.as_str(), &link.body));
    let bodies = std::iter::once(("base", shaped.base())).chain(links);
    let counts = bodies.filter(|(_, body)| !body.shapes.is_empty());
    (source, counts.map(|(name, body)| (name.to_owned(), body.shapes.len())).collect())
}

fn words_for_shapes(source: ShapeSource, counts: &[(String, usize)]) -> String {
    let counts: Vec<String> =
        counts.iter().map(|(name, count)| format!("{name} {count}")).collect();
    let source = match source {
        ShapeSource::Stated => "stated",
        ShapeSource::Derived => "derived, since none are stated",
    };
    format!("shapes ({source}): {}", counts.join(", "))
}

/// How many links have no shape for having meshes instead, if any.
fn words_for_meshes(meshes: usize, links: usize) -> Option<String> {
    let verb = if meshes == 1 { "has" } else { "have" };
    (meshes > 0).then(|| {
        let links = plural(links, "link");
        format!("{meshes} of {links} {verb} no shape: their collision geometry is a mesh")
    })
}
