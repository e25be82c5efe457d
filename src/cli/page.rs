//! The page that `driftless report` writes.

use std::path::Path;

use super::CliError;
use super::results::EXPERIMENT;
use crate::analysis::tables::Table;
use crate::analysis::{Run, convergence};
use crate::experiment::{Plan, Store};
use crate::output::write_file;
use crate::plot::{self, Chart};
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
    let path = folder.join(PAGE);
    write_file(&path, page.html()?.as_bytes())?;
    say!("page: {}", path.display());
    Ok(())
}

/// The files that made the experiment, of those that are there.
fn files(folder: &Path) -> Vec<(String, String)> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let files = [EXPERIMENT, "robot.toml"].into_iter();
    files.filter_map(|name| Some((name.to_owned(), text(name)?))).collect()
}

/// The convergence of all groups of instances, where these are few enough to be drawn.
pub(super) fn charts(plan: &Plan, runs: &[Run], most_panels: usize) -> Vec<Chart> {
    let curves = convergence(plan, runs);
    let mut groups: Vec<&str> = curves.iter().map(|curve| curve.group.as_str()).collect();
    groups.dedup();
    if groups.len() > most_panels {
        return Vec::new();
    }
    vec![Chart {
        name: "convergence".to_owned(),
        title: "Convergence".to_owned(),
        caption: "Best cost so far against evaluations: the median over the runs, with the quartiles as a band."
            .to_owned(),
        table: "convergence",
        figure: plot::convergence(&curves, plan.cost_symbol()),
    }]
}
