//! All paths of the sine-polynomial family between two configurations.

use super::basis::Basis;
use super::path::{Path, Span};
use crate::scalar::Scalar;

/// All paths of the family between two configurations.
///
/// `s = s_0 + (s_f − s_0) σ(τ) + 64 τ³(1−τ)³ Σ_k c_k P_k(2τ−1)`; the coefficients `c` select one.
/// They are ordered joint by joint, `terms` for each.
#[derive(Debug, Clone)]
pub struct Family {
    spans: Vec<Span>,
    basis: Basis,
}

impl Family {
    /// From the joints' ranges and both configurations \[rad\], each start and goal in its range.
    ///
    /// # Panics
    ///
    /// Panics when the three lists differ in length, or without a term.
    pub fn new(ranges: &[[f64; 2]], start: &[f64], goal: &[f64], terms: usize) -> Self {
        assert!(ranges.len() == start.len() && start.len() == goal.len(), "one of each a joint");
        assert!(terms > 0, "at least one term");
        let spans = ranges
            .iter()
            .zip(start.iter().zip(goal))
            .map(|(range, (&start, &goal))| Span::new(*range, start, goal))
            .collect();
        Self { spans, basis: Basis::new(terms) }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.spans.len()
    }

    /// Free coefficients a joint.
    pub fn terms(&self) -> usize {
        self.basis.terms()
    }

    /// Free coefficients in all.
    pub fn dimension(&self) -> usize {
        self.joints() * self.terms()
    }

    /// The path with these coefficients.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn path<T: Scalar>(&self, coefficients: &[T]) -> Path<'_, T> {
        assert_eq!(coefficients.len(), self.dimension(), "terms × joints coefficients");
        let terms = self.terms();
        let mut free = vec![T::zero(); self.dimension()];
        for (row, c) in free.chunks_exact_mut(terms).zip(coefficients.chunks_exact(terms)) {
            for (polynomial, &coefficient) in self.basis.polynomials().iter().zip(c) {
                for (power, &p) in row.iter_mut().zip(polynomial) {
                    *power += coefficient * T::of(p);
                }
            }
        }
        Path::new(&self.spans, &self.basis, free)
    }

    /// The paper's `α_6 … , α_7 …, …` \[s⁻⁶, s⁻⁷, …\], one block a power, one value a joint.
    pub fn to_alpha(&self, coefficients: &[f64], duration: f64) -> Vec<f64> {
        let mut alpha = vec![0.0; self.dimension()];
        for (i, joint) in coefficients.chunks_exact(self.terms()).enumerate() {
            for (k, power) in self.basis.to_powers(joint).into_iter().enumerate() {
                alpha[k * self.joints() + i] = power / duration.powi(6 + k as i32);
            }
        }
        alpha
    }

    /// The coefficients of a path given by the paper's `α` and duration \[s\].
    pub fn from_alpha(&self, alpha: &[f64], duration: f64) -> Vec<f64> {
        debug_assert_eq!(alpha.len(), self.dimension());
        (0..self.joints())
            .flat_map(|i| {
                let powers: Vec<f64> = (0..self.terms())
                    .map(|k| alpha[k * self.joints() + i] * duration.powi(6 + k as i32))
                    .collect();
                self.basis.from_powers(&powers)
            })
            .collect()
    }
}
