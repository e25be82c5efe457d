//! What the residuals of sampled robots add to the cost.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::accuracy::Accuracy;
use super::derivatives::Timing;
use super::fitness::Reorientation;
use super::terms::Terms;
use crate::search::{ErrorSlopes, Piece, Term};
use crate::task::{PathLimits, Robust, RobustOf, Task};
use crate::trajectory::Family;

impl<F: Family> Reorientation<F> {
    /// The task with sampled robots, if it asks for any.
    pub(super) fn variants_of(task: &Task, family: &F, accuracy: Accuracy) -> Arc<[Self]> {
        let Some(robust) = &task.robust else { return Arc::default() };
        let path = PathLimits::default();
        let plain = Task { path, robust: None, tool: None, ..task.clone() };
        // That the robots can be made is known since the task was read.
        let drawn = robust.uncertainty.draw(&plain).unwrap_or_default().into_iter();
        drawn.map(|task| Self::over(Arc::new(task), family.clone(), accuracy)).collect()
    }

    /// What sampled robots add to the cost.
    pub(super) fn robust_cost(&self, coefficients: &[f64]) -> f64 {
        let Some(Robust { of, weight, .. }) = &self.task().robust else { return 0.0 };
        // With momentum no robust plans are asked for, so the duration does not matter.
        let error = |variant: &Self| {
            variant.error_after(variant.rotation_over(coefficients, 0.0)).imag().norm()
        };
        let errors: Vec<f64> = self.variants().par_iter().map(error).collect();
        let together = match of {
            RobustOf::Mean => errors.iter().sum::<f64>() / errors.len() as f64,
            RobustOf::Worst => errors.iter().copied().fold(0.0, f64::max),
        };
        Terms::error_weight(*weight) * together
    }

    /// The same over smooth pieces: the size of each error, or the mean of all.
    pub(super) fn robust_term(&self, coefficients: &[f64]) -> Option<Term> {
        let Robust { of, weight, .. } = self.task().robust.as_ref()?;
        let errors = self.variants().par_iter().enumerate().map(|(i, variant)| {
            let ErrorSlopes { value, slopes } =
                variant.error_slopes(coefficients, &Timing::default());
            let size = value.norm();
            // At an error of nothing a subgradient is nothing.
            let direction = if size > 0.0 { value / size } else { value };
            Piece::new(i as u64, size, slopes.tr_mul(&direction).as_slice())
        });
        let errors: Vec<Piece> = errors.collect();
        let pieces = match of {
            RobustOf::Worst => errors,
            RobustOf::Mean => {
                let count = errors.len() as f64;
                let none = DVector::zeros(coefficients.len());
                let sum = errors.iter().fold(none, |sum, error| sum + &error.gradient);
                let value = errors.iter().map(|error| error.value).sum::<f64>() / count;
                vec![Piece::new(0, value, (sum / count).as_slice())]
            }
        };
        Some(Terms::robust(*weight, pieces))
    }
}
