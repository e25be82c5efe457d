//! `driftless export`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use crate::analysis;
use crate::experiment::{ExperimentFile, Plan, Store};
use crate::export::{Suite, SuiteFormat, write_suite};
use crate::input::Document;

/// Write an experiment's runs in a format that other benchmarking tools read
#[derive(Debug, Args)]
pub(super) struct Export {
    /// Results of an experiment, as `run` leaves them
    #[arg(value_name = "RESULTS_DIR")]
    results: PathBuf,
    /// Format to write
    #[arg(long, value_enum)]
    format: SuiteFormat,
    /// Folder to write; it may exist, but only empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Export {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let plan = stored_plan(&self.results)?;
        let store = Store::open(&self.results)?;
        let keys = || plan.runs.iter().map(|run| run.key.as_str());
        let runs = analysis::runs(&plan, &store.read("runs", keys())?)?;
        if runs.is_empty() {
            return Err(no_results(&self.results, "none of its experiment's runs"));
        }
        if runs.len() < plan.runs.len() {
            eprintln!("note: {} of {} runs are stored so far", runs.len(), plan.runs.len());
        }
        let suite = Suite::new(&plan, &runs, &store.read("traces", keys())?)?;
        write_suite(&self.out, self.format, &suite)?;
        say!(
            "{}: {} runs of {} optimisers on {} functions",
            self.out.display(),
            suite.trials.len(),
            suite.algorithms.len(),
            suite.functions.len()
        );
        say!("read it with\n  {}", reader(self.format, &self.out));
        Ok(())
    }
}

/// The experiment that a folder holds the results of.
fn stored_plan(folder: &Path) -> Result<Plan, CliError> {
    let path = folder.join("experiment.toml");
    if !path.is_file() {
        return Err(no_results(folder, "no experiment.toml"));
    }
    let document = Document::read(&path)?;
    let file = ExperimentFile::read(&document)?;
    Ok(Plan::new(&file, &document)?)
}

fn no_results(folder: &Path, found: &str) -> CliError {
    CliError::Usage {
        message: format!(
            "found {found} in {}, expected the results of an experiment",
            folder.display()
        ),
        help: Some("`driftless run` puts them into results/NAME or where --out says".to_owned()),
    }
}

/// The command that reads what was written, with Python and one package.
fn reader(format: SuiteFormat, out: &Path) -> String {
    let out = out.display();
    let code = match format {
        SuiteFormat::Ioh => format!(
            "import iohinspector; manager = iohinspector.DataManager(); \
             manager.add_folder('{out}'); print(manager.overview)"
        ),
        SuiteFormat::Coco => format!(
            "import cocopp, glob; \
             cocopp.testbedsettings.suite_to_testbed['driftless'] = 'GECCOBBOBTestbed'; \
             print(list(cocopp.pproc.DataSetList(glob.glob('{out}/*/*.info'))))"
        ),
    };
    format!("python -c \"{code}\"")
}
