//! Every chart that an experiment's tables give.

use std::collections::HashSet;

use polars::prelude::DataFrame;

use super::curves::MOST_PANELS;
use super::looks::Looks;
use super::{
    convergence, critical_difference, dimensions, effect_sizes, final_costs, running_times,
};
use crate::analysis::ALPHA;
use crate::exhibit::{Chart, Finding, Table};
use crate::experiment::{Plan, Run};
use crate::figure::{Figure, FigureError};
use crate::words::plural;

/// The names that every experiment's charts may have.
pub(crate) const NAMES: [&str; 9] = [
    "convergence",
    "dimensions",
    "running-time-distribution",
    "expected-running-time",
    "performance-profiles",
    "data-profiles",
    "final-costs",
    "effect-sizes",
    "critical-difference",
];

/// How charts draw costs.
const SCALES: &str = "Where costs are negative, the chart shows their distance to the least known cost or, if none is known, uses a \
                      linear axis. A logarithmic axis covers at most sixteen decades; costs below it, and zero, are drawn on the \
                      dotted line.";

/// What charts are made of.
struct Maker<'a> {
    plan: &'a Plan,
    tables: &'a [Table],
    looks: Looks,
    /// What every caption of a comparison ends with.
    notes: String,
    charts: Vec<Chart>,
}

/// What is said where the stored runs are of too many groups of instances for charts with a panel for each.
pub(crate) fn left_out(plan: &Plan, runs: &[Run]) -> Option<Finding> {
    let groups = runs.iter().map(|run| plan.instances[run.instance].group.as_str());
    let panels = groups.collect::<HashSet<_>>().len();
    let told = format!(
        "Convergence, final costs and expected running times are not drawn: they would need {panels} panels, and a chart has \
         {MOST_PANELS} at most. Their tables are complete."
    );
    let question = "Which charts by group are left out?";
    (panels > MOST_PANELS).then(|| Finding::new(question, told))
}

/// Every chart that the tables of an experiment with so many stored runs give. Those of more than 24
/// groups of instances are left out.
/// `leading` are a subject's own, which come first; `colours` are those of the optimisers in the plan's order, by kind if empty.
pub(crate) fn charts(
    plan: &Plan,
    tables: &[Table],
    stored: usize,
    leading: Vec<Chart>,
    colours: &[[u8; 3]],
) -> Result<Vec<Chart>, FigureError> {
    let looks = Looks::of_plan(plan, colours);
    let own = notes(plan, stored);
    let noted = |chart: Chart| Chart { caption: format!("{}{own}", chart.caption), ..chart };
    let charts = leading.into_iter().map(noted).collect();
    let notes = own.clone() + looks.note();
    let mut maker = Maker { plan, tables, looks, notes, charts };
    maker.costs()?;
    maker.ranks()?;
    maker.times()?;
    Ok(maker.charts)
}

