//! How the error bends, from steps lately tried.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};

/// Steps that are remembered.
const REMEMBERED: usize = 12;

/// Shorter ones say nothing.
const SHORTEST: f64 = 1e-8;

/// A step of which less than this share is new says nothing more.
const NEW: f64 = 0.1;

/// The changes of the error's slopes over the last steps.
#[derive(Default)]
pub(super) struct Bends(VecDeque<(DVector<f64>, DMatrix<f64>)>);

/// A positive semidefinite second derivative `Σ c_i q_i q_iᵀ` with orthonormal `q_i`.
#[derive(Default)]
pub(super) struct Curvature {
    pub(super) directions: Vec<DVector<f64>>,
    pub(super) along: Vec<f64>,
}

impl Bends {
    /// Takes note of the slopes' change over a step.
    pub(super) fn remember(&mut self, step: &DVector<f64>, change: DMatrix<f64>) {
        if step.norm() < SHORTEST {
            return;
        }
        if self.0.len() == REMEMBERED {
            self.0.pop_front();
        }
        self.0.push_back((step.clone(), change));
    }

    /// The second derivative of `ν · r` in the space of these steps, without what is negative (the Rayleigh–Ritz method,
    /// Parlett 1998, doi:10.1137/1.9781611971163, chapter 11). Elsewhere nothing is known, and zero said.
    pub(super) fn curvature(&self, nu: &DVector<f64>) -> Curvature {
        let (mut basis, mut images) = (Vec::<DVector<f64>>::new(), Vec::<DVector<f64>>::new());
        for (step, change) in self.0.iter().rev() {
            let length = step.norm();
            let (mut own, mut image) = (step / length, change.tr_mul(nu) / length);
            // Twice is enough for orthogonality to rounding.
            for _ in 0..2 {
                for (q, y) in basis.iter().zip(&images) {
                    let share = q.dot(&own);
                    own -= q * share;
                    image -= y * share;
                }
            }
            let new = own.norm();
            if new > NEW {
                basis.push(own / new);
                images.push(image / new);
            }
        }
        let m = basis.len();
        if m == 0 {
            return Curvature::default();
        }
        let entry =
            |i: usize, j: usize| f64::midpoint(basis[i].dot(&images[j]), basis[j].dot(&images[i]));
        let eigen = DMatrix::from_fn(m, m, entry).symmetric_eigen();
        let mut curvature = Curvature::default();
        for (value, shares) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > 0.0 {
                let zero = DVector::zeros(basis[0].len());
                let parts = basis.iter().zip(shares.iter());
                curvature.directions.push(parts.fold(zero, |sum, (q, share)| sum + q * *share));
                curvature.along.push(*value);
            }
        }
        curvature
    }
}

impl Curvature {
    /// `½ dᵀ B d`.
    pub(super) fn energy(&self, d: &DVector<f64>) -> f64 {
        let parts = self.directions.iter().zip(&self.along);
        parts.map(|(q, c)| c * q.dot(d).powi(2)).sum::<f64>() / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `r_k = ½ xᵀ H_k x` the curvature along the steps is that of `Σ ν_k H_k`, without what is negative.
    #[test]
    fn the_curvature_of_a_quadratic_is_found() {
        let n = 6;
        let entries = |k: usize| {
            DMatrix::from_fn(n, n, |i, j| {
                f64::sin((i + j) as f64 + k as f64) + f64::cos((i * j + k) as f64)
            })
        };
        let hessians: Vec<DMatrix<f64>> = (0..3).map(entries).collect();
        let nu = DVector::from_vec(vec![0.7, -0.4, 1.1]);
        let sum =
            hessians.iter().zip(nu.iter()).fold(DMatrix::zeros(n, n), |sum, (h, nu)| sum + h * *nu);
        let mut bends = Bends::default();
        for k in 0..n {
            let step = DVector::from_fn(n, |i, _| {
                f64::from(u8::from(i == k)) + 0.1 * f64::sin((i + k) as f64)
            });
            let rows: Vec<_> = hessians.iter().map(|h| (h * &step).transpose()).collect();
            bends.remember(&step, DMatrix::from_rows(&rows));
        }
        let found = bends.curvature(&nu);
        let eigen = sum.symmetric_eigen();
        let mut positive: Vec<f64> =
            eigen.eigenvalues.iter().copied().filter(|v| *v > 0.0).collect();
        let mut along = found.along.clone();
        positive.sort_by(f64::total_cmp);
        along.sort_by(f64::total_cmp);
        assert_eq!(along.len(), positive.len());
        for (a, b) in along.iter().zip(&positive) {
            assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
        }
        let d = DVector::from_fn(n, |i, _| f64::cos(2.0 * i as f64));
        let clipped = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let energy: f64 = clipped.map(|(v, q)| v.max(0.0) * q.dot(&d).powi(2) / 2.0).sum();
        assert!((found.energy(&d) - energy).abs() < 1e-9 * energy);
    }
}
