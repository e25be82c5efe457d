//! How the error bends: along the directions that the problem tells of, and over the step last tried.

use nalgebra::{DMatrix, DVector};

use crate::search::{Bend, Fold};

/// What is known or said to be flat has this share of the largest curvature, lest steps go far for next to nothing.
const FLOOR: f64 = 1e-4;

/// A curvature below this share of the largest is none.
const NOTHING: f64 = 1e-3;

/// A step of which less than this share is new says nothing more.
const NEW: f64 = 0.1;

/// Shorter ones say nothing at all.
const SHORTEST: f64 = 1e-8;

/// The changes of the error's slopes in some directions.
#[derive(Default)]
pub(super) struct Bends {
    /// Told by the problem at the present point; orthonormal.
    pub(super) told: Option<Vec<Bend>>,
    tried: Option<Bend>,
}

impl Bends {
    /// Takes note of the slopes' change over a step.
    pub(super) fn remember(&mut self, step: &DVector<f64>, change: DMatrix<f64>) {
        let length = step.norm();
        if length > SHORTEST {
            self.tried = Some(Bend { direction: step / length, change: change / length });
        }
    }

    /// What is new in the step last tried, if enough is.
    fn new_in_tried(&self, told: &[Bend]) -> Option<Bend> {
        let Bend { mut direction, mut change } = self.tried.clone()?;
        // Twice is enough for orthogonality to rounding.
        for _ in 0..2 {
            for bend in told {
                let share = bend.direction.dot(&direction);
                direction -= &bend.direction * share;
                change -= &bend.change * share;
            }
        }
        let new = direction.norm();
        (new > NEW).then(|| Bend { direction: direction / new, change: change / new })
    }

    /// The second derivative of `ν · r` in the space of all directions, without what is negative (the Rayleigh–Ritz
    /// method, Parlett 1998, doi:10.1137/1.9781611971163, chapter 11). Elsewhere nothing is known, and the floor said.
    pub(super) fn curvature(&self, nu: &DVector<f64>) -> Curvature {
        let told = self.told.as_deref().unwrap_or_default();
        let tried = self.new_in_tried(told);
        Curvature::of(&told.iter().chain(&tried).collect::<Vec<_>>(), nu)
    }
}

/// A positive semidefinite second derivative `c_0 I + Σ c_i q_i q_iᵀ` with `q_i` of unit length.
#[derive(Default)]
pub(super) struct Curvature {
    /// `c_0`.
    pub(super) floor: f64,
    pub(super) directions: Vec<DVector<f64>>,
    pub(super) along: Vec<f64>,
}

impl Curvature {
    fn of(bends: &[&Bend], nu: &DVector<f64>) -> Self {
        let mut curvature = Self::default();
        if bends.is_empty() {
            return curvature;
        }
        let images: Vec<_> = bends.iter().map(|bend| bend.change.tr_mul(nu)).collect();
        let entry = |i: usize, j: usize| {
            f64::midpoint(bends[i].direction.dot(&images[j]), bends[j].direction.dot(&images[i]))
        };
        let eigen = DMatrix::from_fn(bends.len(), bends.len(), entry).symmetric_eigen();
        curvature.floor = FLOOR * eigen.eigenvalues.amax();
        let least = NOTHING * eigen.eigenvalues.amax();
        for (value, shares) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > least {
                let zero = DVector::zeros(bends[0].direction.len());
                let parts = bends.iter().zip(shares.iter());
                let sum = |sum: DVector<f64>, (bend, share): (&&Bend, &f64)| {
                    sum + &bend.direction * *share
                };
                curvature.directions.push(parts.fold(zero, sum));
                curvature.along.push(*value - curvature.floor);
            }
        }
        curvature
    }

    /// The same and a share of the folds.
    pub(super) fn folded(mut self, folds: &[Fold], share: f64) -> Self {
        for Fold { direction, curvature } in folds {
            let length = direction.norm();
            if length > 0.0 {
                self.directions.push(direction / length);
                self.along.push(share * curvature * length * length);
            }
        }
        self
    }

    /// `½ dᵀ B d`.
    pub(super) fn energy(&self, d: &DVector<f64>) -> f64 {
        let parts = self.directions.iter().zip(&self.along);
        let along: f64 = parts.map(|(q, c)| c * q.dot(d).powi(2)).sum();
        0.5 * (self.floor * d.norm_squared() + along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of `r_k = ½ xᵀ H_k x` the curvature is that of `Σ ν_k H_k`, with the floor in place of what is negative.
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
        let all = DMatrix::from_fn(n, n, |i, k| {
            f64::from(u8::from(i == k)) + 0.1 * f64::sin((i + k) as f64)
        });
        let change = |direction: &DVector<f64>| {
            let rows: Vec<_> = hessians.iter().map(|h| (h * direction).transpose()).collect();
            DMatrix::from_rows(&rows)
        };
        // All directions but one are told, and the last follows from a step.
        let orthonormal = all.clone().qr().q();
        let told = orthonormal.column_iter().take(n - 1).map(|q| {
            let direction = q.into_owned();
            Bend { change: change(&direction), direction }
        });
        let mut bends = Bends { told: Some(told.collect()), tried: None };
        let step = all.column(n - 1) * 0.3;
        bends.remember(&step, change(&step));
        let found = bends.curvature(&nu);
        let eigen = sum.symmetric_eigen();
        let mut positive: Vec<f64> =
            eigen.eigenvalues.iter().copied().filter(|v| *v > 0.0).collect();
        let mut along: Vec<f64> = found.along.iter().map(|c| c + found.floor).collect();
        positive.sort_by(f64::total_cmp);
        along.sort_by(f64::total_cmp);
        assert_eq!(along.len(), positive.len());
        for (a, b) in along.iter().zip(&positive) {
            assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} {b}");
        }
        let d = DVector::from_fn(n, |i, _| f64::cos(2.0 * i as f64));
        let clipped = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
        let energy: f64 = clipped.map(|(v, q)| v.max(found.floor) * q.dot(&d).powi(2) / 2.0).sum();
        assert!((found.energy(&d) - energy).abs() < 1e-9 * energy);
    }
}
