//! What `plan` and `serve` say of what was found.

use std::fmt::Write as _;

use super::motion::Told;
use crate::reorientation::{
    BestKnown, FamilySpec, LegMotion, NOT_CHECKED, OtherFamily, Planned, PlannedLeg,
    PlannedMission, Reach, Robustness, Spent,
};
use crate::task::Task;
use crate::words::plural;

/// For people.
pub(super) fn told(found: &Planned) -> String {
    let task = found.problem.task();
    let mut text = match found.problem.spec() {
        FamilySpec::SinePolynomial { terms } => {
            format!("  family         sine polynomials with {}\n", plural(terms, "term"))
        }
        FamilySpec::Spline { pieces, degree } => {
            format!(
                "  family         splines of degree {degree} with {}\n",
                plural(pieces, "piece")
            )
        }
    };
    let excursions = found.excursions();
    let told = Told { task, assessment: &found.assessment, excursions };
    let _ = writeln!(text, "{told}");
    let _ = writeln!(text, "  verdict        {}", found.verdict());
    if let Some(robustness) = found.robustness().filter(|own| !own.sensitivities.is_empty()) {
        let _ = writeln!(text, "{}", robustness_told(&robustness, task));
    }
    let _ = writeln!(text, "  not checked    {}", NOT_CHECKED.join(", "));
    if let Some(known) = BestKnown::of(&*found.problem) {
        let _ = writeln!(text, "  this J         {}", known.compared_with(found.assessment.cost));
    }
    if let Some(other) = &found.other {
        let _ = writeln!(text, "  in comparison  {}", other_told(other, task));
    }
    let Spent { evaluations, seconds, .. } = found.spent;
    let _ = write!(text, "  {} in {seconds:.2} s", plural(evaluations as usize, "evaluation"));
    text
}

/// Residuals of sampled robots, and what they come from.
fn robustness_told(robustness: &Robustness, task: &Task) -> String {
    let [median, most, worst] =
        [0.5, 0.95, 1.0].map(|share| robustness.quantile(share).to_degrees());
    let largest = robustness.sensitivities.iter().take(3);
    let largest = largest.map(|(unknown, angle)| {
        format!("{} {:.4}°", unknown.name(&task.robot), angle.to_degrees())
    });
    format!(
        "  uncertain      residual of {}: {median:.4}° in the median, {most:.4}° for 95 %, {worst:.4}° at worst\n\
         \x20                most of it by {}",
        plural(robustness.residuals.len(), "sampled robot"),
        largest.collect::<Vec<_>>().join(", ")
    )
}

/// Motion by motion.
pub(super) fn mission_told(found: &PlannedMission) -> String {
    let mut text = String::new();
    for PlannedLeg { name, motion } in &found.legs {
        let _ = writeln!(text, "{name}:");
        match motion {
            LegMotion::Planned(found) => {
                let _ = writeln!(text, "{}", told(found));
            }
            LegMotion::Straight { points, distance, .. } => {
                let duration = points.duration();
                let _ = writeln!(text, "  straight       {distance} m in {duration:.6} s");
            }
        }
    }
    let verdict = if found.is_reached() {
        "all motions reach their goals and keep all limits and ranges"
    } else {
        "not all motions reach their goals within all limits and ranges"
    };
    let _ = write!(
        text,
        "all together:\n  duration       {:.6} s\n  verdict        {verdict}",
        found.duration()
    );
    text
}

fn other_told(other: &OtherFamily, task: &Task) -> String {
    let OtherFamily { terms, t_f, residual_deg, status } = other;
    let found = match status {
        Reach::Reached => format!("{t_f:.6} s"),
        _ if *residual_deg <= task.goal_tolerance_deg() => {
            "none found that keeps all limits".to_owned()
        }
        _ => format!("none found that reaches the goal ({residual_deg:.3}° off)"),
    };
    format!("sine polynomials with {}: {found}", plural(*terms, "term"))
}
