//! First derivatives of the time-free cost, for optimisers that use them.

use nalgebra::{DMatrix, DVector};
use num_dual::{Derivative, DualSVec64};

use super::{Formulated, Problem, Reorientation};
use crate::trajectory::{LocalPeak, Path, Peaks, duration_asked};

/// A cost that is convex in smooth parts: `J(x) = a ‖r(x)‖ + b max_p h_p(x)`.
pub trait Composite: Problem {
    /// Values and first derivatives of all parts that matter near `x`.
    fn linearise(&self, x: &[f64]) -> Linearisation;
}

/// Values and first derivatives at a point.
#[derive(Debug, Clone)]
pub struct Linearisation {
    /// `a`.
    pub norm_weight: f64,
    /// `r`.
    pub residual: DVector<f64>,
    /// One row a component of `r`, one column a variable.
    pub residual_jacobian: DMatrix<f64>,
    /// `b`.
    pub max_weight: f64,
    /// The `h_p` that are largest or not far from it.
    pub pieces: Vec<Piece>,
}

/// One `h_p`.
#[derive(Debug, Clone)]
pub struct Piece {
    /// What tells it from the others, the same at points that are near.
    pub place: LocalPeak,
    /// Value.
    pub value: f64,
    /// Derivative by each variable.
    pub gradient: DVector<f64>,
}

/// Variables differentiated at a time.
const WIDTH: usize = 6;

/// A number with its derivatives by [`WIDTH`] variables.
type Dual = DualSVec64<WIDTH>;

/// How far below the largest, as a share of it, a part may lie to be linearised too.
const NEAR: f64 = 0.75;

impl Reorientation {
    /// The time-free cost's parts: the vector part of the base's error, and the duration that each
    /// local peak of rate, acceleration and jerk asks for.
    pub(super) fn linearise(&self, coefficients: &[f64]) -> Linearisation {
        let n = coefficients.len();
        let path = self.family().path(coefficients);
        let limits = &self.task().limits;
        let places = Peaks::local(&path, self.accuracy().peak_intervals, limits, NEAR);
        let mut residual = DVector::zeros(3);
        let mut residual_jacobian = DMatrix::zeros(3, n);
        let mut values = vec![0.0; places.len()];
        let mut gradients = DMatrix::zeros(n, places.len());
        for first in (0..n).step_by(WIDTH) {
            let width = WIDTH.min(n - first);
            let path = self.family().path(&seeded(coefficients, first, width));
            let error = self.base_error(&path);
            for (k, component) in error.iter().enumerate() {
                residual[k] = component.re;
                for (j, slope) in slopes(component).iter().take(width).enumerate() {
                    residual_jacobian[(k, first + j)] = *slope;
                }
            }
            for (p, place) in places.iter().enumerate() {
                let duration = duration_at(&path, place, limits.0[place.joint][place.order - 1]);
                values[p] = duration.re;
                for (j, slope) in slopes(&duration).iter().take(width).enumerate() {
                    gradients[(first + j, p)] = *slope;
                }
            }
        }
        let pieces = places.into_iter().zip(values).enumerate().map(|(p, (place, value))| Piece {
            place,
            value,
            gradient: gradients.column(p).into_owned(),
        });
        let (norm_weight, max_weight) = self.weights();
        Linearisation {
            norm_weight,
            residual,
            residual_jacobian,
            max_weight,
            pieces: pieces.collect(),
        }
    }
}

/// The coefficients, those of one window with their unit derivatives.
fn seeded(coefficients: &[f64], first: usize, width: usize) -> Vec<Dual> {
    let seed = |(i, &c): (usize, &f64)| {
        let mut dual = Dual::from_re(c);
        if (first..first + width).contains(&i) {
            let mut unit = nalgebra::SVector::<f64, WIDTH>::zeros();
            unit[i - first] = 1.0;
            dual.eps = Derivative::some(unit);
        }
        dual
    };
    coefficients.iter().enumerate().map(seed).collect()
}

fn slopes(dual: &Dual) -> [f64; WIDTH] {
    dual.eps.0.map_or([0.0; WIDTH], Into::into)
}

/// The shortest duration within one limit at one place of the path \[s\].
fn duration_at(path: &Path<'_, Dual>, place: &LocalPeak, limit: f64) -> Dual {
    let value = path.joint(place.joint).derivatives(place.tau)[place.order];
    let magnitude = if value.re < 0.0 { -value } else { value };
    duration_asked(magnitude / limit, place.order)
}

impl Composite for Formulated {
    fn linearise(&self, x: &[f64]) -> Linearisation {
        self.task().linearise(x)
    }
}
