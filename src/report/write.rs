//! The report of an experiment: its tables, figures and page, written into its folder.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::chart_options::ChartOptions;
use super::error::ReportError;
use super::page::Page;
use super::provenance::provenance;
use crate::analysis::tables::NAMES as TABLES;
use crate::analysis::{Analysis, csv as csv_text, latex, markdown, render, summary, targets};
use crate::exhibit::{Chart, Finding, Table};
use crate::experiment::{Plan, Run, Store, load_all};
use crate::output::{create_folder, remove_temporary, write_file};
use crate::plot;

/// Where tables are, beside the page.
const TABLES_FOLDER: &str = "tables";

/// Where figures are, beside the page.
const FIGURES_FOLDER: &str = "figures";

/// What the page is called.
const PAGE: &str = "report.html";

/// What a report says, and where it is.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Report {
    /// The table `summary` as text.
    pub summary: String,
    /// What the subjects have to say of their own, line by line.
    pub lines: Vec<String>,
    /// What the runs say, the most important first.
    pub findings: Vec<Finding>,
    /// The page; beside it are `tables/` and `figures/`.
    pub page: PathBuf,
    /// The tables that were written, as CSV; other formats stand beside them.
    pub tables: Vec<PathBuf>,
    /// The charts that were written, as PDF; other formats stand beside them.
    pub figures: Vec<PathBuf>,
    /// How many runs the report that is there shows, where these are more than are stored, and it was left as it was.
    pub kept: Option<usize>,
    /// Stored runs.
    pub stored: usize,
    /// Those of them that failed or found nothing.
    pub failed: usize,
}

/// Where a report goes.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Target<'a> {
    /// The folders of the results.
    pub results: Vec<&'a Path>,
    /// The folder that page, `tables/` and `figures/` are written into.
    pub out: &'a Path,
    /// Whether to replace a report there of more runs.
    pub replace: bool,
    /// Which charts are drawn, and how.
    pub charts: ChartOptions,
}

impl<'a> Target<'a> {
    /// Beside the results, unless a report of more runs is there.
    pub fn of(results: &'a Path) -> Self {
        Self::of_all(vec![results], results)
    }

    /// Of one or several folders of results into another folder.
    pub fn of_all(results: Vec<&'a Path>, out: &'a Path) -> Self {
        Self { results, out, replace: false, charts: ChartOptions::default() }
    }

    /// Also in place of a report of more runs.
    #[must_use]
    pub fn replacing(self) -> Self {
        Self { replace: true, ..self }
    }
}

/// Makes tables, figures and the page of all that is stored of a plan. Tables and figures of an earlier report
/// that these runs do not give are removed; but a report of more runs than are stored now stays as it is, unless the target
/// says otherwise.
pub fn write(plan: &Plan, store: &Store, target: &Target<'_>) -> Result<Report, ReportError> {
    write_all(plan, &[store], target)
}

/// The same of several stores, for a plan of experiments [side by side](Plan::beside).
pub fn write_all(
    plan: &Plan,
    stores: &[&Store],
    target: &Target<'_>,
) -> Result<Report, ReportError> {
    let folder = target.out;
    let runs = load_all(plan, stores)?;
    let kept = reported_runs(folder).filter(|shown| *shown > runs.len() && !target.replace);
    let targets = targets(plan, &runs);
    let analysis = Analysis::new(plan, &runs, &targets);
    let summary = render(&summary(plan, &runs, &targets)?)?;
    let own = analysis.exhibits();
    let mut findings = analysis.findings(&own);
    findings.extend(plot::left_out(plan, &runs));
    let path = folder.join(PAGE);
    let (mut tables_written, mut figures_written) = (Vec::new(), Vec::new());
    if kept.is_none() {
        let mut tables = analysis.tables(own.tables)?;
        let options = &target.charts;
        let leading = options.recoloured(own.leading_charts);
        let mut charts = plot::charts(plan, &tables, runs.len(), leading, &options.colours)?;
        charts.extend(options.recoloured(own.charts));
        let charts = options.chosen(charts)?;
        tables.extend(own.chart_tables);
        write_tables(&tables, &own.table_names, &folder.join(TABLES_FOLDER))?;
        write_charts(&charts, &own.chart_names, &folder.join(FIGURES_FOLDER))?;
        let page = Page {
            name: &plan.name,
            findings: &findings,
            scenes: &own.scenes,
            motions_found: own.scenes_found,
            charts: &charts,
            tables: &tables,
            files: &target
                .results
                .iter()
                .flat_map(|folder| files(folder, target.results.len() > 1))
                .collect::<Vec<_>>(),
            facts: &provenance(plan, stores)?,
        };
        for folder in [folder, &folder.join(TABLES_FOLDER), &folder.join(FIGURES_FOLDER)] {
            remove_temporary(folder);
        }
        write_file(&path, page.html()?.as_bytes())?;
        let table = |table: &Table| folder.join(TABLES_FOLDER).join(format!("{}.csv", table.name));
        tables_written = tables.iter().map(table).collect();
        let figure =
            |chart: &Chart| folder.join(FIGURES_FOLDER).join(format!("{}.pdf", chart.name));
        figures_written = charts.iter().map(figure).collect();
    }
    Ok(Report {
        summary,
        lines: own.lines,
        findings,
        page: path,
        tables: tables_written,
        figures: figures_written,
        kept,
        stored: runs.len(),
        failed: failures(&runs),
    })
}

