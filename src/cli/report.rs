//! `driftless report`.

use std::path::PathBuf;

use clap::Args;
use textwrap::{WordSeparator, WordSplitter};

use super::CliError;
use super::results::ResultsFolder;
use super::warnings::{warn_of_budgets, warn_of_damage};
use crate::exhibit::Finding;
use crate::exhibit::words::plural;
use crate::experiment::{Folder, standing};
use crate::report::{Target, write};

/// Make tables, figures and a page from what is stored
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    results: ResultsFolder,
    /// Folder for page, tables and figures, instead of that of the results
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace a report of more runs than are stored now
    #[arg(long)]
    replace: bool,
}

impl Report {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let folder = self.results.open()?;
        let mut target = Target::of(folder.path());
        if let Some(out) = &self.out {
            target = target.with_folder(out);
        }
        if self.replace {
            target = target.replacing();
        }
        match report(&folder, &target)? {
            // The damage has been reported already; the existing report still has those runs.
            Some(kept) if !folder.store.damaged().is_empty() => {
                note!("note: {kept}");
                Ok(())
            }
            Some(kept) => Err(CliError::Kept(kept)),
            None => Ok(()),
        }
    }
}

/// Columns of a line of text.
const LINE: usize = 100;

/// Prints what all stored runs of the plan say; writes and draws it. Where a report of more runs stays instead, says so.
pub(super) fn report(folder: &Folder, target: &Target<'_>) -> Result<Option<String>, CliError> {
    let Folder { plan, store, .. } = folder;
    let report = write(plan, store, target)?;
    warn_of_damage(store);
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
    let standing = standing(plan, store)?;
    if let Some(unread) = standing.unread() {
        note!("note: {unread}");
    }
    if let Some(others) = standing.others() {
        note!("note: {others}");
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
