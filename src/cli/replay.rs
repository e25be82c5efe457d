//! `driftless replay`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::kind::{Kind, read_or, read_task};
use super::motion::{MotionFiles, Told};
use super::replayed::Trajectory;
use super::{CliError, say_json, shown, start_worker_threads};
use crate::reorientation::{
    AngleUnit, AssessmentJson, Excursions, ExcursionsJson, GivenTrajectory, Published, Reading,
    Record, ReplayFile, Replayed, Sampling, ShapeJson, TaskFile,
};
use crate::task::Task;

/// Evaluate a given motion; without a file, the one published by Xiao et al. (2023)
#[derive(Debug, Args)]
pub(super) struct Replay {
    /// Motion file, or a trajectory: a ROS JointTrajectory in .yaml or .json, or a table in .csv or .parquet with either a row
    /// for each time and a column for each joint, or a row for each time and joint [default: the published motion]
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    #[command(flatten)]
    reading: TrajectoryOptions,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    files: MotionFiles,
}

/// How a trajectory is read.
#[derive(Debug, Args)]
pub(super) struct TrajectoryOptions {
    /// Task of a trajectory [default: the paper's]
    #[arg(long, value_name = "TASK")]
    pub(super) task: Option<PathBuf>,
    /// Unit of angles in a table whose column names do not state one
    #[arg(long)]
    unit: Option<Unit>,
}

impl TrajectoryOptions {
    /// Refuses options that have no effect on what is not a trajectory.
    pub(super) fn check_unused(&self) -> Result<(), CliError> {
        for (option, is_given) in [("task", self.task.is_some()), ("unit", self.unit.is_some())] {
            if is_given {
                let message = format!(
                    "found --{option}, which is for a trajectory in .yaml, .json, .csv or .parquet"
                );
                return Err(CliError::Usage { message, help: None });
            }
        }
        Ok(())
    }

    /// A trajectory and its task.
    pub(super) fn read(&self, file: &Path) -> Result<(Task, GivenTrajectory), CliError> {
        let document = read_task(self.task.as_deref())?;
        let table = TaskFile::read(&document)?.task;
        if table.is_mission()
            && let Some(span) = table.mission(&document)?.load_change()
        {
            let message = "found a load that changes during the motion, expected a task with the same load throughout";
            return Err(document.error_at(span, message, None).into());
        }
        let robot = table.robot(&document)?;
        let unit = self.unit.map(|unit| match unit {
            Unit::Rad => AngleUnit::Rad,
            Unit::Deg => AngleUnit::Deg,
        });
        let trajectory = GivenTrajectory::read(file, &robot, unit);
        let trajectory = trajectory.map_err(|error| match error.into() {
            CliError::Usage { message, .. } if self.task.is_none() => {
                let help =
                    "it was read as a motion of the paper's robot; --task names another task";
                CliError::Usage { message, help: Some(help.to_owned()) }
            }
            error => error,
        })?;
        let table = if table.moves() {
            table.with_least_duration(trajectory.points.duration())
        } else {
            table
        };
        Ok((table.build_ends(&document)?, trajectory))
    }
}

/// Units of angles.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Unit {
    /// Radians
    Rad,
    /// Degrees
    Deg,
}

#[derive(Debug, Serialize)]
struct ReplayJson {
    published: PublishedJson,
    readings: Vec<ReadingJson>,
}

#[derive(Debug, Serialize)]
struct PublishedJson {
    #[serde(flatten)]
    shape: ShapeJson,
    t_f: f64,
    j: Option<f64>,
    #[serde(flatten)]
    excursions: ExcursionsJson,
}

#[derive(Debug, Serialize)]
struct ReadingJson {
    reading: Reading,
    #[serde(flatten)]
    assessment: AssessmentJson,
}

impl Replay {
    pub(super) fn execute(self) -> Result<(), CliError> {
        self.files.check()?;
        if let Some(file) = self.file.as_deref().filter(|file| GivenTrajectory::has_name(file)) {
            return self.replay_trajectory(file);
        }
        self.reading.check_unused()?;
        let document = read_or(self.file.as_deref(), Kind::Motion, ReplayFile::paper)?;
        let published = ReplayFile::read(&document)?.build(&document)?;
        self.files.check_joints(&published.problem.task().robot)?;
        let Published { problem, coefficients, duration, .. } = &published;
        let excursions = Excursions::on_the_way(&**problem, coefficients, *duration);
        let task = problem.task();
        if self.json {
            say_json(&json(&published, &excursions))?;
        } else {
            say!("{}", shown(self.file.as_ref(), "the solution published by Xiao et al. (2023)"));
            if let Some(claim) = published.cost {
                say!("claimed: J {claim}, duration {} s", published.duration);
            }
            for (reading, assessment) in published.readings() {
                say!("read {}:", reading.meaning());
                say!("{}", Told { task, assessment: &assessment, excursions: &excursions });
            }
        }
        self.files.write(&*published.problem, &published.coefficients, published.duration)
    }

    fn replay_trajectory(&self, file: &Path) -> Result<(), CliError> {
        start_worker_threads()?;
        let (task, trajectory) = self.reading.read(file)?;
        self.files.check_joints(&task.robot)?;
        let replayed = Replayed::new(&task, &trajectory.points);
        let task_name = shown(self.reading.task.as_ref(), "the paper's task");
        let told = Trajectory { file, task: &task_name, replayed: &replayed };
        if self.json {
            told.say_json(&trajectory.ignored)?;
        } else {
            say!("{told}");
        }
        if !self.json && !trajectory.ignored.is_empty() {
            note!("note: these columns are not read: {}", trajectory.ignored.join(", "));
        }
        let record = |sampling: Option<Sampling>| {
            let at_points = if sampling.is_none() { replayed.at_points() } else { None };
            if let Some(motion) = at_points {
                return Ok(Record::new(&task.robot, motion));
            }
            let sampling = sampling.unwrap_or_default();
            sampling.check(trajectory.points.duration())?;
            Ok(Record::new(&task.robot, replayed.sample(sampling)))
        };
        self.files.write_samples(&task, record, |intervals| replayed.sample(intervals))
    }
}

fn json(published: &Published, excursions: &Excursions) -> ReplayJson {
    let Published { problem, coefficients, duration, cost } = published;
    let peaks = problem.certify(coefficients, Some(*duration)).peaks;
    let excursions = ExcursionsJson::new(excursions, problem.task(), &peaks);
    let readings = published.readings().into_iter();
    let readings = readings.map(|(reading, assessment)| {
        let assessment = AssessmentJson::new(&assessment, &problem.task().robot);
        ReadingJson { reading, assessment }
    });
    ReplayJson {
        published: PublishedJson {
            shape: ShapeJson::new(&**problem, coefficients, *duration),
            t_f: *duration,
            j: *cost,
            excursions,
        },
        readings: readings.collect(),
    }
}
