//! Every chart that an experiment's tables give.

use polars::prelude::DataFrame;

use super::chart::Chart;
use super::figure::{Figure, PlotError};
use super::looks::Looks;
use super::sweeps::Swept;
use super::{comparison, convergence, critical_difference, running_times, sweeps};
use crate::analysis::tables::Table;
use crate::experiment::Plan;
use crate::problem::BestKnown;

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
    charts: Vec<Chart>,
}

/// Every chart that an experiment's tables give. Those of more than 24 groups of instances, or of more than eight
/// curves of a sweep, are left out.
pub fn charts(plan: &Plan, tables: &[Table]) -> Result<Vec<Chart>, PlotError> {
    let looks = Looks::of(&plan.optimisers);
    let mut maker = Maker { plan, tables, looks, charts: Vec::new() };
    maker.costs()?;
    maker.times()?;
    maker.ranks()?;
    maker.sweeps()?;
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
        self.charts.extend(figure.map(|figure| Chart {
            name: name.to_owned(),
            title: title.to_owned(),
            caption: caption.to_owned(),
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
                 ended early keeps the best it had."
            );
            self.add("convergence", "Convergence", &caption, "convergence", figure);
        }
        // One optimiser on many instances is what sweeps are about.
        let is_field = self.plan.optimisers.len() > 1 || self.plan.instances.len() == 1;
        if let Some(frame) = self.frame("runs").filter(|_| is_field) {
            let figure = comparison::final_costs(frame, &self.looks, symbol)?;
            let caption = format!(
                "Final {symbol} of all runs, certified: quartiles as a box, the least and the largest as whiskers, single \
                 runs as points where there are thirty at most."
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
        if let Some(frame) = self.frame("performance-profiles") {
            let label = "multiple of the fewest evaluations";
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
        let diagram = critical_difference::critical_difference(ranks, friedman, &self.looks)?;
        let effects = comparison::effect_sizes(pairs, ranks)?;
        let caption = "Mean ranks of the final costs, 1 being the best. A bar joins optimisers of which no two differ \
            significantly by Wilcoxon's test with Holm's correction at level 0.05.";
        let title = "Critical differences";
        self.add("critical-difference", title, caption, "ranks", Some(diagram));
        let caption = "Vargha and Delaney's A12: the probability that a run of the row's optimiser ends lower than a run of the \
            column's on the same instance, ties half. Blue favours the row, orange the column; a star marks pairs that differ \
            significantly, others are pale.";
        self.add("effect-sizes", "Every two optimisers", caption, "pairs", Some(effects));
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
            let figure = sweeps::pareto(frame)?;
            let caption = "Residual against duration of the best motions of all weights; efficient are those that no other \
                weight's beats in one without being worse in the other.";
            self.add("pareto", "Residual against duration", caption, "pareto", Some(figure));
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
            "Duration of the best motion against the limit on jerks. The dotted line is the law that holds while jerk alone \
             limits the motion.",
        ),
        Swept::Terms => (
            "terms-sweep",
            "Number of terms",
            "Cost of the best motion against the number of free coefficients a joint. The dotted line, where there is one, \
             is the least cost found for motions of any shape.",
        ),
    }
}