impl Maker<'_> {
    fn frame(&self, name: &str) -> Option<&DataFrame> {
        self.tables.iter().find(|table| table.name == name).map(|table| &table.frame)
    }

    fn add(
        &mut self,
        name: &str,
        title: &str,
        caption: &str,
        table: &'static str,
        figure: Option<Figure>,
    ) {
        // Where no optimiser has tried what another has, a table may be empty.
        let drawn = figure.filter(|figure| !figure.panels.is_empty());
        self.charts.extend(drawn.map(|figure| Chart {
            name: name.to_owned(),
            title: title.to_owned(),
            caption: format!("{caption}{}", self.notes),
            table: table.into(),
            figure,
        }));
    }

    fn costs(&mut self) -> Result<(), FigureError> {
        let symbol = self.plan.cost_symbol();
        if let Some(frame) = self.frame("convergence") {
            let figure = convergence::convergence(frame, &self.looks, symbol)?;
            let caption = format!(
                "Best {symbol} so far against evaluations: the median over the runs, with the quartiles as a band. A run that \
                 ended early keeps the best it had. {SCALES}"
            );
            self.add("convergence", "Convergence", &caption, "convergence", figure);
        }
        if let Some(frame) = self.frame("dimensions") {
            let figure = dimensions::dimensions(frame, &self.looks, symbol)?;
            let caption = format!(
                "Median of the final {symbol} over the runs, certified, against the number of variables. Medians that are \
                 infinite are left out."
            );
            self.add("dimensions", "Number of variables", &caption, "dimensions", figure);
        }
        if let Some(frame) = self.frame("runs") {
            let figure = final_costs::final_costs(frame, &self.looks, symbol)?;
            let caption = format!(
                "Final {symbol} of all runs, certified: quartiles as a box, the least and the largest as whiskers, single \
                 runs as points below where they are few. Runs that failed are counted at the end. {SCALES}"
            );
            self.add("final-costs", "Final costs", &caption, "runs", figure);
        }
        Ok(())
    }

    fn times(&mut self) -> Result<(), FigureError> {
        let symbol = self.plan.cost_symbol();
        if let Some(frame) = self.frame("running-time-distribution") {
            let figure = running_times::running_time_distribution(frame, &self.looks)?;
            let caption = "Share of pairs of run and target reached within so many evaluations, over 51 targets from 10² to 10⁻⁸ \
                above the least cost known or found. Thin lines go on with simulated restarts.";
            let name = "running-time-distribution";
            self.add(name, "Distribution of running times", caption, name, figure);
        }
        if let Some(frame) = self.frame("expected-running-time") {
            let figure = running_times::expected_running_time(frame, &self.looks, symbol)?;
            let caption = "Expected evaluations, restarts included, until a target is reached, against how far the target is \
                above the least cost known or found. A curve ends where no run came further.";
            let name = "expected-running-time";
            self.add(name, "Expected running time", caption, name, figure);
        }
        let is_race = self.plan.optimisers.len() > 1;
        if let Some(frame) = self.frame("performance-profiles").filter(|_| is_race) {
            let label = "ratio to the fewest evaluations";
            let figure = running_times::profiles(frame, &self.looks, "ratio", label)?;
            let caption = "Share of problems, each an instance with a seed, whose target is reached within a multiple of the \
                evaluations that the fastest optimiser needs there.";
            let name = "performance-profiles";
            self.add(name, "Performance profiles", caption, name, figure);
        }
        if let Some(frame) = self.frame("data-profiles") {
            let time = "simplex gradients";
            let figure = running_times::profiles(frame, &self.looks, time, time)?;
            let caption = "Share of problems, each an instance with a seed, whose target is reached within so many simplex \
                gradients, n + 1 evaluations each.";
            self.add("data-profiles", "Data profiles", caption, "data-profiles", figure);
        }
        Ok(())
    }

    fn ranks(&mut self) -> Result<(), FigureError> {
        let (Some(ranks), Some(pairs)) = (self.frame("ranks"), self.frame("pairs")) else {
            return Ok(());
        };
        if self.plan.is_uneven() {
            return Ok(());
        }
        let diagram = critical_difference::critical_difference(ranks, &self.looks)?;
        let effects = effect_sizes::effect_sizes(pairs, ranks, &self.looks)?;
        let told = |name: &str| {
            let table = self.tables.iter().find(|table| table.name == name);
            table.map_or_else(String::new, |table| format!(" {}", table.caption))
        };
        let (of_ranks, of_pairs) = (told("ranks"), told("pairs"));
        let caption = format!(
            "Mean ranks of the final costs, 1 being the best. Bars join optimisers that Wilcoxon's signed-rank test with Holm's \
             correction does not tell apart at level {ALPHA}, and are thick at these.{of_ranks}"
        );
        self.add("critical-difference", "Critical differences", &caption, "ranks", Some(diagram));
        let caption = format!(
            "A12 of the row's optimiser against the column's. Blue favours the row, orange the column; a star marks pairs that \
             differ significantly at level {ALPHA} by Wilcoxon's test with Holm's correction, others are pale.{of_pairs}"
        );
        self.add("effect-sizes", "Every two optimisers", &caption, "pairs", Some(effects));
        Ok(())
    }
}

/// What has to be known of the runs to read a chart.
fn notes(plan: &Plan, stored: usize) -> String {
    let planned = plan.runs.len();
    let uses = plan.optimisers.iter().filter(|entrant| entrant.needs_derivatives);
    let uses: Vec<&str> = uses.map(|entrant| entrant.label.as_str()).collect();
    let notes = [
        (stored < planned)
            .then(|| format!(" Only {stored} of {} are stored so far.", plural(planned, "run"))),
        plan.is_uneven().then(|| " Budgets differ within the field.".to_owned()),
        (!uses.is_empty() && uses.len() < plan.optimisers.len())
            .then(|| format!(" Evaluations of {} come with derivatives.", uses.join(", "))),
    ];
    notes.into_iter().flatten().collect()
}
