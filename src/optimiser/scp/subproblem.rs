//! The convex subproblem of [`Scp`](super::Scp), solved by Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver as _, NonnegativeConeT, SecondOrderConeT,
    SolverStatus, ZeroConeT,
};
use nalgebra::{DMatrix, DVector};

use crate::search::{Bounds, Linearisation};
use crate::search::{Oracle, Stop};

/// The part of the box within the trust region, as bounds on the step.
pub(super) struct Region {
    lower: DVector<f64>,
    upper: DVector<f64>,
    /// The region's extent in each variable.
    extent: DVector<f64>,
}

impl Region {
    pub(super) fn around(bounds: &Bounds, x: &DVector<f64>, radius: f64) -> Self {
        let extent = bounds.iter().map(|[lower, upper]| radius * (upper - lower) / 2.0);
        let extent = DVector::from_iterator(x.len(), extent);
        let walls = |side: usize| bounds.iter().map(move |bound| bound[side]);
        let lower = DVector::from_iterator(x.len(), walls(0)) - x;
        let upper = DVector::from_iterator(x.len(), walls(1)) - x;
        Self { lower: lower.sup(&-&extent), upper: upper.inf(&extent), extent }
    }

    /// The variables that can move, or cannot.
    fn variables(&self, fixed: bool) -> impl Iterator<Item = usize> {
        (0..self.extent.len()).filter(move |&j| (self.extent[j] <= 0.0) == fixed)
    }

    /// How far towards the region's wall a step goes; 1 is on it.
    pub(super) fn reach(&self, d: &DVector<f64>) -> f64 {
        let variables = d.iter().zip(&self.extent).filter(|(_, extent)| **extent > 0.0);
        variables.map(|(d, extent)| d.abs() / extent).fold(0.0, f64::max)
    }
}

/// The values of `r` and of every `h`.
pub(super) struct Values {
    pub(super) residual: DVector<f64>,
    pub(super) pieces: Vec<f64>,
}

impl Values {
    pub(super) fn of(parts: &Linearisation) -> Self {
        let pieces = parts.pieces.iter().map(|piece| piece.value).collect();
        Self { residual: parts.residual.clone(), pieces }
    }
}

/// What stands for `J` near a point: minimise over `d`
///
/// ```text
/// a ‖r + R d‖ + b max_p (h_p + g_p · d) + ½ dᵀ B d     within the region
/// ```
///
/// in the variables `(d, T, t)` with `T ≥ h_p + g_p · d` and `(t, r + R d)` in the second-order cone.
pub(super) struct Model<'a> {
    pub(super) parts: &'a Linearisation,
    pub(super) curvature: &'a DMatrix<f64>,
    pub(super) region: &'a Region,
}

/// A minimum of the model.
pub(super) struct Step {
    pub(super) d: DVector<f64>,
    /// The model's cost of `d`.
    pub(super) cost: f64,
    /// Multiplier of each `h_p`; they add up to `b`.
    pub(super) lambda: DVector<f64>,
    /// Multiplier of the residual, of length `a` at most.
    pub(super) nu: DVector<f64>,
}

/// Clarabel's tolerances: a promise of a billionth of the cost has to be right to a tenth of it.
const TOLERANCE: f64 = 1e-10;

impl Model<'_> {
    /// The minimum with these values of `r` and `h`, the linearisation's or corrected ones, unless
    /// Clarabel fails.
    pub(super) fn minimise(
        &self,
        oracle: &mut Oracle<'_>,
        values: &Values,
    ) -> Result<Option<Step>, Stop> {
        oracle.conic(|| self.solve(values))
    }

    fn solve(&self, values: &Values) -> Option<Step> {
        let Region { lower, upper, .. } = self.region;
        let n = lower.len();
        let pieces = self.in_reach(values);
        let fixed = self.region.variables(true).count();
        let linear = pieces.len() + 2 * (n - fixed);
        let rows = self.rows(values, &pieces);
        let mut cones = vec![NonnegativeConeT(linear), SecondOrderConeT(values.residual.len() + 1)];
        // As two inequalities a fixed variable would leave the interior-point method no interior.
        cones.extend((fixed > 0).then_some(ZeroConeT(fixed)));
        let mut q = vec![0.0; n];
        q.extend([self.parts.max_weight, self.parts.norm_weight]);
        let curvature = upper_triangle(self.curvature, n + 2);
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: TOLERANCE,
            tol_gap_rel: TOLERANCE,
            tol_feas: TOLERANCE,
            ..DefaultSettings::default()
        };
        let a = rows.matrix(n + 2);
        let mut solver = DefaultSolver::new(&curvature, &q, &a, &rows.b, &cones, settings).ok()?;
        solver.solve();
        let solution = &solver.solution;
        if !matches!(solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return None;
        }
        let mut lambda = DVector::zeros(values.pieces.len());
        for (&p, multiplier) in pieces.iter().zip(&solution.z) {
            lambda[p] = *multiplier;
        }
        // Within the region to the last bit.
        let d = DVector::from_column_slice(&solution.x[..n]).sup(lower).inf(upper);
        let nu = &solution.z[linear + 1..linear + 1 + values.residual.len()];
        let nu = -DVector::from_column_slice(nu);
        Some(Step { cost: self.cost(values, &d), d, lambda, nu })
    }

    /// `T ≥ h_p + g_p · d`, the region, the cone, and the fixed variables, in this order.
    fn rows(&self, values: &Values, pieces: &[usize]) -> Rows {
        let Region { lower, upper, .. } = self.region;
        let (duration, norm) = (lower.len(), lower.len() + 1);
        let mut rows = Rows::default();
        for &p in pieces {
            let gradient = self.parts.pieces[p].gradient.iter().copied();
            let slopes = gradient.enumerate().filter(|(_, slope)| *slope != 0.0);
            rows.push(slopes.chain([(duration, -1.0)]), -values.pieces[p]);
        }
        for j in self.region.variables(false) {
            rows.push([(j, 1.0)], upper[j]);
            rows.push([(j, -1.0)], -lower[j]);
        }
        rows.push([(norm, -1.0)], 0.0);
        for (k, residual) in values.residual.iter().enumerate() {
            let row = self.parts.residual_jacobian.row(k);
            rows.push(row.iter().map(|slope| -slope).enumerate(), *residual);
        }
        for j in self.region.variables(true) {
            rows.push([(j, 1.0)], lower[j]);
        }
        rows
    }

    /// The model's cost of a step.
    fn cost(&self, values: &Values, d: &DVector<f64>) -> f64 {
        let Linearisation { norm_weight, residual_jacobian, max_weight, pieces, .. } = self.parts;
        let residual = &values.residual + residual_jacobian * d;
        let pieces = pieces.iter().zip(&values.pieces);
        let longest = pieces.map(|(piece, value)| value + piece.gradient.dot(d));
        norm_weight * residual.norm()
            + max_weight * longest.fold(0.0, f64::max)
            + d.dot(&(self.curvature * d)) / 2.0
    }

    /// The pieces that can be the largest somewhere within the region.
    fn in_reach(&self, values: &Values) -> Vec<usize> {
        let Region { lower, upper, .. } = self.region;
        let range = |p: usize| {
            let slopes = self.parts.pieces[p].gradient.iter().zip(lower.iter().zip(upper));
            slopes.fold([values.pieces[p]; 2], |[low, high], (slope, (lower, upper))| {
                let ends = [slope * lower, slope * upper];
                [low + ends[0].min(ends[1]), high + ends[0].max(ends[1])]
            })
        };
        let ranges: Vec<_> = (0..values.pieces.len()).map(range).collect();
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
