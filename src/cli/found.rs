//! What `plan` and `serve` say of what was found.

use std::fmt::Write as _;

use super::motion::Told;
use crate::reorientation::{
    BestKnown, FamilySpec, NOT_CHECKED, OtherFamily, Planned, Reach, Spent,
};

/// For people.
pub(super) fn told(found: &Planned) -> String {
    let task = found.problem.task();
    let mut text = match found.problem.spec() {
        FamilySpec::SinePolynomial { terms } => {
            format!("  family         sine polynomials with {terms} terms\n")
        }
        FamilySpec::Spline { pieces, degree } => {
            format!("  family         splines of degree {degree} with {pieces} pieces\n")
        }
    };
    let excursions = found.excursions();
    let told = Told { task, assessment: &found.assessment, excursions };
    let _ = writeln!(text, "{told}");
    let _ = writeln!(text, "  verdict        {}", found.verdict());
    let _ = writeln!(text, "  not checked    {}", NOT_CHECKED.join(", "));
    if let Some(known) = BestKnown::of(&*found.problem) {
        let _ = writeln!(text, "  this J         {}", known.compared_with(found.assessment.cost));
    }
    if let Some(other) = &found.other {
        let _ = writeln!(text, "  in comparison  {}", other_told(other));
    }
    let Spent { evaluations, seconds, .. } = found.spent;
    let s = if evaluations == 1 { "" } else { "s" };
    let _ = write!(text, "  {evaluations} evaluation{s} in {seconds:.2} s");
    text
}

fn other_told(other: &OtherFamily) -> String {
    let OtherFamily { terms, t_f, residual_deg, status } = other;
    let found = match status {
        Reach::Reached => format!("{t_f:.6} s"),
        _ => format!("none found that reaches the goal ({residual_deg:.3}° off)"),
    };
    format!("sine polynomials with {terms} terms: {found}")
}
