//! The convex subproblem of [`Scp`](super::Scp), solved by Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SecondOrderConeT, SolverStatus,
};
use nalgebra::{DMatrix, DVector};

use crate::problem::Linearisation;

/// Minimise over `d`
///
/// ```text
/// a ‖r + R d‖ + b max_p (h_p + g_p · d) + ½ dᵀ B d     within   lower ≤ d ≤ upper
/// ```
///
/// in the variables `(d, T, t)` with `T ≥ h_p + g_p · d` and `(t, r + R d)` in the second-order cone.
pub(super) struct Subproblem<'a> {
    pub(super) parts: &'a Linearisation,
    /// `r`, `h`: those of the linearisation, or corrected ones.
    pub(super) residual: &'a DVector<f64>,
    pub(super) values: &'a [f64],
    pub(super) curvature: &'a DMatrix<f64>,
    pub(super) lower: &'a [f64],
    pub(super) upper: &'a [f64],
}

/// A solution.
pub(super) struct Step {
    pub(super) d: DVector<f64>,
    /// The subproblem's minimum.
    pub(super) cost: f64,
    /// Multiplier of each `h_p`; they add up to `b`.
    pub(super) lambda: DVector<f64>,
    /// Multiplier of the residual, of length `a` at most.
    pub(super) nu: DVector<f64>,
}

impl Subproblem<'_> {
    /// The solution, unless Clarabel fails.
    pub(super) fn solve(&self) -> Option<Step> {
        let (n, m) = (self.lower.len(), self.residual.len());
        let (duration, norm) = (n, n + 1);
        let mut rows = Rows::default();
        let pieces = self.in_reach();
        for &p in &pieces {
            let gradient = self.parts.pieces[p].gradient.iter().copied();
            let slopes = gradient.enumerate().filter(|(_, slope)| *slope != 0.0);
            rows.push(slopes.chain([(duration, -1.0)]), -self.values[p]);
        }
        for j in 0..n {
            rows.push([(j, 1.0)], self.upper[j]);
            rows.push([(j, -1.0)], -self.lower[j]);
        }
        let linear = rows.len();
        rows.push([(norm, -1.0)], 0.0);
        for k in 0..m {
            let slopes = (0..n).map(|j| (j, -self.parts.residual_jacobian[(k, j)]));
            rows.push(slopes, self.residual[k]);
        }
        let mut q = vec![0.0; n + 2];
        (q[duration], q[norm]) = (self.parts.max_weight, self.parts.norm_weight);
        let curvature = upper_triangle(self.curvature, n + 2);
        let cones = [NonnegativeConeT(linear), SecondOrderConeT(m + 1)];
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let a = rows.matrix(n + 2);
        let mut solver = DefaultSolver::new(&curvature, &q, &a, &rows.b, &cones, settings).ok()?;
        solver.solve();
        let solution = &solver.solution;
        if !matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return None;
        }
        let mut lambda = DVector::zeros(self.values.len());
        for (&p, multiplier) in pieces.iter().zip(&solution.z) {
            lambda[p] = *multiplier;
        }
        Some(Step {
            d: DVector::from_column_slice(&solution.x[..n]),
            cost: solution.obj_val,
            lambda,
            nu: -DVector::from_column_slice(&solution.z[linear + 1..]),
        })
    }

    /// The pieces that can be the largest somewhere within the bounds.
    fn in_reach(&self) -> Vec<usize> {
        let range = |p: usize| {
            let slopes =
                self.parts.pieces[p].gradient.iter().zip(self.lower.iter().zip(self.upper));
            slopes.fold([self.values[p]; 2], |[low, high], (slope, (lower, upper))| {
                let ends = [slope * lower, slope * upper];
                [low + ends[0].min(ends[1]), high + ends[0].max(ends[1])]
            })
        };
        let ranges: Vec<_> = (0..self.values.len()).map(range).collect();
        let floor = ranges.iter().map(|[low, _]| *low).fold(f64::NEG_INFINITY, f64::max);
        (0..ranges.len()).filter(|&p| ranges[p][1] >= floor).collect()
    }
}

/// A sparse matrix and a right-hand side, row by row.
#[derive(Default)]
struct Rows {
    row_of: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    b: Vec<f64>,
}

impl Rows {
    fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, b: f64) {
        for (column, value) in entries {
            self.row_of.push(self.b.len());
            self.columns.push(column);
            self.values.push(value);
        }
        self.b.push(b);
    }

    fn len(&self) -> usize {
        self.b.len()
    }

    fn matrix(&self, columns: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(
            self.b.len(),
            columns,
            self.row_of.clone(),
            self.columns.clone(),
            self.values.clone(),
        )
    }
}

/// The upper triangle of a symmetric matrix in the corner of a larger one.
fn upper_triangle(matrix: &DMatrix<f64>, size: usize) -> CscMatrix<f64> {
    let n = matrix.ncols();
    let entries = || (0..n).flat_map(|j| (0..=j).map(move |i| (i, j)));
    CscMatrix::new_from_triplets(
        size,
        size,
        entries().map(|(i, _)| i).collect(),
        entries().map(|(_, j)| j).collect(),
        entries().map(|(i, j)| matrix[(i, j)]).collect(),
    )
}
