//! The page that `driftless report` writes.

use std::collections::HashSet;
use std::path::Path;

use super::CliError;
use super::results::EXPERIMENT;
use crate::analysis::tables::Table;
use crate::analysis::{Run, best_run, convergence};
use crate::experiment::{Plan, Store};
use crate::export::motion_table;
use crate::output::write_file;
use crate::plot::{self, Chart};
use crate::problem::Motion;
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

/// The convergence of all groups of instances, where these are few enough to be drawn, and the best motion where
/// there is but one instance; the latter with its table.
pub(super) fn charts(
    plan: &Plan,
    runs: &[Run],
    most_panels: usize,
) -> Result<(Vec<Chart>, Option<Table>), CliError> {
    let mut charts = Vec::new();
    let groups: HashSet<&str> = plan.instances.iter().map(|i| i.group.as_str()).collect();
    if groups.len() <= most_panels {
        charts.push(Chart {
            name: "convergence".to_owned(),
            title: "Convergence".to_owned(),
            caption: "Best cost so far against evaluations: the median over the runs, with the quartiles as a band."
                .to_owned(),
            table: "convergence",
            figure: plot::convergence(&convergence(plan, runs), plan.cost_symbol()),
        });
    }
    let ([instance], Some(best)) = (&plan.instances[..], best_run(runs.iter())) else {
        return Ok((charts, None));
    };
    let Some(problem) = instance.reorientation() else { return Ok((charts, None)) };
    let motion = Motion::sample(problem, &best.coefficients, best.duration, plot::SAMPLES);
    charts.extend(plot::motion_charts(&motion, problem.task()));
    let table = Table {
        name: "motion",
        caption: "The best motion: angles in radians, all else in SI units; the base's quaternion turns base axes into \
                  inertial axes."
            .to_owned(),
        frame: motion_table(&motion)?,
        is_curve: true,
    };
    Ok((charts, Some(table)))
}
