//! The convex subproblem of [`Scp`](super::Scp), solved by Clarabel.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver as _, NonnegativeConeT,
    SecondOrderConeT, SolverStatus, SupportedConeT, ZeroConeT,
};
use nalgebra::{DMatrix, DVector};

use crate::search::{Bounds, Linearisation, Oracle, Piece, Shape, Stop, Term};

/// The part of the box within the trust region, as bounds on the step.
pub(super) struct Region {
    pub(super) lower: DVector<f64>,
    pub(super) upper: DVector<f64>,
    /// The region's extent in each variable.
    pub(super) extent: DVector<f64>,
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

/// A number for every piece of every term.
pub(super) type PerPiece = Vec<Vec<f64>>;

/// The pieces' values.
pub(super) fn values(parts: &Linearisation) -> PerPiece {
    let of = |term: &Term| term.pieces.iter().map(|piece| piece.value).collect();
    parts.terms.iter().map(of).collect()
}

/// What stands for `J` near a point: minimise over `d`
///
/// ```text
/// Σ_k w_k φ_k(v_k + G_k d) + ½ dᵀ B d     within the region
/// ```
///
/// as a conic program in `d` and one more variable for each of the following, by its weight in the
/// objective:
///
/// ```text
/// max      t     t ≥ v_i + g_i · d          for every piece
/// hinge    s_i   s_i ≥ v_i + g_i · d, s_i ≥ 0    one variable per piece
/// norm     t     (t, v + G d) in the second-order cone
/// ```
pub(super) struct Model<'a> {
    pub(super) parts: &'a Linearisation,
    /// What each term weighs in the search.
    pub(super) weights: &'a [f64],
    pub(super) curvature: &'a DMatrix<f64>,
    pub(super) region: &'a Region,
}

/// A minimum of the model.
pub(super) struct Step {
    pub(super) d: DVector<f64>,
    /// The model's cost of `d`.
    pub(super) cost: f64,
    /// The multiplier of every piece, as [`Multipliers`](crate::search::Multipliers) has them.
    pub(super) multipliers: PerPiece,
}

/// Clarabel's tolerances: a promise of a billionth of the cost has to be right to a tenth of it.
const TOLERANCE: f64 = 1e-10;

impl Model<'_> {
    /// The minimum with these values of the pieces, the linearisation's or corrected ones, unless
    /// Clarabel fails.
    pub(super) fn minimise(
        &self,
        oracle: &mut Oracle<'_>,
        values: &PerPiece,
    ) -> Result<Option<Step>, Stop> {
        oracle.conic(|| self.solve(values))
    }

    fn solve(&self, values: &PerPiece) -> Option<Step> {
        let Region { lower, upper, .. } = self.region;
        let program = self.program(values);
        let size = program.q.len();
        let curvature = upper_triangle(self.curvature, size);
        let a = program.rows.matrix(size);
        let Program { q, rows, cones, .. } = &program;
        let solution = by_clarabel(&curvature, q, &a, &rows.b, cones, TOLERANCE)?;
        // Within the region to the last bit.
        let d = DVector::from_column_slice(&solution.x[..lower.len()]).sup(lower).inf(upper);
        let multipliers = program.multipliers(self.parts, &solution.z);
        Some(Step { cost: self.cost(values, &d), d, multipliers })
    }

    /// Rows of maxima, hinges, the region, norms and fixed variables, in this order.
    fn program(&self, values: &PerPiece) -> Program {
        let Region { lower, upper, .. } = self.region;
        let mut program = Program { q: vec![0.0; lower.len()], ..Program::default() };
        for (k, term) in self.terms(Shape::Max) {
            let pieces = self.largest_in_reach(k, &values[k]);
            if !pieces.is_empty() {
                let t = program.variable(self.weights[k]);
                for p in pieces {
                    program.bound([k, p], term, values[k][p], t);
                }
            }
        }
        for (k, term) in self.terms(Shape::Hinge) {
            for (p, &value) in values[k].iter().enumerate() {
                let [_, high] = self.range(&term.pieces[p], value);
                if high > 0.0 {
                    let s = program.variable(self.weights[k]);
                    program.bound([k, p], term, value, s);
                    program.rows.push([(s, -1.0)], 0.0);
                }
            }
        }
        for j in self.region.variables(false) {
            program.rows.push([(j, 1.0)], upper[j]);
            program.rows.push([(j, -1.0)], -lower[j]);
        }
        program.close(NonnegativeConeT);
        for (k, term) in self.terms(Shape::Norm).filter(|(_, term)| !term.pieces.is_empty()) {
            let t = program.variable(self.weights[k]);
            program.rows.push([(t, -1.0)], 0.0);
            for (p, (piece, value)) in term.pieces.iter().zip(&values[k]).enumerate() {
                program.place_of.push(([k, p], program.rows.b.len()));
                let slopes = piece.gradient.iter().map(|slope| -slope);
                program.rows.push(slopes.enumerate(), *value);
            }
            program.close(SecondOrderConeT);
        }
        // As two inequalities a fixed variable would leave the interior-point method no interior.
        for j in self.region.variables(true) {
            program.rows.push([(j, 1.0)], lower[j]);
        }
        program.close(ZeroConeT);
        program
    }

    /// The terms of a shape, with their places.
    fn terms(&self, shape: Shape) -> impl Iterator<Item = (usize, &Term)> {
        self.parts.terms.iter().enumerate().filter(move |(_, term)| term.shape == shape)
    }

    /// The model's cost of a step, no term below its floor.
    fn cost(&self, values: &PerPiece, d: &DVector<f64>) -> f64 {
        let terms = self.parts.terms.iter().zip(self.weights).zip(values);
        let cost = |((term, weight), values): ((&Term, &f64), &Vec<f64>)| {
            let there = values.iter().zip(term.changes(d)).map(|(value, change)| value + change);
            weight * term.value_at(there)
        };
        terms.map(cost).sum::<f64>() + d.dot(&(self.curvature * d)) / 2.0
    }

    /// The pieces of a maximum that can be the largest somewhere within the region.
    fn largest_in_reach(&self, k: usize, values: &[f64]) -> Vec<usize> {
        let pieces = self.parts.terms[k].pieces.iter().zip(values);
        let ranges: Vec<_> = pieces.map(|(piece, value)| self.range(piece, *value)).collect();
        let floor = ranges.iter().map(|[low, _]| *low).fold(f64::NEG_INFINITY, f64::max);
        (0..ranges.len()).filter(|&p| ranges[p][1] >= floor).collect()
    }

    /// The least and the largest value of a piece within the region.
    fn range(&self, piece: &Piece, value: f64) -> [f64; 2] {
        let Region { lower, upper, .. } = self.region;
        let slopes = piece.gradient.iter().zip(lower.iter().zip(upper));
        slopes.fold([value; 2], |[low, high], (slope, (lower, upper))| {
            let ends = [slope * lower, slope * upper];
            [low + ends[0].min(ends[1]), high + ends[0].max(ends[1])]
        })
    }
}