/// The tables that a report of the same runs has.
pub fn tables(plan: &Plan, stores: &[&Store]) -> Result<Vec<Table>, ReportError> {
    let runs = load_all(plan, stores)?;
    let targets = targets(plan, &runs);
    let analysis = Analysis::new(plan, &runs, &targets);
    let own = analysis.exhibits();
    let mut tables = analysis.tables(own.tables)?;
    tables.extend(own.chart_tables);
    Ok(tables)
}

/// How many runs the report in a folder shows, if there is one.
fn reported_runs(folder: &Path) -> Option<usize> {
    let table = folder.join(TABLES_FOLDER).join("runs.csv");
    let mut rows = csv::Reader::from_path(table).ok()?.into_byte_records();
    rows.try_fold(0, |count, row| row.is_ok().then_some(count + 1))
}

fn failures(runs: &[Run]) -> usize {
    runs.iter().filter(|run| run.cost.is_infinite()).count()
}

/// Writes every table as CSV and, unless it is a curve, as Markdown and LaTeX; tables from before that these
/// runs do not give are removed.
fn write_tables(tables: &[Table], own: &[&str], folder: &Path) -> Result<(), ReportError> {
    create_folder(folder)?;
    let all = TABLES.iter().chain(own);
    let gone = all.filter(|name| tables.iter().all(|table| table.name != **name));
    remove(folder, gone, &["csv", "md", "tex"]);
    for Table { name, caption, frame, is_curve } in tables {
        write_file(&folder.join(format!("{name}.csv")), &csv_text(frame)?)?;
        if !is_curve {
            let text = format!("{}\n{caption}\n", markdown(frame)?);
            write_file(&folder.join(format!("{name}.md")), text.as_bytes())?;
            let text = latex(frame, name, caption)?;
            write_file(&folder.join(format!("{name}.tex")), text.as_bytes())?;
        }
    }
    Ok(())
}

/// Writes every chart as SVG, PNG and PDF; charts from before that these runs do not give are removed.
fn write_charts(charts: &[Chart], own: &[&str], folder: &Path) -> Result<(), ReportError> {
    let all = plot::NAMES.iter().chain(own);
    let gone = all.filter(|name| charts.iter().all(|chart| chart.name != **name));
    remove(folder, gone, &["svg", "png", "pdf"]);
    Ok(charts.par_iter().try_for_each(|chart| chart.figure.save(folder, &chart.name))?)
}

/// What is not there need not be removed, and what cannot be removed cannot be written either.
fn remove<'a>(folder: &Path, names: impl Iterator<Item = &'a &'a str>, extensions: &[&str]) {
    for name in names {
        for extension in extensions {
            let _ = std::fs::remove_file(folder.join(format!("{name}.{extension}")));
        }
    }
}

/// The files that made the experiment, of those that are there; of several experiments with their folder's name.
fn files(folder: &Path, is_one_of_many: bool) -> Vec<(String, String)> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let files = ["experiment.toml", "robot.toml"].into_iter();
    let own = folder.file_name().filter(|_| is_one_of_many);
    let own = own.map_or_else(String::new, |own| format!("{}-", own.display()));
    files.filter_map(|name| Some((format!("{own}{name}"), text(name)?))).collect()
}
