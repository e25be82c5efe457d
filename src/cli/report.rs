//! `driftless report`.

use std::path::Path;

use clap::Args;
use rayon::prelude::*;
use textwrap::{WordSeparator, WordSplitter};

use super::CliError;
use super::results::{EXPERIMENT, Results, ResultsFolder};
use super::run::warn_of_budgets;
use crate::analysis::tables::{NAMES, Table, motion_table};
use crate::analysis::{
    self, Analysis, Finding, Run, csv, latex, markdown, render, summary, targets,
};
use crate::experiment::{Plan, Store};
use crate::output::{create_folder, write_file};
use crate::plot::{self, Chart};
use crate::reorientation::{BestKnown, Motion, Reorientation};
use crate::report::{Page, provenance, scenes};

/// Make tables, figures and a page from what is stored
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    results: ResultsFolder,
}

impl Report {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let Results { folder, plan, store } = self.results.open()?;
        let runs = analysis::load(&plan, &store)?;
        report(&plan, &store, &runs, &folder)
    }
}

/// Writes every table as CSV and, unless it is a curve, as Markdown and LaTeX; tables from before that these
/// runs do not give are removed.
fn write_tables(tables: &[Table], folder: &Path) -> Result<(), CliError> {
    create_folder(folder)?;
    let gone = NAMES.iter().filter(|name| tables.iter().all(|table| table.name != **name));
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
fn write_charts(charts: &[Chart], folder: &Path) -> Result<(), CliError> {
    let all = plot::NAMES.iter().chain(&plot::MOTION_NAMES);
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

/// Columns of a line of text.
const LINE: usize = 100;
/// What the page is called.
const PAGE: &str = "report.html";
/// Most instances whose best motion is told.
const MOST_TOLD: usize = 24;

/// Prints what all stored runs of the plan say; writes and draws it.
pub(super) fn report(
    plan: &Plan,
    store: &Store,
    runs: &[Run],
    folder: &Path,
) -> Result<(), CliError> {
    if runs.len() < plan.runs.len() {
        say!("{} of {} runs are stored so far", runs.len(), plan.runs.len());
    }
    let targets = targets(plan, runs);
    let analysis = Analysis::new(plan, runs, &targets);
    say!("{}", render(&summary(plan, runs, &targets)?)?);
    warn_of_budgets(plan);
    let best = analysis.best_motions();
    tell(plan, &best)?;
    let findings = analysis.findings();
    for Finding { question, answer } in &findings {
        // Labels are not broken at their hyphens.
        let line = textwrap::Options::new(LINE)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation);
        say!("\n{question}\n{}", textwrap::fill(answer, line));
    }
    let (tables, charts) = tables_and_charts(plan, &analysis, runs.len(), &best)?;
    write_tables(&tables, &folder.join("tables"))?;
    write_charts(&charts, &folder.join("figures"))?;
    let page = Page {
        name: &plan.name,
        findings: &findings,
        scenes: &scenes(plan, &best),
        motions_found: best.len(),
        charts: &charts,
        tables: &tables,
        files: &files(folder),
        facts: &provenance(plan, store)?,
    };
    let path = folder.join(PAGE);
    write_file(&path, page.html()?.as_bytes())?;
    say!("\n{}; beside it tables/ and figures/", path.display());
    let failed = runs.iter().filter(|run| run.cost.is_infinite()).count();
    if failed > 0 {
        note!("warning: {failed} of {} runs failed or found nothing", runs.len());
    }
    Ok(())
}

/// All tables, and the charts of them; of a single instance those of its best motion too. Costs of different instances do
/// not compare, so otherwise there is no best of all to draw.
fn tables_and_charts(
    plan: &Plan,
    analysis: &Analysis<'_>,
    stored: usize,
    best: &[(&Run, &Reorientation)],
) -> Result<(Vec<Table>, Vec<Chart>), CliError> {
    let mut tables = analysis.tables()?;
    let mut charts = plot::charts(plan, &tables, stored)?;
    if let (1, [(run, problem)]) = (plan.instances.len(), best) {
        let motion = Motion::sample(problem, &run.coefficients, run.duration, plot::SAMPLES);
        charts.extend(plot::motion_charts(&motion, problem.task()));
        tables.push(motion_table(&motion)?);
    }
    Ok((tables, charts))
}

/// The files that made the experiment, of those that are there.
fn files(folder: &Path) -> Vec<(String, String)> {
    let text = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let files = [EXPERIMENT, "robot.toml"].into_iter();
    files.filter_map(|name| Some((name.to_owned(), text(name)?))).collect()
}

fn tell(plan: &Plan, best: &[(&Run, &Reorientation)]) -> Result<(), CliError> {
    for (run, problem) in best.iter().take(MOST_TOLD) {
        let instance = &plan.instances[run.instance];
        let optimiser = &plan.optimisers[run.optimiser].label;
        let known = BestKnown::of(problem)
            .map_or_else(String::new, |known| format!(" ({})", known.compared_with(run.cost)));
        let on = if instance.label.is_empty() { "" } else { " for " };
        say!(
            "best motion{on}{}: {optimiser}, seed {}: J {:.6}{known}, t_f {:.4} s",
            instance.label,
            run.seed,
            run.cost,
            run.duration
        );
    }
    if best.len() > MOST_TOLD {
        say!("… all instances' best motions are in tables/best.csv");
    }
    Ok(())
}
