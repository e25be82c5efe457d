//! What is worth saying of a plan beside its numbers.

use std::fmt;

use super::planned::Planned;
use super::walls::Walls;
use crate::reorientation::excursions::Closest;
use crate::reorientation::family::FamilyName;
use crate::reorientation::reach::{Block, Reach};
use crate::robot::ShapeSource;

/// So many variables on walls are named.
const NAMED: usize = 4;

/// A remark on a plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remark {
    /// The motion is not what was asked for.
    Warning(String),
    /// It may be better.
    Note(String),
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Warning(text) => write!(f, "warning: {text}"),
            Self::Note(text) => write!(f, "note: {text}"),
        }
    }
}

impl Planned {
    /// Where bodies of the robot pass through each other, or what they are to be kept out of, if they do and the task does not forbid it.
    pub fn overlap(&self) -> Option<Remark> {
        if self.problem.task().path.clearance.is_some() {
            return None;
        }
        let closest = self.excursions().closest.as_ref().filter(|own| own.distance < 0.0)?;
        let Closest { between: [one, other], distance, at, shapes } = closest;
        let source = match shapes {
            ShapeSource::Stated => "",
            ShapeSource::Derived => {
                " (by shapes derived from masses and joints, as the robot's file states none)"
            }
        };
        Some(Remark::Warning(format!(
            "the motion passes through the robot itself: `{one}` and `{other}` overlap by {:.3} m at {at:.3} s{source}; \
             `clearance_m` in `[task.limits]` keeps bodies apart",
            -distance
        )))
    }

    /// Why the goal is missed, or which variables are on walls of the box, where that may matter; `budget` is what the search was given.
    pub fn remark(&self, budget: u64) -> Option<Remark> {
        let (task, family) = (self.problem.task(), self.problem.spec().name());
        let residual = self.assessment.residual().to_degrees();
        if matches!(self.reach, Reach::Reached | Reach::NotFound) {
            let missed_by = (self.reach != Reach::Reached).then_some(residual);
            if let Some(told) = self.walls.as_ref().and_then(|walls| walls_told(walls, missed_by)) {
                return Some(told);
            }
        }
        let why = match self.reach {
            Reach::Reached => return None,
            Reach::Blocked(Block::NoTurn) => {
                "and no motion brings it nearer: the joints do not turn the base".to_owned()
            }
            Reach::Blocked(Block::Holonomic) => {
                "and no motion brings it nearer: where the base ends follows from where the joints end, however they go there"
                    .to_owned()
            }
            Reach::Blocked(Block::OneAxis) => {
                "and no motion reaches it: all joints turn the base about the same axis, and the goal is a turn about another"
                    .to_owned()
            }
            Reach::TooSlow(seconds) => format!(
                "which needs about {seconds:.0} s or more, longer than motions that are searched: joints at their largest rates do \
                 not turn the base faster"
            ),
            Reach::NotFound if self.interrupted => return None,
            // Of a search that was cut off it is not known where it would have ended.
            Reach::NotFound
                if family == FamilyName::SinePolynomial
                    && self.spent.evaluations < budget
                    && self.problem.is_held_by_time(&self.coefficients, self.assessment.duration) =>
            {
                format!(
                    "because reaching it costs more time than its weight is worth. Raise `weights.base` above {}, or search \
                     splines, which always aim for the goal",
                    task.base_weight
                )
            }
            Reach::NotFound => {
                let advice = match family {
                    _ if self.spent.evaluations >= budget => "a larger budget may find one",
                    FamilyName::Spline => "another seed or more pieces may find one",
                    FamilyName::SinePolynomial => {
                        "splines, more terms or another optimiser, such as a hybrid, may find one"
                    }
                };
                let missed = if self.assessment.residual_error.is_none_or(f64::is_infinite) {
                    "as far as can be told: the motion swings too often to be evaluated reliably, and no other was found"
                } else if !self.assessment.is_within(task.goal_tolerance) {
                    "and no motion was found that reaches it"
                } else {
                    "but beyond limits or ranges, and no motion was found that keeps them"
                };
                format!("{missed}; {advice}")
            }
        };
        let digits =
            if residual < 1e-3 { format!("{residual:.1e}") } else { format!("{residual:.6}") };
        Some(Remark::Warning(format!("the base ends {digits}° from its goal, {why}")))
    }
}

/// What to say of walls, where the motion is on any: a warning of a motion that ends so far from its goal \[°\], a note of one that reaches it.
fn walls_told(walls: &Walls, missed_by: Option<f64>) -> Option<Remark> {
    let names = walls.names();
    if names.is_empty() {
        return None;
    }
    let mut on_walls = names[..names.len().min(NAMED)].join("; ");
    if names.len() > NAMED {
        on_walls = format!("{on_walls} and {} more", names.len() - NAMED);
    }
    let on_walls = format!("on walls of the search box: {on_walls}");
    let write = format!("write `{}` in `[trajectory.box]`", walls.wider().join("` and `"));
    Some(match missed_by {
        Some(degrees) => Remark::Warning(format!(
            "the base ends {degrees:.3}° from its goal, {on_walls}; a wider box may hold a motion that reaches it: \
             {write}, or try splines"
        )),
        None => Remark::Note(format!("{on_walls}; a wider box may hold a better motion: {write}")),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::input::Document;
    use crate::reorientation::{Formulated, Formulation, TaskFile};
    use crate::search::Problem as _;

    #[test]
    fn walls_are_named_with_what_to_write() {
        let document = Document::embedded("task", "[trajectory.box]\ncoefficient = [1, 0.35]");
        let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
        let problem = Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap();
        let told = |change: &dyn Fn(&mut [f64]), missed_by| {
            let mut x: Vec<f64> = problem.bounds().iter().map(|[l, u]| l + 0.4 * (u - l)).collect();
            change(&mut x);
            let (coefficients, _) = problem.decode(&x);
            walls_told(&Walls::of(&problem, &coefficients, 8.0), missed_by)
        };
        assert_eq!(told(&|_| {}, Some(3.0)), None);

        let two = |x: &mut [f64]| (x[0], x[5]) = (1.0, -0.35);
        let write = "write `coefficient = [2.0, 0.7]` in `[trajectory.box]`";
        let reached = told(&two, None).unwrap().to_string();
        assert!(reached.starts_with("note: ") && reached.ends_with(write), "{reached}");
        let missed = told(&two, Some(3.0)).unwrap().to_string();
        assert!(missed.starts_with("warning: the base ends 3.000° ") && missed.contains(write));

        let many = told(&|x: &mut [f64]| x[..12].fill(-0.35), None).unwrap().to_string();
        assert!(many.contains("joint 4, bump 2 and 2 more; a wider box"), "{many}");
    }
}
