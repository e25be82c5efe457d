//! Every chart that an experiment's tables give.

use polars::prelude::DataFrame;

use super::chart::Chart;
use super::figure::{Figure, PlotError};
use super::looks::Looks;
use super::sweeps::Swept;
use super::{comparison, convergence, critical_difference, pareto, running_times, sweeps};
use crate::analysis::ALPHA;
use crate::analysis::tables::Table;
use crate::experiment::Plan;
use crate::reorientation::BestKnown;

/// The names that an experiment's charts may have, but for those of its best motion.
pub const NAMES: [&str; 14] = [
    "convergence",
    "running-time-distribution",
    "expected-running-time",
    "performance-profiles",
    "data-profiles",
    "final-costs",
    "effect-sizes",
    "critical-difference",
    "weight-sweep",
    "rate-sweep",
    "acceleration-sweep",
    "jerk-sweep",
    "terms-sweep",
    "pareto",
];

/// What charts are made of.
struct Maker<'a> {
    plan: &'a Plan,
    tables: &'a [Table],
    looks: Looks,
    /// What every caption of a comparison ends with.
    notes: String,
    charts: Vec<Chart>,
}

/// Every chart that the tables of an experiment with so many stored runs give. Those of more than 24 groups of instances, or of more than eight
/// curves of a sweep, are left out.
pub fn charts(plan: &Plan, tables: &[Table], stored: usize) -> Result<Vec<Chart>, PlotError> {
    let looks = Looks::of(&plan.optimisers);
    let notes = notes(plan, stored);
    let mut maker = Maker { plan, tables, looks, notes, charts: Vec::new() };
    // What a sweep asks comes first.
    maker.sweeps()?;
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
            table,
            figure,
        }));
    }

    fn costs(&mut self) -> Result<(), PlotError> {
        let symbol = self.plan.cost_symbol();
        if let Some(frame) = self.frame("convergence") {
            let figure = convergence::convergence(frame, &self.looks, symbol)?;
            let caption = format!(
                "Best {symbol} so far against evaluations: the median over the runs, with the quartiles as a band. A run that \
                 ended early keeps the best it had. Costs below 10⁻⁹ stand at the lower end."
            );
            self.add("convergence", "Convergence", &caption, "convergence", figure);
        }
        // One optimiser on many instances is what sweeps are about.
        let is_field = self.plan.optimisers.len() > 1 || self.plan.instances.len() == 1;
        if let Some(frame) = self.frame("runs").filter(|_| is_field) {
            let figure = comparison::final_costs(frame, &self.looks, symbol)?;
            let caption = format!(
                "Final {symbol} of all runs, certified: quartiles as a box, the least and the largest as whiskers, single \
                 runs as points where there are thirty at most. Runs that failed are counted at the end, \
                 costs below 10⁻¹⁰ stand at the beginning."
            );
            self.add("final-costs", "Final costs", &caption, "runs", figure);
        }
        Ok(())
    }

    fn times(&mut self) -> Result<(), PlotError> {
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

    fn ranks(&mut self) -> Result<(), PlotError> {
        let tables = [self.frame("ranks"), self.frame("friedman"), self.frame("pairs")];
        let [Some(ranks), Some(friedman), Some(pairs)] = tables else { return Ok(()) };
        if self.plan.is_uneven() {
            return Ok(());
        }
        let diagram = critical_difference::critical_difference(ranks, friedman, &self.looks)?;
        let effects = comparison::effect_sizes(pairs, ranks)?;
        let told = |name: &str| {
            let table = self.tables.iter().find(|table| table.name == name);
            table.map_or_else(String::new, |table| format!(" {}", table.caption))
        };
        let (of_ranks, of_pairs) = (told("ranks"), told("pairs"));
        let caption = format!(
            "Bars join cliques and are thick at their members; the bracket is Nemenyi's critical difference at level {ALPHA}, a test of its \
             own on ranks alone, from which bars need not follow.{of_ranks}"
        );
        self.add("critical-difference", "Critical differences", &caption, "ranks", Some(diagram));
        let caption = format!(
            "A12 of the row's optimiser against the column's. Blue favours the row, orange the column; a star marks pairs that \
             differ significantly at level {ALPHA}, others are pale.{of_pairs}"
        );
        self.add("effect-sizes", "Every two optimisers", &caption, "pairs", Some(effects));
        Ok(())
    }

    fn sweeps(&mut self) -> Result<(), PlotError> {
        if !self.plan.instances.iter().any(crate::experiment::Instance::is_task) {
            return Ok(());
        }
        for swept in Swept::ALL {
            let Some(best) = self.frame("best") else { continue };
            let figure = sweeps::sweep(best, swept, self.free_form_bound())?;
            let (name, title, caption) = told(swept);
            self.add(name, title, caption, "best", figure);
        }
        if let Some(frame) = self.frame("pareto") {
            let figure = pareto::pareto(frame)?;
            let caption = "Residual against duration of the best motions of all weights; efficient are those that no other \
                weight's beats in one without being worse in the other.";
            self.add("pareto", "Residual against duration", caption, "pareto", figure);
        }
        Ok(())
    }

    /// The least cost over motions of any shape of the first instance where it is known. It does not depend on the number of
    /// terms.
    fn free_form_bound(&self) -> Option<f64> {
        let problems = self.plan.instances.iter().filter_map(|instance| instance.reorientation());
        problems.filter_map(BestKnown::of).find_map(|known| known.free_form_j)
    }
}

/// What has to be known of the runs to read a chart.
fn notes(plan: &Plan, stored: usize) -> String {
    let planned = plan.runs.len();
    let uses = plan.optimisers.iter().filter(|o| o.settings.optimiser().needs_derivatives());
    let uses: Vec<&str> = uses.map(|entrant| entrant.label.as_str()).collect();
    let notes = [
        (stored < planned).then(|| format!(" Only {stored} of {planned} runs are stored so far.")),
        plan.is_uneven().then(|| " Budgets differ within the field.".to_owned()),
        (!uses.is_empty() && uses.len() < plan.optimisers.len())
            .then(|| format!(" Evaluations of {} come with derivatives.", uses.join(", "))),
    ];
    notes.into_iter().flatten().collect()
}

/// Name, title and caption of a sweep's chart.
fn told(swept: Swept) -> (&'static str, &'static str, &'static str) {
    match swept {
        Swept::WeightBase => (
            "weight-sweep",
            "Weight of the base",
            "Residual and duration of the best motion against the weight of the base.",
        ),
        Swept::RateLimit => (
            "rate-sweep",
            "Limit on rates",
            "Duration of the best motion against the limit on rates.",
        ),
        Swept::AccelerationLimit => (
            "acceleration-sweep",
            "Limit on accelerations",
            "Duration of the best motion against the limit on accelerations.",
        ),
        Swept::JerkLimit => (
            "jerk-sweep",
            "Limit on jerks",
            "Duration of the best motion against the limit on jerks. The dashed line, where there is one, is the \
             law that holds while jerk alone limits the motion.",
        ),
        Swept::Terms => (
            "terms-sweep",
            "Number of terms",
            "Cost of the best motion against the number of free coefficients a joint. The dashed line, where there is one, \
             is the least cost found for motions of any shape, of piecewise constant jerk.",
        ),
    }
}
