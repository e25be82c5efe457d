//! What the task shows of its runs beside what every experiment shows: findings, tables, charts and scenes.

mod base_attitude;
pub(super) mod best;
mod charts;
mod derivatives;
mod joint_angles;
mod motion_charts;
mod motion_finding;
mod motion_table;
mod on_the_way;
mod pareto;
mod quality;
mod scene;
mod snapshots;
mod sweep_finding;
#[cfg(test)]
mod sweep_tests;
mod sweeps;
#[cfg(test)]
mod tests;
pub(super) mod words;

use motion_charts::MOTION_NAMES;
#[cfg(feature = "cli")]
pub(crate) use motion_charts::{SAMPLES, write_motion_figures};
#[cfg(feature = "harness")]
pub(super) use motion_table::motion_table;
pub use scene::{FoundBy, motion_scene};

use crate::exhibit::Exhibits;
use crate::experiment::Results;
use crate::reorientation::best_known::BestKnown;
use crate::reorientation::export::Record;
use best::{BestMotion, best_motions};
use pareto::Traded;

/// Most instances whose best motion a terminal is told of.
const MOST_TOLD: usize = 24;

/// All that there is to show of the tasks of a plan.
pub(super) fn exhibits(results: &Results<'_>) -> Exhibits {
    let best = best_motions(results);
    let (leading_charts, left_out) = charts::charts(&best, results.instances);
    let mut exhibits = Exhibits {
        sweep: sweep_finding::finding(&best),
        quality: quality::finding(results, &best),
        findings: motion_finding::finding(results, &best).into_iter().chain(left_out).collect(),
        lines: lines(&best),
        leading_charts,
        scenes: scene::scenes(&best),
        scenes_found: best.len(),
        table_names: Traded::ALL.map(Traded::name).into_iter().chain(["motion"]).collect(),
        chart_names: charts::NAMES.into_iter().chain(MOTION_NAMES).collect(),
        ..Exhibits::default()
    };
    exhibits.tables.extend(Traded::ALL.iter().filter_map(|traded| pareto::table(&best, *traded)));
    // Costs of different instances do not compare, so of several there is no best of all to draw.
    if let (1, [motion]) = (results.instances.len(), &best[..]) {
        let sampled = motion.sample(motion_charts::SAMPLES);
        let task = motion.problem.task();
        exhibits.charts.extend(motion_charts::motion_charts(&sampled, task));
        exhibits.chart_tables.extend(motion_table(&Record::new(&task.robot, sampled)).ok());
    }
    exhibits
}

fn lines(best: &[BestMotion<'_>]) -> Vec<String> {
    let line = |motion: &BestMotion<'_>| {
        let known = BestKnown::of(motion.problem).map_or_else(String::new, |known| {
            format!(" ({})", known.compared_with(motion.run.cost))
        });
        let label = &motion.instance.label;
        let on = if label.is_empty() { "" } else { " for " };
        format!(
            "best motion{on}{label}: {}, seed {}: J {:.6}{known}, t_f {:.4} s",
            motion.optimiser, motion.run.seed, motion.run.cost, motion.duration
        )
    };
    let mut lines: Vec<String> = best.iter().take(MOST_TOLD).map(line).collect();
    if best.len() > MOST_TOLD {
        lines.push("… all instances' best motions are in tables/best.csv".to_owned());
    }
    lines
}
