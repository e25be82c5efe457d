//! `driftless report`.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;
use textwrap::{WordSeparator, WordSplitter};

use super::CliError;
use super::results::ResultsFolders;
use super::warnings::{warn_of_budgets, warn_of_damage};
use crate::exhibit::Finding;
use crate::exhibit::words::plural;
use crate::experiment::{Folder, Plan, Store, standing};
use crate::report::{Target, write_all};

/// Make tables, figures and a page from what is stored
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    results: ResultsFolders,
    /// Folder for page, tables and figures, instead of that of the results; several folders need one
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a report of more runs than are stored now
    #[arg(long)]
    replace: bool,
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
        let plan = beside(&folders)?;
        let stores: Vec<&Store> = folders.iter().map(|folder| &folder.store).collect();
        match report(&plan, &stores, &target)? {
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
) -> Result<Option<String>, CliError> {
    let report = write_all(plan, stores, target)?;
    for store in stores {
        warn_of_damage(store);
    }
    if report.stored < plan.runs.len() {
        say!("{} of {} runs are stored so far", report.stored, plan.runs.len());
    }
    say!("{}", report.summary);
    warn_of_budgets(plan);
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
        say!("\n{}; beside it tables/ and figures/", report.page.display());
    }
    if report.failed > 0 {
        note!("warning: {} of {} runs failed or found nothing", report.failed, report.stored);
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
