//! `driftless export`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::CliError;
use super::results::{Results, ResultsFolder, no_results};
use crate::analysis;
use crate::export::{Suite, SuiteFormat, write_suite};

/// Write an experiment's runs in a format that other benchmarking tools read
#[derive(Debug, Args)]
pub(super) struct Export {
    #[command(flatten)]
    results: ResultsFolder,
    /// Format to write
    #[arg(long, value_enum)]
    format: SuiteFormat,
    /// Folder to write; it may exist, but only empty
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

impl Export {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let Results { folder, plan, store } = self.results.open()?;
        let runs = analysis::load(&plan, &store)?;
        if runs.is_empty() {
            return Err(no_results(&folder, "none of its experiment's runs"));
        }
        if runs.len() < plan.runs.len() {
            eprintln!("note: {} of {} runs are stored so far", runs.len(), plan.runs.len());
        }
        let suite = Suite::new(&plan, &runs)?;
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
