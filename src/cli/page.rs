//! The page that `driftless report` writes.

use std::path::Path;

use super::CliError;
use super::results::EXPERIMENT;
use crate::analysis::Run;
use crate::analysis::tables::Table;
use crate::experiment::{Plan, Store};
use crate::output::write_file;
use crate::plot::Chart;
use crate::report::{Page, provenance, scenes, verdict};

/// What the page is called.
const PAGE: &str = "report.html";

/// Writes an experiment's page into its folder.
pub(super) fn write_page(
    plan: &Plan,
    store: &Store,
    runs: &[Run],
    tables: &[Table],
    charts: &[Chart],
    folder: &Path,
) -> Result<(), CliError> {
    let page = Page {
        name: &plan.name,
        verdict: &verdict(plan, runs, tables)?,
        scenes: &scenes(plan, runs),
        charts,
        tables,
        files: &files(folder),
        facts: &provenance(plan, store)?,
    };
    Ok(write_file(&folder.join(PAGE), page.html()?.as_bytes())?)
}

/// The files that made the experiment, of those that are there.
fn files(folder: &Path) -> Vec<(String, String)> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let files = [EXPERIMENT, "robot.toml"].into_iter();
    files.filter_map(|name| Some((name.to_owned(), text(name)?))).collect()
}
