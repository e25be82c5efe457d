//! `driftless report`.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use textwrap::{WordSeparator, WordSplitter};

use super::results::ResultsFolders;
use super::warnings::{warn_of_budgets, warn_of_damage};
use super::{CliError, say_json};
use crate::exhibit::Finding;
use crate::experiment::{Folder, Plan, Store, standing};
use crate::report::{ChartOptions, PALETTES, Target, palette, write_all};
use crate::words::plural;

/// Write tables, figures and an HTML page from stored results
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    results: ResultsFolders,
    /// Folder for the page, tables and figures, instead of the results' own; required with several folders of results
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a report even if it shows more runs than are stored now
    #[arg(long)]
    replace: bool,
    #[command(flatten)]
    charts: ChartArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Which charts are drawn, and how.
#[derive(Debug, Args)]
struct ChartArguments {
    /// Charts to draw, by the names of their files, instead of all; other charts of an earlier report there are removed
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    charts: Vec<String>,
    /// Draw linear axes instead of logarithmic ones; `--linear=x` or `--linear=y` only horizontal or vertical ones
    #[arg(long, value_name = "AXES", num_args = 0..=1, require_equals = true, default_missing_value = "both")]
    linear: Option<LinearAxes>,
    /// Colours of the optimisers, in the order of the experiment's file, and of other lines: the name of a palette (okabe-ito,
    /// tol-bright, grey), a list such as `#0072B2,#D55E00`, or a file with one such colour per line
    #[arg(long, value_name = "COLOURS", value_parser = colours)]
    colours: Option<Colours>,
}

/// Axes drawn linear.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum LinearAxes {
    /// Horizontal axes
    X,
    /// Vertical axes
    Y,
    /// All axes
    Both,
}

/// Colours in the order in which lines take them.
#[derive(Debug, Clone)]
struct Colours(Vec<[u8; 3]>);

/// Reads the value of `--colours`.
fn colours(text: &str) -> Result<Colours, String> {
    if let Some(palette) = palette(text) {
        return Ok(Colours(palette));
    }
    if text.starts_with('#') {
        let colours = text.split(',').map(|text| colour(text.trim()));
        return Ok(Colours(colours.collect::<Result<_, _>>()?));
    }
    let file = std::fs::read_to_string(text).map_err(|error| {
        let palettes = PALETTES.map(|(name, _)| name).join(", ");
        format!("expected {palettes}, colours such as #0072B2, or a file with these: {error}")
    })?;
    let lines = file.trim_start_matches('\u{FEFF}').lines().map(str::trim);
    let lines = (1..).zip(lines).filter(|(_, line)| !line.is_empty());
    let colours = lines.map(|(number, line)| {
        colour(line).map_err(|error| format!("{text}, line {number}: {error}"))
    });
    let colours: Vec<[u8; 3]> = colours.collect::<Result<_, _>>()?;
    if colours.is_empty() { Err(format!("{text}: found no colour")) } else { Ok(Colours(colours)) }
}

/// Reads a colour such as `#0072B2`.
fn colour(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
    let digits = digits.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
    let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, red, green, blue] = number
        .ok_or_else(|| format!("found `{text}`, expected a colour such as #0072B2"))?
        .to_be_bytes();
    Ok([red, green, blue])
}

impl ChartArguments {
    fn options(&self) -> ChartOptions {
        let linear = match self.linear {
            None => [false, false],
            Some(LinearAxes::X) => [true, false],
            Some(LinearAxes::Y) => [false, true],
            Some(LinearAxes::Both) => [true, true],
        };
        let colours = self.colours.as_ref().map_or_else(Vec::new, |Colours(own)| own.clone());
        ChartOptions { only: self.charts.clone(), linear, colours }
    }
}

impl Report {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let folders = self.results.open()?;
        let paths: Vec<&Path> = folders.iter().map(Folder::path).collect();
        let mut target = match (&paths[..], &self.out) {
            ([folder], None) => Target::of(folder),
            (_, Some(out)) => Target::of_all(paths, out),
            (_, None) => {
                let message = "found several folders of results, expected --out for their report";
                return Err(CliError::Usage { message: message.to_owned(), help: None });
            }
        };
        if self.replace {
            target = target.replacing();
        }
        target.charts = self.charts.options();
        let plan = beside(&folders)?;
        let stores: Vec<&Store> = folders.iter().map(|folder| &folder.store).collect();
        match report(&plan, &stores, &target, self.json)? {
            // The damage has been reported already; the existing report still has those runs.
            Some(kept) if stores.iter().any(|store| !store.damaged().is_empty()) => {
                note!("note: {kept}");
                Ok(())
            }
            Some(kept) => Err(CliError::Kept(kept)),
            None => Ok(()),
        }
    }
}

