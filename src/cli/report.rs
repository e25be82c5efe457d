//! `driftless report`.

use std::collections::HashSet;
use std::path::Path;

use clap::Args;

use super::CliError;
use super::page::{charts, write_page};
use super::results::{Results, ResultsFolder};
use super::run::warn_of_budgets;
use crate::analysis::tables::{NAMES, Table, tables};
use crate::analysis::{
    self, Run, best_run, convergence, csv, latex, markdown, render, summary, targets,
};
use crate::experiment::Plan;
use crate::output::{create_folder, write_file};
use crate::plot;
use crate::problem::{BestKnown, Motion};

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
        let mut tables = write_tables(&plan, &runs, &folder.join("tables"))?;
        report(&plan, &runs, &folder)?;
        let (charts, motion) = charts(&plan, &runs, MOST_PANELS)?;
        tables.extend(motion);
        write_page(&plan, &store, &runs, &tables, &charts, &folder)
    }
}

/// Writes every table as CSV and, unless it is a curve, as Markdown and LaTeX; tables from before that these
/// runs do not give are removed.
fn write_tables(plan: &Plan, runs: &[Run], folder: &Path) -> Result<Vec<Table>, CliError> {
    create_folder(folder)?;
    let tables = tables(plan, runs, &targets(plan, runs))?;
    for name in NAMES.iter().filter(|name| tables.iter().all(|table| table.name != **name)) {
        for extension in ["csv", "md", "tex"] {
            // What is not there need not be removed, and what cannot be removed cannot be written either.
            let _ = std::fs::remove_file(folder.join(format!("{name}.{extension}")));
        }
    }
    for Table { name, caption, frame, is_curve } in &tables {
        write_file(&folder.join(format!("{name}.csv")), &csv(frame)?)?;
        if !is_curve {
            let text = format!("{}\n{caption}\n", markdown(frame)?);
            write_file(&folder.join(format!("{name}.md")), text.as_bytes())?;
            let text = format!("% {caption}\n{}", latex(frame)?);
            write_file(&folder.join(format!("{name}.tex")), text.as_bytes())?;
        }
    }
    Ok(tables)
}

/// Most panels of a figure.
const MOST_PANELS: usize = 24;
/// Most instances whose best motion is told.
const MOST_TOLD: usize = 24;

/// Prints the summary of all stored runs of the plan and draws them.
pub(super) fn report(plan: &Plan, runs: &[Run], folder: &Path) -> Result<(), CliError> {
    if runs.len() < plan.runs.len() {
        say!("{} of {} runs are stored so far", runs.len(), plan.runs.len());
    }
    say!("{}", render(&summary(plan, runs, &targets(plan, runs))?)?);
    warn_of_budgets(plan);
    let figures = folder.join("figures");
    let groups: HashSet<&str> = plan.instances.iter().map(|i| i.group.as_str()).collect();
    if groups.len() <= MOST_PANELS {
        let curves = convergence(plan, runs);
        plot::convergence(&curves, plan.cost_symbol()).save(&figures, "convergence")?;
    } else {
        note!("note: convergence of more than {MOST_PANELS} groups of instances is not drawn");
    }
    let mut by_instance = vec![Vec::new(); plan.instances.len()];
    for run in runs {
        by_instance[run.instance].push(run);
    }
    for (instance, runs) in plan.instances.iter().zip(by_instance).take(MOST_TOLD) {
        let (Some(problem), Some(best)) = (instance.reorientation(), best_run(runs.into_iter()))
        else {
            continue;
        };
        let optimiser = &plan.optimisers[best.optimiser].label;
        let known = BestKnown::of(problem)
            .map_or_else(String::new, |known| format!(" ({})", known.compared_with(best.cost)));
        let on = if instance.label.is_empty() { "" } else { " for " };
        say!(
            "best motion{on}{}: {optimiser}, seed {}: J {:.6}{known}, t_f {:.4} s",
            instance.label,
            best.seed,
            best.cost,
            best.duration
        );
        // Costs of different instances do not compare, so there is no best of all to draw.
        if plan.instances.len() == 1 {
            let motion = Motion::sample(problem, &best.coefficients, best.duration, plot::SAMPLES);
            plot::write_motion_figures(&figures, &motion, problem.task())?;
        }
    }
    if plan.instances.len() > MOST_TOLD {
        say!("… `driftless report` lists the best motions of all instances in tables/best.csv");
    }
    say!("results: {}, figures: {}", folder.display(), figures.display());
    let failed = runs.iter().filter(|run| run.cost.is_infinite()).count();
    if failed > 0 {
        note!("warning: {failed} of {} runs failed or found nothing", runs.len());
    }
    Ok(())
}
