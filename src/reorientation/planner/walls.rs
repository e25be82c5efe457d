//! Which variables of a motion lie on the walls of its search box, and what to write to move them.

use crate::reorientation::formulation::{Formulated, Formulation};
use crate::search::Problem as _;
use crate::trajectory::Family as _;

/// A variable nearer to a wall than this share of its box is on it.
const ON: f64 = 1e-4;

/// A variable of the box, one with a duration last and joints counted from one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Variable {
    /// The coefficient of a bump, counted from one.
    Bump {
        joint: usize,
        bump: usize,
    },
    /// `α` of a power of time.
    Alpha {
        joint: usize,
        power: usize,
    },
    Duration,
}

/// The variables on the walls.
#[derive(Debug, Clone)]
pub struct Walls {
    on: Vec<Variable>,
    /// The keys of `[trajectory.box]` that would double the box there.
    wider: Vec<String>,
}

impl Walls {
    /// Those of a motion that was found in the problem's box.
    pub fn of(problem: &Formulated, coefficients: &[f64], duration: f64) -> Self {
        let family = problem.task().family();
        let (joints, terms) = (family.leading(), family.terms());
        let count = joints.len();
        let variable = |i: usize| match problem.formulation() {
            _ if i == count * terms => Variable::Duration,
            Formulation::Raw => {
                Variable::Alpha { joint: joints[i % count] + 1, power: i / count + 6 }
            }
            Formulation::Scaled | Formulation::TimeFree => {
                Variable::Bump { joint: joints[i / terms] + 1, bump: i % terms + 1 }
            }
        };
        let (mut on, mut widths) = (Vec::new(), vec![(0.0, 1.0); terms]);
        let (mut times, mut key) = (None, "coefficient");
        let x = problem.encode(coefficients, duration);
        for (i, (x, [lower, upper])) in x.iter().zip(problem.bounds().iter()).enumerate() {
            let variable = variable(i);
            let is_on = (x - lower).min(upper - x) <= ON * (upper - lower);
            on.extend(is_on.then_some(variable));
            let by = if is_on { 2.0 } else { 1.0 };
            let mut widen = |term: usize| widths[term] = (upper, f64::max(widths[term].1, by));
            match variable {
                Variable::Bump { bump, .. } => widen(bump - 1),
                Variable::Alpha { power, .. } => {
                    key = "alpha";
                    widen(power - 6);
                }
                Variable::Duration if is_on && upper - x < x - lower => {
                    times = Some([lower, 2.0 * upper]);
                }
                Variable::Duration if is_on => times = Some([lower / 2.0, upper]),
                Variable::Duration => {}
            }
        }
        let mut wider = Vec::new();
        if widths.iter().any(|(_, by)| *by > 1.0) {
            let widths: Vec<f64> = widths.iter().map(|(width, by)| short(width * by)).collect();
            wider.push(format!("{key} = {widths:?}"));
        }
        wider.extend(times.map(|times| format!("duration = {:?}", times.map(short))));
        Self { on, wider }
    }

    /// Their names.
    pub fn names(&self) -> Vec<String> {
        let name = |variable: &Variable| match variable {
            Variable::Bump { joint, bump } => format!("joint {joint}, bump {bump}"),
            Variable::Alpha { joint, power } => format!("joint {joint}, α_{power}"),
            Variable::Duration => "duration".to_owned(),
        };
        self.on.iter().map(name).collect()
    }

    /// The keys of `[trajectory.box]` that would double the box there; empty where the motion is on no wall.
    pub fn wider(&self) -> &[String] {
        &self.wider
    }
}

/// To four significant digits.
fn short(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::input::Document;
    use crate::reorientation::TaskFile;

    fn walls(formulation: Formulation, change: impl Fn(&mut [f64])) -> Walls {
        let text = "[trajectory.box]\ncoefficient = [1, 0.35]\nduration = [4, 12]";
        let document = Document::embedded("task", text);
        let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
        let problem = Formulated::new(formulation, Arc::new(problem), &boxes).unwrap();
        let mut x: Vec<f64> = problem.bounds().iter().map(|[l, u]| l + 0.4 * (u - l)).collect();
        change(&mut x);
        let (coefficients, duration) = problem.decode(&x);
        Walls::of(&problem, &coefficients, duration.unwrap_or(8.0))
    }

    #[test]
    fn names_walls_and_the_box_that_would_move_them() {
        let inside = walls(Formulation::TimeFree, |_| {});
        assert!(inside.names().is_empty() && inside.wider().is_empty(), "{inside:?}");

        let on = walls(Formulation::TimeFree, |x| (x[0], x[5]) = (1.0, -0.35));
        assert_eq!(on.names(), ["joint 1, bump 1", "joint 3, bump 2"]);
        assert_eq!(on.wider(), ["coefficient = [2.0, 0.7]"]);

        let second = walls(Formulation::Scaled, |x| (x[3], x[12]) = (0.35, 12.0));
        assert_eq!(second.names(), ["joint 2, bump 2", "duration"]);
        assert_eq!(second.wider(), ["coefficient = [1.0, 0.7]", "duration = [4.0, 24.0]"]);

        let raw = walls(Formulation::Raw, |x| x[12] = 4.0);
        assert_eq!(raw.names(), ["duration"]);
        assert_eq!(raw.wider(), ["duration = [2.0, 12.0]"]);
    }
}