/// The plan of all folders, each called by its name, or by its path where two have the same.
fn beside(folders: &[Folder]) -> Result<Plan, CliError> {
    let paths: Vec<String> = folders.iter().map(|f| f.path().display().to_string()).collect();
    let names: Vec<String> = folders
        .iter()
        .map(|folder| {
            let path = folder.path();
            let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
            path.file_name().map_or_else(String::new, |name| name.display().to_string())
        })
        .collect();
    let distinct: HashSet<&String> = names.iter().collect();
    let names = if distinct.len() == names.len() { &names } else { &paths };
    if names.iter().collect::<HashSet<_>>().len() < names.len() {
        let message = "found one folder of results twice, expected each once".to_owned();
        return Err(CliError::Usage { message, help: None });
    }
    let plans: Vec<(&str, &Plan)> =
        names.iter().map(String::as_str).zip(folders.iter().map(|folder| &folder.plan)).collect();
    if let [(_, plan)] = plans[..] {
        return Ok(plan.clone());
    }
    Plan::beside(&plans).ok_or_else(|| CliError::Usage {
        message: "found no folder of results".to_owned(),
        help: None,
    })
}

/// Columns of a line of text.
const LINE: usize = 100;

/// Prints what all stored runs of the plan say; writes and draws it. Where a report of more runs stays instead, says so.
pub(super) fn report(
    plan: &Plan,
    stores: &[&Store],
    target: &Target<'_>,
    json: bool,
) -> Result<Option<String>, CliError> {
    let report = write_all(plan, stores, target)?;
    for store in stores {
        warn_of_damage(store);
    }
    warn_of_budgets(plan);
    if json {
        say_json(&report_json(plan, &report))?;
    } else {
        tell(plan, &report)?;
    }
    if report.failed > 0 {
        let stored = plural(report.stored, "run");
        note!("warning: {} of {stored} failed or found nothing", report.failed);
    }
    for store in stores {
        let standing = standing(plan, store)?;
        if let Some(unread) = standing.unread() {
            note!("note: {unread}");
        }
        if let Some(others) = standing.others() {
            note!("note: {others}");
        }
    }
    Ok(report.kept.map(|shown| {
        let are = if report.stored == 1 { "is" } else { "are" };
        format!(
            "{} shows {}, but only {} of this experiment {are} stored; the report was left as it is",
            report.page.display(),
            plural(shown, "run"),
            report.stored
        )
    }))
}

fn report_json(plan: &Plan, report: &crate::report::Report) -> Value {
    let finding =
        |Finding { question, answer }: &Finding| json!({ "question": question, "answer": answer });
    let shown = |paths: &[PathBuf]| -> Vec<String> {
        paths.iter().map(|path| path.display().to_string()).collect()
    };
    json!({
        "experiment": plan.name,
        "runs": plan.runs.len(),
        "stored": report.stored,
        "failed": report.failed,
        "page": report.page.display().to_string(),
        "is_written": report.kept.is_none(),
        "tables": shown(&report.tables),
        "figures": shown(&report.figures),
        "lines": report.lines,
        "findings": report.findings.iter().map(finding).collect::<Vec<_>>(),
    })
}

/// Prints what the runs say.
fn tell(plan: &Plan, report: &crate::report::Report) -> Result<(), CliError> {
    if report.stored < plan.runs.len() {
        let planned = plural(plan.runs.len(), "run");
        say!("{} of {planned} are stored so far", report.stored);
    }
    say!("{}", report.summary);
    for line in &report.lines {
        say!("{line}");
    }
    for Finding { question, answer } in &report.findings {
        // Labels are not broken at their hyphens.
        let line = textwrap::Options::new(LINE)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation);
        say!("\n{question}\n{}", textwrap::fill(answer, line));
    }
    if report.kept.is_none() {
        say!("\n{}, with tables/ and figures/ next to it", report.page.display());
    }
    Ok(())
}
