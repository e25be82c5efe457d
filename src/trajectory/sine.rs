//! All paths of the sine-polynomial family between two configurations.

use std::ops::Range;

use super::basis::Basis;
use super::path::{JointPath, Path, Span};
use super::rows::Rows;
use crate::robot::Follow;

/// All paths of the family between two configurations.
///
/// `s = s_0 + (s_f − s_0) σ(τ) + 64 τ³(1−τ)³ Σ_k c_k P_k(2τ−1)`; the coefficients `c` select one.
/// They are ordered joint by joint, `terms` for each that follows no other.
#[derive(Debug, Clone)]
pub struct SinePolynomial {
    spans: Vec<Span>,
    rows: Rows,
    basis: Basis,
}

impl SinePolynomial {
    /// From the joints' ranges and both configurations \[rad\], each start and goal in its range.
    ///
    /// # Panics
    ///
    /// Panics when the three lists differ in length, or without a term.
    pub fn new(ranges: &[[f64; 2]], start: &[f64], goal: &[f64], terms: usize) -> Self {
        assert!(ranges.len() == start.len() && start.len() == goal.len(), "one of each per joint");
        assert!(terms > 0, "at least one term");
        let spans = ranges
            .iter()
            .zip(start.iter().zip(goal))
            .map(|(range, (&start, &goal))| Span::new(*range, start, goal))
            .collect();
        Self { spans, rows: Rows::own(ranges.len()), basis: Basis::new(terms) }
    }

    /// The same where joints follow others, whatever their own start and goal.
    ///
    /// # Panics
    ///
    /// Panics unless there is an entry for each joint, or where a leader does not exist or follows another joint itself.
    #[must_use]
    pub fn following(mut self, follows: &[Option<Follow>]) -> Self {
        assert_eq!(follows.len(), self.joints(), "whether each joint follows another one");
        for (joint, follow) in follows.iter().enumerate() {
            if let Some(follow) = follow {
                self.spans[joint] = self.spans[follow.leader].followed(follow);
            }
        }
        Self { rows: Rows::following(follows), ..self }
    }

    /// The family between the same configurations with another number of terms.
    #[must_use]
    pub(super) fn with_terms(&self, terms: usize) -> Self {
        Self { basis: Basis::new(terms), ..self.clone() }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.spans.len()
    }

    /// Free coefficients per joint.
    pub fn terms(&self) -> usize {
        self.basis.terms()
    }

    /// The bumps that coefficients multiply.
    pub fn basis(&self) -> &Basis {
        &self.basis
    }

    pub(super) fn spans(&self) -> &[Span] {
        &self.spans
    }

    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Free coefficients in all.
    pub fn dimension(&self) -> usize {
        self.rows.count() * self.terms()
    }

    /// The path with these coefficients.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer coefficients than the family's dimension.
    pub fn path(&self, coefficients: &[f64]) -> Path<'_> {
        assert_eq!(coefficients.len(), self.dimension(), "terms × joints coefficients");
        let mut free = vec![0.0; self.joints() * self.terms()];
        for (joint, powers) in free.chunks_exact_mut(self.terms()).enumerate() {
            self.basis.gather(self.of_joint(joint, coefficients), powers);
        }
        Path::new(&self.spans, &self.basis, free)
    }

    /// One joint's part of that path; `powers` is room for as many numbers as there are terms.
    pub fn joint_path<'a>(
        &'a self,
        joint: usize,
        coefficients: &[f64],
        powers: &'a mut [f64],
    ) -> JointPath<'a> {
        self.basis.gather(self.of_joint(joint, coefficients), powers);
        JointPath::new(&self.spans[joint], &self.basis, powers)
    }

    /// One joint's coefficients among those of all.
    #[inline(always)]
    pub fn of_joint<'a>(&self, joint: usize, coefficients: &'a [f64]) -> &'a [f64] {
        &coefficients[self.places(joint)]
    }

    #[inline(always)]
    pub(super) fn places(&self, joint: usize) -> Range<usize> {
        let row = self.rows.of(joint);
        row * self.terms()..(row + 1) * self.terms()
    }

    /// The paper's `α_6 … , α_7 …, …` \[s⁻⁶, s⁻⁷, …\], one block per power, one value per joint that follows no other.
    pub fn to_alpha(&self, coefficients: &[f64], duration: f64) -> Vec<f64> {
        let mut alpha = vec![0.0; self.dimension()];
        for (i, joint) in coefficients.chunks_exact(self.terms()).enumerate() {
            for (k, power) in self.basis.to_powers(joint).into_iter().enumerate() {
                alpha[k * self.rows.count() + i] = power / duration.powi(6 + k as i32);
            }
        }
        alpha
    }

    /// The coefficients of a path given by the paper's `α` and duration \[s\].
    pub fn from_alpha(&self, alpha: &[f64], duration: f64) -> Vec<f64> {
        let mut coefficients = vec![0.0; self.dimension()];
        self.write_from_alpha(alpha, duration, &mut coefficients);
        coefficients
    }

    /// [`from_alpha`](Self::from_alpha) into a place of one's own.
    pub fn write_from_alpha(&self, alpha: &[f64], duration: f64, coefficients: &mut [f64]) {
        debug_assert_eq!(alpha.len(), self.dimension());
        coefficients.fill(0.0);
        for (k, block) in alpha.chunks_exact(self.rows.count()).enumerate() {
            let power = duration.powi(6 + k as i32);
            for (joint, alpha) in coefficients.chunks_exact_mut(self.terms()).zip(block) {
                self.basis.add_power(k, alpha * power, joint);
            }
        }
    }

    /// From a function's slopes by the coefficients those by the paper's `α`, and what the duration \[s\] changes through
    /// the coefficients while `α` stays.
    pub fn slopes_by_alpha(
        &self,
        alpha: &[f64],
        duration: f64,
        by_coefficient: &[f64],
    ) -> (Vec<f64>, f64) {
        let (mut by_alpha, mut by_duration) = (vec![0.0; self.dimension()], 0.0);
        let mut unit = vec![0.0; self.terms()];
        for k in 0..self.terms() {
            let order = 6 + k as i32;
            unit.fill(0.0);
            self.basis.add_power(k, duration.powi(order), &mut unit);
            for (joint, slopes) in by_coefficient.chunks_exact(self.terms()).enumerate() {
                let slope: f64 = unit.iter().zip(slopes).map(|(unit, slope)| unit * slope).sum();
                let place = k * self.rows.count() + joint;
                by_alpha[place] = slope;
                by_duration += alpha[place] * slope * f64::from(order) / duration;
            }
        }
        (by_alpha, by_duration)
    }
}