/// The solution of a conic program to such a tolerance, unless Clarabel fails.
pub(super) fn by_clarabel(
    p: &CscMatrix<f64>,
    q: &[f64],
    a: &CscMatrix<f64>,
    b: &[f64],
    cones: &[SupportedConeT<f64>],
    tolerance: f64,
) -> Option<DefaultSolution<f64>> {
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: tolerance,
        tol_gap_rel: tolerance,
        tol_feas: tolerance,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(p, q, a, b, cones, settings).ok()?;
    solver.solve();
    let is_solved =
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    is_solved.then_some(solver.solution)
}

/// A conic program: minimise `q · x + ½ xᵀ P x` with `b − A x` in the product of cones.
#[derive(Default)]
struct Program {
    q: Vec<f64>,
    rows: Rows,
    cones: Vec<SupportedConeT<f64>>,
    /// Rows that have a cone.
    closed: usize,
    /// Of pieces, by term and place in it, the row that holds its value.
    place_of: Vec<([usize; 2], usize)>,
}

impl Program {
    /// Adds a variable of this weight; its column.
    fn variable(&mut self, weight: f64) -> usize {
        self.q.push(weight);
        self.q.len() - 1
    }

    /// Adds `x_column ≥ v + g · d` for a piece.
    fn bound(&mut self, [k, p]: [usize; 2], term: &Term, value: f64, column: usize) {
        self.place_of.push(([k, p], self.rows.b.len()));
        let slopes = term.pieces[p].gradient.iter().copied().enumerate();
        self.rows.push(slopes.filter(|(_, slope)| *slope != 0.0).chain([(column, -1.0)]), -value);
    }

    /// Puts the rows that have no cone into one.
    fn close(&mut self, cone: impl FnOnce(usize) -> SupportedConeT<f64>) {
        let count = self.rows.b.len() - self.closed;
        self.cones.extend((count > 0).then(|| cone(count)));
        self.closed += count;
    }

    /// The multipliers of all pieces from those of the rows; zero for pieces without a row.
    fn multipliers(&self, parts: &Linearisation, z: &[f64]) -> PerPiece {
        let zeros = |term: &Term| vec![0.0; term.pieces.len()];
        let mut multipliers: PerPiece = parts.terms.iter().map(zeros).collect();
        for &([k, p], row) in &self.place_of {
            // The rows of a norm have the other sign.
            let is_norm = parts.terms[k].shape == Shape::Norm;
            multipliers[k][p] = if is_norm { -z[row] } else { z[row] };
        }
        multipliers
    }
}

/// A sparse matrix and a right-hand side, row by row.
#[derive(Default)]
pub(super) struct Rows {
    row_of: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    pub(super) b: Vec<f64>,
}

impl Rows {
    pub(super) fn push(&mut self, entries: impl IntoIterator<Item = (usize, f64)>, b: f64) {
        for (column, value) in entries {
            self.row_of.push(self.b.len());
            self.columns.push(column);
            self.values.push(value);
        }
        self.b.push(b);
    }

    pub(super) fn matrix(&self, columns: usize) -> CscMatrix<f64> {
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
