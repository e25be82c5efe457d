//! The last step of a plan: what is left of the base's error is taken away where a search left some.

use crate::reorientation::derivatives::Timing;
use crate::reorientation::fitness::Assessment;
use crate::reorientation::formulation::{Formulated, Formulation};
use crate::search::{ErrorSlopes, Problem as _};
use crate::trajectory::Family;

/// Residuals below this share of the goal's tolerance are left, and those of so many times it, which are another valley's.
const LEFT: f64 = 0.01;
const FAR: f64 = 100.0;

/// Most steps.
const STEPS: usize = 3;

/// Singular values below this share of the largest are none.
const SINGULAR: f64 = 1e-9;

/// The point and its motion or, where a motion beside it ends nearer to the goal at a lower cost, that one: by Gauss and Newton's
/// method, with the shortest steps that make up for the error.
pub(super) fn closed<F: Family>(problem: &Formulated<F>, x: &[f64]) -> (Vec<f64>, Assessment) {
    let (mut coefficients, mut best) = problem.certify(x);
    let tolerance = problem.task().task().goal_tolerance;
    if problem.formulation() != Formulation::TimeFree {
        return (coefficients, best);
    }
    for _ in 0..STEPS {
        if !(LEFT * tolerance..FAR * tolerance).contains(&best.residual()) {
            break;
        }
        let Some(next) = step(problem, &coefficients) else { break };
        let (next, found) = problem.certify(&next);
        if !(found.cost < best.cost && found.residual() < best.residual()) {
            break;
        }
        (coefficients, best) = (next, found);
    }
    (coefficients, best)
}

fn step<F: Family>(problem: &Formulated<F>, coefficients: &[f64]) -> Option<Vec<f64>> {
    let timing: Timing = problem.task().timing(coefficients);
    let ErrorSlopes { value, slopes } = problem.task().error_slopes(coefficients, &timing);
    if !slopes.iter().chain(&value).all(|number| number.is_finite()) {
        return None;
    }
    let svd = slopes.svd(true, true);
    let least = SINGULAR * svd.singular_values.max();
    let change = svd.solve(&value, least).ok()?;
    let bounds = problem.bounds();
    let moved = coefficients.iter().zip(&change).zip(bounds.iter());
    Some(moved.map(|((c, change), [lower, upper])| (c - change).clamp(lower, upper)).collect())
}
