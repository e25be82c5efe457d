//! What a report says first, in sentences.

use polars::prelude::*;
use serde::Serialize;

use crate::analysis::tables::Table;
use crate::analysis::{Run, best_run};
use crate::experiment::Plan;

/// A paragraph of what came of an experiment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Verdict {
    /// What it is about.
    pub heading: String,
    /// What there is to say.
    pub text: String,
}

/// Who came first, whether that is significant, and what the best motion is.
pub fn verdict(plan: &Plan, runs: &[Run], tables: &[Table]) -> PolarsResult<Vec<Verdict>> {
    let mut verdict = Vec::new();
    if let Some(ranks) = tables.iter().find(|table| table.name == "ranks") {
        verdict.extend(first(&ranks.frame)?);
    }
    if plan.instances.len() == 1
        && let Some(best) = best_run(runs.iter())
    {
        let (symbol, optimiser) = (plan.cost_symbol(), &plan.optimisers[best.optimiser].label);
        let told = if plan.instances[0].is_task() {
            format!(
                ": the motion takes {:.4} s and leaves the base {:.2e}° from where it should point",
                best.duration, best.residual_deg
            )
        } else {
            String::new()
        };
        let text =
            format!("{optimiser} with seed {} found {symbol} = {:.6}{told}.", best.seed, best.cost);
        verdict.push(Verdict { heading: "The best".to_owned(), text });
    }
    if runs.len() < plan.runs.len() {
        let text = format!("Only {} of {} runs are stored so far.", runs.len(), plan.runs.len());
        verdict.push(Verdict { heading: "Not all is done".to_owned(), text });
    }
    Ok(verdict)
}

/// The first of the mean ranks, and who shares a clique with it.
fn first(ranks: &DataFrame) -> PolarsResult<Option<Verdict>> {
    let (names, cliques) = (ranks.column("optimiser")?.str()?, ranks.column("cliques")?.str()?);
    let (Some(name), Some(rank)) = (names.get(0), ranks.column("mean rank")?.f64()?.get(0)) else {
        return Ok(None);
    };
    let words =
        |row| -> Vec<&str> { cliques.get(row).unwrap_or_default().split([' ', ',']).collect() };
    let own: Vec<&str> = words(0).into_iter().filter(|clique| !clique.is_empty()).collect();
    let alike =
        (1..ranks.height()).filter(|&row| words(row).iter().any(|clique| own.contains(clique)));
    let alike: Vec<&str> = alike.filter_map(|row| names.get(row)).collect();
    let differs = match (alike.len(), ranks.height() - 1) {
        (0, _) => "It differs significantly from all others.".to_owned(),
        (some, all) if some == all => {
            "It differs significantly from none of the others.".to_owned()
        }
        _ => format!("It differs significantly from all others but {}.", alike.join(", ")),
    };
    let text =
        format!("{name} has the lowest mean rank, {rank:.2} among {}. {differs}", ranks.height());
    Ok(Some(Verdict { heading: "First".to_owned(), text }))
}
