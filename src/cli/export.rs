//! `driftless export`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::CliError;
use super::results::{ResultsFolder, no_results};
use super::warnings::warn_of_damage;
use crate::exhibit::words::plural;
use crate::experiment::{Plan, Run, load, standing};
use crate::export::{Suite, SuiteFormat, write_suite};
use crate::reorientation::{MotionFormat, TaskSubject, write_motions};

/// Write an experiment's runs as other benchmarking tools read them, or its best motions
#[derive(Debug, Args)]
pub(super) struct Export {
    #[command(flatten)]
    results: ResultsFolder,
    /// Format to write
    #[arg(long, value_enum)]
    format: Format,
    /// Folder to write; it may exist, but only empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// The runs for IOHprofiler, read by iohinspector
    Ioh,
    /// The runs for COCO, read by cocopp
    Coco,
    /// The best motion of every instance as comma-separated values
    Csv,
    /// The best motion of every instance as Parquet
    Parquet,
    /// The best motion of every instance as ROS JointTrajectory
    Yaml,
}

impl Export {
    pub(super) fn execute(self) -> Result<(), CliError> {
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
            note!("note: {} of {} runs are stored so far", runs.len(), plan.runs.len());
        }
        match self.format {
            Format::Ioh => self.write_runs(SuiteFormat::Ioh, plan, &runs),
            Format::Coco => self.write_runs(SuiteFormat::Coco, plan, &runs),
            Format::Csv => self.write_motions(MotionFormat::Csv, plan, &runs),
            Format::Parquet => self.write_motions(MotionFormat::Parquet, plan, &runs),
            Format::Yaml => self.write_motions(MotionFormat::Yaml, plan, &runs),
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
                "note: {} functions or instances have the next free number, as another of this experiment has their own; \
                 in other experiments these numbers may stand for something else",
                suite.renumbered
            );
        }
        say!(
            "{}: {} runs of {} optimisers on {} functions",
            self.out.display(),
            suite.trials.len(),
            suite.algorithms.len(),
            suite.functions.len()
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
        let written = write_motions(&self.out, format, plan, runs)?;
        let instances = plural(written.motions, "instance");
        say!("{}: the best motions of {instances}", self.out.display());
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
