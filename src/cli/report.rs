//! `driftless report`.

use std::path::Path;

use clap::Args;
use textwrap::{WordSeparator, WordSplitter};

use super::CliError;
use super::results::ResultsFolder;
use super::warnings::{warn_of_budgets, warn_of_damage};
use crate::exhibit::Finding;
use crate::experiment::{Plan, Store, standing};
use crate::report::write;

/// Make tables, figures and a page from what is stored
#[derive(Debug, Args)]
pub(super) struct Report {
    #[command(flatten)]
    results: ResultsFolder,
}

impl Report {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let folder = self.results.open()?;
        report(&folder.plan, &folder.store, folder.path())
    }
}

/// Columns of a line of text.
const LINE: usize = 100;

/// Prints what all stored runs of the plan say; writes and draws it.
pub(super) fn report(plan: &Plan, store: &Store, folder: &Path) -> Result<(), CliError> {
    let report = write(plan, store, folder)?;
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
    say!("\n{}; beside it tables/ and figures/", report.page.display());
    if report.failed > 0 {
        note!("warning: {} of {} runs failed or found nothing", report.failed, report.stored);
    }
    if let Some(unread) = standing(plan, store)?.unread() {
        note!("note: {unread}");
    }
    Ok(())
}
