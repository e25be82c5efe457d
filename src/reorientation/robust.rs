//! What the residuals of robots as they may be add to the cost.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::accuracy::Accuracy;
use super::fitness::Reorientation;
use super::terms::Terms;
use crate::lanes::Width;
use crate::search::{ErrorSlopes, Piece, Term};
use crate::task::{PathLimits, RobustOf, Task};
use crate::trajectory::Family;

/// The task with robots as they may be.
#[derive(Debug, Clone)]
pub(super) struct Variants<F: Family> {
    problems: Arc<[Reorientation<F>]>,
    of: RobustOf,
    weight: f64,
}

impl<F: Family> Variants<F> {
    /// Those that a task asks for, if it asks for any.
    pub(super) fn of(task: &Task, family: &F, accuracy: Accuracy) -> Option<Self> {
        let robust = task.robust.as_ref()?;
        let plain = Task { path: PathLimits::default(), robust: None, tool: None, ..task.clone() };
        // That the robots can be made is known since the task was read.
        let drawn = robust.uncertainty.draw(&plain).ok()?;
        let problem = |task: Task| Reorientation::over(Arc::new(task), family.clone(), accuracy);
        let problems = drawn.into_iter().map(problem).collect();
        Some(Self { problems, of: robust.of, weight: robust.weight })
    }

    pub(super) fn with_width(&self, width: Width) -> Self {
        let problems = self.problems.iter().map(|problem| problem.with_width(width)).collect();
        Self { problems, of: self.of, weight: self.weight }
    }

    /// What is added to the cost.
    pub(super) fn cost(&self, coefficients: &[f64]) -> f64 {
        let error = |problem: &Reorientation<F>| {
            problem.error_after(problem.net_rotation(coefficients)).imag().norm()
        };
        let errors: Vec<f64> = self.problems.par_iter().map(error).collect();
        let together = match self.of {
            RobustOf::Mean => errors.iter().sum::<f64>() / errors.len() as f64,
            RobustOf::Worst => errors.iter().copied().fold(0.0, f64::max),
        };
        Terms::error_weight(self.weight) * together
    }

    /// The same over smooth pieces: the size of each error, or of all of them together.
    pub(super) fn term(&self, coefficients: &[f64]) -> Term {
        let errors = self.problems.par_iter().enumerate().map(|(i, problem)| {
            let ErrorSlopes { value, slopes } = problem.error_slopes(coefficients);
            let size = value.norm();
            // At an error of nothing a subgradient is nothing.
            let direction = if size > 0.0 { value / size } else { value };
            Piece::new(i as u64, size, slopes.tr_mul(&direction).as_slice())
        });
        let errors: Vec<Piece> = errors.collect();
        let pieces = match self.of {
            RobustOf::Worst => errors,
            RobustOf::Mean => {
                let count = errors.len() as f64;
                let variables = errors.first().map_or(0, |piece| piece.gradient.len());
                let sum = errors.iter().fold(DVector::zeros(variables), |sum, e| sum + &e.gradient);
                let value = errors.iter().map(|piece| piece.value).sum::<f64>() / count;
                vec![Piece::new(0, value, (sum / count).as_slice())]
            }
        };
        Terms::robust(self.weight, pieces)
    }
}
