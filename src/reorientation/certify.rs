//! A motion evaluated finely enough, and how sure that is.

use nalgebra::UnitQuaternion;

use super::accuracy::Accuracy;
use super::fitness::{Assessment, Reorientation};
use crate::trajectory::Family;

/// Two evaluations, one twice as fine as the other, agree where the base's ends differ by no more than this angle \[rad\],
/// and the duration and all peaks by no more than a share of their size.
const SAME_END: f64 = 1e-10;
const SAME_PEAK: f64 = 1e-9;

/// How often an evaluation is made twice as fine where they do not agree: 100,000 steps in the end.
const DOUBLINGS: usize = 8;

/// The largest rate of a joint by `τ` \[rad\] that the finest evaluation can follow.
const FASTEST: f64 = 1e5;

/// The largest difference of ends \[rad\] that is taken for an estimate of an error. Steps too wide for a path err by anything.
const AN_ESTIMATE: f64 = 1e-2;

impl<F: Family> Reorientation<F> {
    /// The motion as [`assess`](Self::assess) has it, evaluated with [`Accuracy::FINE`] or, where twice the steps and intervals
    /// come to something else, ever more finely until they do not; with an estimate of the residual's error.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn certify(&self, coefficients: &[f64], duration: Option<f64>) -> Assessment {
        let mut problem = self.with_accuracy(Accuracy::FINE);
        let (mut end, mut found) = problem.look(coefficients, duration);
        let mut error = f64::INFINITY;
        let mut rates = found.peaks.0.iter().map(|peaks| peaks[0].value * found.duration);
        let doublings = if rates.all(|rate| rate <= FASTEST) { DOUBLINGS } else { 0 };
        for _ in 0..doublings {
            problem = self.with_accuracy(problem.twice_as_fine());
            let (next_end, next) = problem.look(coefficients, duration);
            let difference = UnitQuaternion::angle_to(&end, &next_end);
            error = if found.agrees(&next) && difference <= AN_ESTIMATE {
                difference
            } else {
                f64::INFINITY
            };
            if error <= SAME_END || !next.cost.is_finite() {
                break;
            }
            (end, found) = (next_end, next);
        }
        Assessment { residual_error: Some(error), ..found }
    }
}

impl Assessment {
    /// Whether another evaluation has the same duration and peaks.
    fn agrees(&self, other: &Self) -> bool {
        let heights = |assessment: &Self| -> Vec<f64> {
            let peaks = assessment.peaks.0.iter().flatten().map(|peak| peak.value);
            peaks.chain([assessment.duration]).collect()
        };
        heights(self).iter().zip(heights(other)).all(|(a, b)| (a - b).abs() <= SAME_PEAK * a.max(b))
    }
}
