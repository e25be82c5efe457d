//! The report of an experiment: its tables, figures and page, written into its folder.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::ReportError;
use super::page::Page;
use super::provenance::provenance;
use crate::analysis::tables::NAMES as TABLES;
use crate::analysis::{Analysis, csv, latex, markdown, render, summary, targets};
use crate::exhibit::{Chart, Finding, Table};
use crate::experiment::{Plan, Run, Store, load};
use crate::output::{create_folder, remove_temporary, write_file};
use crate::plot;

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
    /// Stored runs.
    pub stored: usize,
    /// Those of them that failed or found nothing.
    pub failed: usize,
}

/// Makes tables, figures and the page of all that is stored of a plan, in a folder. Tables and figures of earlier reports
/// that these runs do not give are removed.
pub fn write(plan: &Plan, store: &Store, folder: &Path) -> Result<Report, ReportError> {
    let runs = load(plan, store)?;
    let targets = targets(plan, &runs);
    let analysis = Analysis::new(plan, &runs, &targets);
    let summary = render(&summary(plan, &runs, &targets)?)?;
    let own = analysis.exhibits();
    let findings = analysis.findings(&own);
    let mut tables = analysis.tables(own.tables)?;
    let mut charts = plot::charts(plan, &tables, runs.len(), own.leading_charts)?;
    charts.extend(own.charts);
    tables.extend(own.chart_tables);
    write_tables(&tables, &own.table_names, &folder.join("tables"))?;
    write_charts(&charts, &own.chart_names, &folder.join("figures"))?;
    let page = Page {
        name: &plan.name,
        findings: &findings,
        scenes: &own.scenes,
        motions_found: own.scenes_found,
        charts: &charts,
        tables: &tables,
        files: &files(folder),
        facts: &provenance(plan, store)?,
    };
    for folder in [folder, &folder.join("tables"), &folder.join("figures")] {
        remove_temporary(folder);
    }
    let path = folder.join(PAGE);
    write_file(&path, page.html()?.as_bytes())?;
    Ok(Report {
        summary,
        lines: own.lines,
        findings,
        page: path,
        stored: runs.len(),
        failed: failures(&runs),
    })
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
        write_file(&folder.join(format!("{name}.csv")), &csv(frame)?)?;
        if !is_curve {
            let text = format!("{}\n{caption}\n", markdown(frame)?);
            write_file(&folder.join(format!("{name}.md")), text.as_bytes())?;
            let text = format!("% {caption}\n{}", latex(frame)?);
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

/// The files that made the experiment, of those that are there.
fn files(folder: &Path) -> Vec<(String, String)> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let files = ["experiment.toml", "robot.toml"].into_iter();
    files.filter_map(|name| Some((name.to_owned(), text(name)?))).collect()
}
