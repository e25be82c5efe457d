//! `driftless export`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::json;

use super::results::{ResultsFolder, no_results};
use super::sampling::SamplingOptions;
use super::warnings::warn_of_damage;
use super::{CliError, say_json};
use crate::experiment::{Plan, Run, load, standing};
use crate::export::{Suite, SuiteFormat, write_suite};
use crate::reorientation::{MotionFormat, TaskSubject, write_motions};
use crate::words::plural;

/// Export the runs of an experiment for other benchmarking tools, or its best motions
#[derive(Debug, Args)]
pub(super) struct Export {
    #[command(flatten)]
    results: ResultsFolder,
    /// Format to write
    #[arg(long, value_enum)]
    format: Format,
    /// Folder to write, new or empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    sampling: SamplingOptions,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// The runs for IOHprofiler, read by iohinspector
    Ioh,
    /// The runs for COCO, read by cocopp
    Coco,
    /// The best motion of every instance as CSV with a row for each time and joint
    Csv,
    /// The best motion of every instance as CSV with a row for each time
    WideCsv,
    /// The best motion of every instance as Parquet with a row for each time and joint
    Parquet,
    /// The best motion of every instance for MATLAB
    Mat,
    /// The best motion of every instance as a ROS JointTrajectory message
    Yaml,
    /// The best motion of every instance as a goal for ROS 2's FollowJointTrajectory action
    GoalYaml,
    /// The best motion of every instance as a folder with a MuJoCo model that plays it
    Mujoco,
}

/// What a format is of.
enum Kind {
    Runs(SuiteFormat),
    Motions(MotionFormat),
}

impl Format {
    fn kind(self) -> Kind {
        match self {
            Self::Ioh => Kind::Runs(SuiteFormat::Ioh),
            Self::Coco => Kind::Runs(SuiteFormat::Coco),
            Self::Csv => Kind::Motions(MotionFormat::Csv),
            Self::WideCsv => Kind::Motions(MotionFormat::WideCsv),
            Self::Parquet => Kind::Motions(MotionFormat::Parquet),
            Self::Mat => Kind::Motions(MotionFormat::Mat),
            Self::Yaml => Kind::Motions(MotionFormat::Yaml),
            Self::GoalYaml => Kind::Motions(MotionFormat::GoalYaml),
            Self::Mujoco => Kind::Motions(MotionFormat::Mujoco),
        }
    }
}

impl Export {
    pub(super) fn execute(self) -> Result<(), CliError> {
        if let Kind::Runs(_) = self.format.kind() {
            self.sampling.check_unused("a format of motions, such as csv")?;
        }
        let folder = self.results.open()?;
        let (plan, runs) = (&folder.plan, load(&folder.plan, &folder.store)?);
        warn_of_damage(&folder.store);
        if runs.is_empty() {
            return Err(match standing(plan, &folder.store)?.unread() {
                Some(message) => CliError::Usage { message, help: None },
                None => no_results(folder.path(), "none of its experiment's runs"),
            });
        }
        if runs.len() < plan.runs.len() {
            let planned = plural(plan.runs.len(), "run");
            note!("note: {} of {planned} are stored so far", runs.len());
        }
        match self.format.kind() {
            Kind::Runs(format) => self.write_runs(format, plan, &runs),
            Kind::Motions(format) => self.write_motions(format, plan, &runs),
        }
    }

    fn write_runs(&self, format: SuiteFormat, plan: &Plan, runs: &[Run]) -> Result<(), CliError> {
        let suite = Suite::new(plan, runs)?;
        write_suite(&self.out, format, &suite)?;
        let failed = runs.iter().filter(|run| !run.cost.is_finite()).count();
        if failed > 0 {
            note!(
                "warning: {} failed; what they had found is exported like that of others, which the formats do not tell apart",
                plural(failed, "run")
            );
        }
        if suite.renumbered > 0 {
            note!(
                "note: {} of functions and instances were replaced by the next free one, as another of this experiment has \
                 the same; in other experiments they may stand for something else",
                plural(suite.renumbered, "number")
            );
        }
        if self.json {
            return say_json(&json!({
                "folder": self.out.display().to_string(),
                "runs": suite.trials.len(),
                "failed": failed,
                "optimisers": suite.algorithms.len(),
                "functions": suite.functions.len(),
                "renumbered": suite.renumbered,
                "read_by": reader(format, &self.out),
            }));
        }
        say!(
            "{}: {} of {} on {}",
            self.out.display(),
            plural(suite.trials.len(), "run"),
            plural(suite.algorithms.len(), "optimiser"),
            plural(suite.functions.len(), "function")
        );
        say!("read it with\n  {}", reader(format, &self.out));
        Ok(())
    }

    fn write_motions(
        &self,
        format: MotionFormat,
        plan: &Plan,
        runs: &[Run],
    ) -> Result<(), CliError> {
        if plan.instances.iter().all(|instance| TaskSubject::of(instance).is_none()) {
            let message = "the problems of this experiment have no motions".to_owned();
            return Err(CliError::Usage { message, help: Some("expected ioh or coco".to_owned()) });
        }
        let written = write_motions(&self.out, format, self.sampling.choice(), plan, runs)?;
        if self.json {
            say_json(&json!({
                "folder": self.out.display().to_string(),
                "motions": written.motions,
                "missed": written.missed,
                "tolerance_deg": written.tolerance_deg,
            }))?;
        } else {
            let instances = plural(written.motions, "instance");
            say!("{}: the best motions of {instances}", self.out.display());
        }
        if written.missed > 0 {
            let verb = if written.missed == 1 { "ends" } else { "end" };
            note!(
                "warning: {} {verb} more than {}° from the goal; the table `best` of the report has all residuals",
                plural(written.missed, "motion"),
                written.tolerance_deg
            );
        }
        Ok(())
    }
}

/// The command that reads what was written, with Python and one package.
fn reader(format: SuiteFormat, out: &Path) -> String {
    // As Python and then a shell reads it.
    let out = format!("{:?}", out.display().to_string());
    let code = match format {
        SuiteFormat::Ioh => format!(
            "import iohinspector; manager = iohinspector.DataManager(); \
             manager.add_folder({out}); print(manager.overview)"
        ),
        SuiteFormat::Coco => format!(
            "import cocopp, glob; \
             cocopp.testbedsettings.suite_to_testbed['driftless'] = 'GECCOBBOBTestbed'; \
             print(list(cocopp.pproc.DataSetList(glob.glob({out} + '/*/*.info'))))"
        ),
    };
    format!("python -c {}", shell_words::quote(&code))
}
