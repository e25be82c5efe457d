//! A primal-dual interior-point method for the subproblem of [`timed_subproblem`](super::timed_subproblem), with
//! predictor and corrector (Mehrotra 1992, doi:10.1137/0802028) and Nesterov–Todd scaling of the cone (Nesterov and Todd
//! 1997, doi:10.1287/moor.22.1.1).
//!
//! A limit follows few variables in a row, so what limits and box add to the Newton matrix is banded. Time, excess, the
//! cone and the curvature add a border of a few columns. A step so takes a time linear in the number of variables, where
//! a general solver's sparse factorisation spends most of it on indices.

use nalgebra::{Cholesky, DMatrix, DMatrixView, DVector, Dyn, Vector4};

use super::banded::{BORDER, Triangle, WIDTH};
use super::bends::Curvature;
use super::cone::{Cone, Scaling, product, quotient};

/// Most iterations.
const ITERATIONS: usize = 60;

/// A gap of this share of what the minimum gains is small enough.
const SHARE: f64 = 0.01;

/// Share of the way to the boundary that a step goes.
const FRACTION: f64 = 0.99;

/// A shorter step is none.
const SHORTEST: f64 = 1e-10;

/// The least price of time, as a share of that of the error, that others are compared with.
const LEAST_PRICE: f64 = 1e-6;

/// What the gradient may miss, as a share of the price of time.
const FEASIBLE: f64 = 1e-7;

/// Where rounding ends the method, a gap this many times as large is good enough.
const NEARLY: f64 = 1e3;

/// Below so many times the gap that is enough, Newton steps are corrected by what they miss.
const REFINED: f64 = 1e4;

/// Components of the error.
const COMPONENTS: usize = 3;

/// `a · d − e β ≤ b_0` and `−a · d − e β ≤ b_1`, where `a` stands for entries from `first` on, all of them variables.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) first: usize,
    pub(super) a: [f64; WIDTH],
    /// Which of the `β` it is: 0 for time, 1 for excess.
    pub(super) border: usize,
    pub(super) e: f64,
    pub(super) b: [f64; 2],
}

impl Row {
    /// `a · d`.
    fn along(&self, d: &[f64]) -> f64 {
        let own = d[self.first..].first_chunk::<WIDTH>();
        own.map_or(0.0, |own| own.iter().zip(&self.a).map(|(d, a)| d * a).sum())
    }

    /// Adds a multiple of `a`.
    fn add_to(&self, out: &mut [f64], times: f64) {
        if let Some(own) = out[self.first..].first_chunk_mut::<WIDTH>() {
            for (out, a) in own.iter_mut().zip(&self.a) {
                *out += times * a;
            }
        }
    }
}

/// `a · d − e σ ≤ b` with entries in all variables, where `σ` is the time's `β` or one of the `v`.
#[derive(Debug, Clone)]
pub(super) struct DenseRow {
    pub(super) a: DVector<f64>,
    pub(super) border: Slack,
    pub(super) e: f64,
    pub(super) b: f64,
}

/// What gives way where a dense row is tight.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slack {
    /// The time's `β`.
    Time,
    /// One of the `v`.
    Term(usize),
}

impl DenseRow {
    /// `b − a · d + e σ`, without `b` where it is off.
    fn room(&self, on: f64, d: &[f64], time: f64, v: &[f64]) -> f64 {
        let slack = match self.border {
            Slack::Time => time,
            Slack::Term(k) => v[k],
        };
        let own: f64 = self.a.iter().zip(d).map(|(a, d)| a * d).sum();
        on * self.b - own + self.e * slack
    }
}

/// Minimise over `d`, `β ≥ 0`, `v ≥ 0` and `t`
///
/// ```text
/// κ · β + w · v + W t + ½ dᵀ B d    within the rows, lower ≤ d ≤ upper, ‖r + R d‖ ≤ t
/// ```
pub(super) struct Program<'a> {
    pub(super) rows: &'a [Row],
    pub(super) dense: &'a [DenseRow],
    /// `w`.
    pub(super) terms: &'a [f64],
    pub(super) lower: &'a DVector<f64>,
    pub(super) upper: &'a DVector<f64>,
    /// `κ`.
    pub(super) prices: [f64; 2],
    /// Of `β` where all rows have room at `d = 0`.
    pub(super) start: [f64; 2],
    /// `W`.
    pub(super) weight: f64,
    /// `r`, of three components.
    pub(super) error: &'a DVector<f64>,
    /// `R`.
    pub(super) slopes: &'a DMatrix<f64>,
    pub(super) curvature: &'a Curvature,
    /// The gap between primal and dual cost that is enough, unless a share of the gain over `here` is.
    pub(super) gap: f64,
    pub(super) here: f64,
}

/// `d`, the error's multiplier, of a length of `W` at most, and those of the dense rows.
pub(super) struct Minimum {
    pub(super) d: DVector<f64>,
    pub(super) nu: DVector<f64>,
    pub(super) dense: Vec<f64>,
}

/// A pair of slack and multiplier.
#[derive(Clone, Copy)]
struct Pair {
    slack: f64,
    dual: f64,
}

/// All unknowns.
struct State {
    d: DVector<f64>,
    beta: [f64; 2],
    v: Vec<f64>,
    /// Of each row both sides, then of every variable upper and lower bound, then of the `β`, the dense rows and the `v`.
    pairs: Vec<Pair>,
    cone: Cone,
}

impl State {
    /// What the primal cost exceeds the dual one by, where both are feasible.
    fn gap(&self) -> f64 {
        let products = self.pairs.iter().map(|pair| pair.slack * pair.dual);
        products.sum::<f64>() + self.cone.s.dot(&self.cone.z)
    }

    fn minimum(&self, program: &Program<'_>) -> Minimum {
        let nu = DVector::from_fn(COMPONENTS, |i, _| -self.cone.z[i + 1]);
        let dense = self.pairs[program.dense_pairs()..].iter().map(|pair| pair.dual);
        Minimum { d: self.d.clone(), nu, dense: dense.take(program.dense.len()).collect() }
    }

    /// The largest multiple of a change that keeps slacks and multipliers positive.
    fn room(&self, change: &Change) -> f64 {
        let mut least = self.cone.room(&change.s, &change.z);
        for (pair, change) in self.pairs.iter().zip(&change.pairs) {
            if change.slack < 0.0 {
                least = least.min(-pair.slack / change.slack);
            }
            if change.dual < 0.0 {
                least = least.min(-pair.dual / change.dual);
            }
        }
        least
    }

    fn advance(&mut self, change: &Change, step: f64) {
        self.d.axpy(step, &change.d, 1.0);
        for (beta, change) in self.beta.iter_mut().zip(change.beta) {
            *beta += step * change;
        }
        for (v, change) in self.v.iter_mut().zip(&change.v) {
            *v += step * change;
        }
        for (pair, change) in self.pairs.iter_mut().zip(&change.pairs) {
            pair.slack += step * change.slack;
            pair.dual += step * change.dual;
        }
        self.cone.s += change.s * step;
        self.cone.z += change.z * step;
    }
}

/// A change of the unknowns.
struct Change {
    d: DVector<f64>,
    beta: [f64; 2],
    v: Vec<f64>,
    pairs: Vec<Pair>,
    s: Vector4<f64>,
    z: Vector4<f64>,
}

impl Program<'_> {
    fn variables(&self) -> usize {
        self.lower.len()
    }

    /// The price of time, unless it is next to nothing beside that of the error.
    fn scale(&self) -> f64 {
        self.prices[0].max(LEAST_PRICE * self.weight)
    }

    /// What each pair's constraint leaves at a point, in the order of pairs.
    fn room(
        &self,
        d: &[f64],
        beta: [f64; 2],
        v: &[f64],
        constant: bool,
        mut each: impl FnMut(f64),
    ) {
        let on = f64::from(u8::from(constant));
        for row in self.rows {
            let own = row.along(d);
            let more = row.e * beta[row.border];
            each(on * row.b[0] - own + more);
            each(on * row.b[1] + own + more);
        }
        for ((d, lower), upper) in d.iter().zip(self.lower).zip(self.upper) {
            each(on * upper - d);
            each(d - on * lower);
        }
        beta.into_iter().for_each(&mut each);
        for row in self.dense {
            each(row.room(on, d, beta[0], v));
        }
        v.iter().copied().for_each(each);
    }

    /// The place of the dense rows' pairs among all.
    fn dense_pairs(&self) -> usize {
        2 * self.rows.len() + 2 * self.variables() + 2
    }

    /// The gradients of all constraints, each times its number, added up: by `d`, by `β` and by `v`.
    fn pull(&self, numbers: &[f64], out: &mut [f64], by_v: &mut [f64]) -> [f64; 2] {
        let (numbers, dense) = numbers.split_at(self.dense_pairs());
        let (dense, floors) = dense.split_at(self.dense.len());
        let mut by_beta = [0.0; 2];
        let (rows, rest) = numbers.split_at(2 * self.rows.len());
        for (row, pair) in self.rows.iter().zip(rows.chunks_exact(2)) {
            let (both, net) = (pair[0] + pair[1], pair[0] - pair[1]);
            row.add_to(out, net);
            by_beta[row.border] -= row.e * both;
        }
        let (bounds, beta) = rest.split_at(2 * self.variables());
        for (out, pair) in out.iter_mut().zip(bounds.chunks_exact(2)) {
            *out += pair[0] - pair[1];
        }
        for (row, number) in self.dense.iter().zip(dense) {
            for (out, a) in out.iter_mut().zip(row.a.iter()) {
                *out += number * a;
            }
            match row.border {
                Slack::Time => by_beta[0] -= row.e * number,
                Slack::Term(k) => by_v[k] -= row.e * number,
            }
        }
        by_v.iter_mut().zip(floors).for_each(|(by_v, number)| *by_v -= number);
        [by_beta[0] - beta[0], by_beta[1] - beta[1]]
    }

    fn start(&self) -> State {
        let n = self.variables();
        let d = DVector::zeros(n);
        let beta = self.start;
        // Room for every dense row, and above the floor.
        let mut v = vec![0.1; self.terms.len()];
        for row in self.dense {
            if let Slack::Term(k) = row.border {
                v[k] = f64::max(v[k], 0.1 - row.b / row.e);
            }
        }
        let length = self.error.norm();
        let t = length + 0.1 * (1e-3 + length);
        let mut pairs = Vec::with_capacity(self.dense_pairs() + self.dense.len() + v.len());
        self.room(d.as_slice(), beta, &v, true, |room| {
            let slack = room.max(1e-4);
            pairs.push(Pair { slack, dual: 1.0 / slack });
        });
        // Multipliers in proportion to these, half of the price of time in rows, and what is left in bounds.
        let duals: Vec<f64> = pairs.iter().map(|pair| pair.dual).collect();
        let mut unused = vec![0.0; n];
        let mut by_v = vec![0.0; v.len()];
        let shared = self.pull(&duals[..], &mut unused, &mut by_v);
        let mu = 0.5 * self.scale() / -shared[0];
        for pair in &mut pairs {
            pair.dual *= mu;
        }
        let last = self.dense_pairs() - 2;
        for k in 0..2 {
            let own = pairs[last + k].dual;
            let rows = -mu * shared[k] - own;
            pairs[last + k].dual = own.max(self.prices[k] - rows);
        }
        let floors = pairs.len() - v.len();
        for (k, by_v) in by_v.iter().enumerate() {
            let own = pairs[floors + k].dual;
            let rows = -mu * by_v - own;
            pairs[floors + k].dual = own.max(self.terms[k] - rows);
        }
        let s = Vector4::new(t, self.error[0], self.error[1], self.error[2]);
        let mut z = s;
        z.fixed_rows_mut::<3>(1).neg_mut();
        // On the central path, and with the norm's weight in front where there is room.
        let z = z * (self.weight / t);
        State { d, beta, v, pairs, cone: Cone { s, z } }
    }

    fn cost(&self, State { d, beta, v, .. }: &State) -> f64 {
        let prices: f64 = self.prices.iter().zip(beta).map(|(price, beta)| price * beta).sum();
        let terms: f64 = self.terms.iter().zip(v).map(|(weight, v)| weight * v).sum();
        let left = (self.error + self.slopes * d).norm();
        prices + terms + self.weight * left + self.curvature.energy(d)
    }

    /// The minimum, unless rounding is in the way.
    pub(super) fn minimise(&self) -> Option<Minimum> {
        if self.error.len() != COMPONENTS || self.variables() < WIDTH {
            return None;
        }
        let mut state = self.start();
        let mut newton = Newton::new(self);
        for _ in 0..ITERATIONS {
            let gap = state.gap();
            let residuals = self.residuals(&state);
            let miss = residuals.d.amax() / self.scale();
            let enough = self.gap.max(SHARE * (self.here - self.cost(&state)));
            let unbalanced = residuals.d.abs().dot(&state.d.abs());
            if gap <= enough && (unbalanced <= enough || miss <= FEASIBLE) {
                return Some(state.minimum(self));
            }
            let Some(change) = self.direction(&mut newton, &state, &residuals, gap) else {
                let is_near = gap <= NEARLY * self.gap && miss <= NEARLY * FEASIBLE;
                return is_near.then(|| state.minimum(self));
            };
            state.advance(&change, (FRACTION * state.room(&change)).min(1.0));
        }
        None
    }

    /// The corrected Newton step, unless rounding leaves none of any length.
    fn direction(
        &self,
        newton: &mut Newton<'_>,
        state: &State,
        residuals: &Residuals,
        gap: f64,
    ) -> Option<Change> {
        let scaling = state.cone.scaling()?;
        newton.factorise(state, &scaling)?;
        let mut system = System {
            state,
            scaling: &scaling,
            residuals,
            products: vec![0.0; state.pairs.len()],
            target: 0.0,
            bend: Vector4::zeros(),
        };
        let affine = newton.solve(&system, 0);
        let ahead = state.room(&affine).min(1.0);
        let pairs = state.pairs.iter().zip(&affine.pairs);
        let after = pairs.map(|(p, c)| (p.slack + ahead * c.slack) * (p.dual + ahead * c.dual));
        let in_cone = (state.cone.s + affine.s * ahead).dot(&(state.cone.z + affine.z * ahead));
        let share = (after.sum::<f64>() + in_cone) / gap;
        system.target = share.clamp(0.0, 1.0).powi(3) * gap / (state.pairs.len() + 1) as f64;
        system.products = affine.pairs.iter().map(|change| change.slack * change.dual).collect();
        system.bend = product(&scaling.inverse_times(&affine.s), &scaling.times(&affine.z));
        let change = newton.solve(&system, usize::from(gap < REFINED * self.gap));
        (state.room(&change) > SHORTEST).then_some(change)
    }

    fn residuals(&self, state: &State) -> Residuals {
        let duals: Vec<f64> = state.pairs.iter().map(|pair| pair.dual).collect();
        let mut by_d = DVector::zeros(self.variables());
        let mut by_v = self.terms.to_vec();
        let by_beta = self.pull(&duals, by_d.as_mut_slice(), &mut by_v);
        for i in 0..COMPONENTS {
            for (by_d, slope) in by_d.iter_mut().zip(self.slopes.row(i)) {
                *by_d -= state.cone.z[i + 1] * slope;
            }
        }
        by_d.axpy(self.curvature.floor, &state.d, 1.0);
        for (q, c) in self.curvature.directions.iter().zip(&self.curvature.along) {
            by_d.axpy(c * q.dot(&state.d), q, 1.0);
        }
        let mut rows = Vec::with_capacity(state.pairs.len());
        let mut slacks = state.pairs.iter();
        self.room(state.d.as_slice(), state.beta, &state.v, true, |room| {
            rows.push(slacks.next().map_or(0.0, |pair| pair.slack) - room);
        });
        Residuals {
            d: by_d,
            beta: [self.prices[0] + by_beta[0], self.prices[1] + by_beta[1]],
            v: by_v,
            t: self.weight - state.cone.z[0],
            rows,
        }
    }
}

/// What optimality misses.
struct Residuals {
    d: DVector<f64>,
    beta: [f64; 2],
    v: Vec<f64>,
    t: f64,
    rows: Vec<f64>,
}

/// A right-hand side of Newton's equations at a state.
struct System<'a> {
    state: &'a State,
    scaling: &'a Scaling,
    residuals: &'a Residuals,
    /// Of each pair, and in the cone, the product of the changes of slack and multiplier that is to be made up for.
    products: Vec<f64>,
    bend: Vector4<f64>,
    /// What each product of slack and multiplier is to be.
    target: f64,
}

/// Newton's matrix and its factors.
struct Newton<'a> {
    program: &'a Program<'a>,
    triangle: Triangle,
    /// Columns of the border, row by row: the error's slopes, the curvature's directions, both zero for time and excess, and
    /// the dense rows.
    border: Vec<f64>,
    /// Of each `v` what its floor adds to Newton's matrix, as of the last factors.
    floors: DVector<f64>,
    /// How the dense rows follow each `v`: `E`, one row per column of the border.
    by_v: DMatrix<f64>,
    /// `U⁻ᵀ` times the border.
    lower: Vec<f64>,
    columns: usize,
    small: Option<Small>,
}

/// Factors of the system in what the border stands for, and the `v`.
struct Small {
    /// Of `S`, without the `v`.
    factor: Cholesky<f64, Dyn>,
    /// `S⁻¹ E`.
    by_v: DMatrix<f64>,
    /// Of `F + Eᵀ S⁻¹ E`, where `F` are the floors: they may be next to nothing, and are not divided by.
    of_v: Cholesky<f64, Dyn>,
}

impl<'a> Newton<'a> {
    fn new(program: &'a Program<'a>) -> Self {
        let n = program.variables();
        let first_dense = COMPONENTS + program.curvature.along.len();
        let columns = first_dense + program.dense.len();
        let extent = |row: &Row| row.a.iter().rposition(|a| *a != 0.0).map_or(0, |last| last + 1);
        let width = program.rows.iter().map(extent).max().unwrap_or(1).max(1);
        let mut border = vec![0.0; (n + BORDER) * columns];
        for i in 0..n {
            for k in 0..COMPONENTS {
                border[i * columns + k] = program.slopes[(k, i)];
            }
            for (k, q) in program.curvature.directions.iter().enumerate() {
                border[i * columns + COMPONENTS + k] = q[i];
            }
            for (k, row) in program.dense.iter().enumerate() {
                border[i * columns + first_dense + k] = row.a[i];
            }
        }
        for (k, row) in program.dense.iter().enumerate() {
            if row.border == Slack::Time {
                border[n * columns + first_dense + k] = -row.e;
            }
        }
        let mut by_v = DMatrix::zeros(columns, program.terms.len());
        for (k, row) in program.dense.iter().enumerate() {
            if let Slack::Term(term) = row.border {
                by_v[(first_dense + k, term)] = row.e;
            }
        }
        Self {
            program,
            triangle: Triangle::zeros(n, width),
            lower: border.clone(),
            border,
            floors: DVector::zeros(program.terms.len()),
            by_v,
            columns,
            small: None,
        }
    }

    fn factorise(&mut self, state: &State, scaling: &Scaling) -> Option<()> {
        let program = self.program;
        let (n, columns) = (program.variables(), self.columns);
        self.triangle.clear();
        let (rows, rest) = state.pairs.split_at(2 * program.rows.len());
        let (bounds, rest) = rest.split_at(2 * n);
        let (betas, rest) = rest.split_at(2);
        let (dense, floors) = rest.split_at(program.dense.len());
        let ratio = |pair: &Pair| pair.dual / pair.slack;
        let mut alone = [0.0; BORDER];
        let mut next = 0;
        let mut absorb_bounds = |triangle: &mut Triangle, before: usize| {
            while next < before {
                let pairs = &bounds[2 * next..2 * next + 2];
                let mut entries = [0.0; WIDTH + BORDER];
                let floor = program.curvature.floor;
                entries[0] = (ratio(&pairs[0]) + ratio(&pairs[1]) + floor).sqrt();
                triangle.absorb(next, entries);
                next += 1;
            }
        };
        for (row, pairs) in program.rows.iter().zip(rows.chunks_exact(2)) {
            absorb_bounds(&mut self.triangle, row.first + 1);
            // Two rows (a, −e) and (−a, −e) with weights p and q have the product of these.
            let [p, q] = [ratio(&pairs[0]), ratio(&pairs[1])];
            let (sum, net) = (p + q, p - q);
            let root = sum.sqrt();
            let mut entries = [0.0; WIDTH + BORDER];
            for (entry, a) in entries.iter_mut().zip(&row.a) {
                *entry = root * a;
            }
            entries[WIDTH + row.border] = -row.e * net / root;
            self.triangle.absorb(row.first, entries);
            alone[row.border] += row.e * row.e * 4.0 * p * q / sum;
        }
        absorb_bounds(&mut self.triangle, n);
        for (k, pair) in betas.iter().enumerate() {
            let mut entries = [0.0; BORDER];
            entries[k] = (ratio(pair) + alone[k]).sqrt();
            self.triangle.absorb_border(entries);
        }
        if !self.triangle.is_regular() {
            return None;
        }
        self.lower.copy_from_slice(&self.border);
        self.triangle.solve_transposed(&mut self.lower, columns);
        // The small system in y, 3 of the cone and the rest of the curvature, with the other sign.
        let lower = DMatrixView::from_slice(&self.lower, columns, n + BORDER);
        let mut small = lower * lower.transpose();
        for i in 0..COMPONENTS {
            for j in 0..=i {
                small[(i, j)] += scaling.square(i + 1, j + 1);
            }
        }
        for (k, c) in program.curvature.along.iter().enumerate() {
            small[(COMPONENTS + k, COMPONENTS + k)] += 1.0 / c;
        }
        let first = COMPONENTS + program.curvature.along.len();
        for (i, pair) in dense.iter().enumerate() {
            small[(first + i, first + i)] += pair.slack / pair.dual;
        }
        self.floors = DVector::from_iterator(floors.len(), floors.iter().map(ratio));
        let factor = small.cholesky()?;
        let by_v = factor.solve(&self.by_v);
        let mut of_v = self.by_v.tr_mul(&by_v);
        for (k, floor) in self.floors.iter().enumerate() {
            of_v[(k, k)] += floor;
        }
        self.small = Some(Small { factor, by_v, of_v: of_v.cholesky()? });
        Some(())
    }

    /// The Newton step, so often corrected by what it misses.
    fn solve(&self, system: &System<'_>, refinements: usize) -> Change {
        let System { state, scaling, residuals, products, bend, target } = system;
        let program = self.program;
        let n = program.variables();
        // Δλ = (rc + λ ρ + λ (A Δx)) / g
        let mut constants: Vec<f64> = state
            .pairs
            .iter()
            .zip(products)
            .zip(&residuals.rows)
            .map(|((pair, product), rho)| {
                (target - product - pair.slack * pair.dual + pair.dual * rho) / pair.slack
            })
            .collect();
        // Multipliers of dense rows are unknowns of their own.
        let dense = program.dense_pairs()..program.dense_pairs() + program.dense.len();
        let of_dense = constants[dense.clone()].to_vec();
        constants[dense.clone()].fill(0.0);
        let mut f = DVector::zeros(n + BORDER);
        let mut f_v = DVector::zeros(state.v.len());
        let by_beta = program.pull(&constants, &mut f.as_mut_slice()[..n], f_v.as_mut_slice());
        for (f_v, residual) in f_v.iter_mut().zip(&residuals.v) {
            *f_v = -*f_v - residual;
        }
        for i in 0..n {
            f[i] = -f[i] - residuals.d[i];
        }
        for k in 0..BORDER {
            f[n + k] = -by_beta[k] - residuals.beta[k];
        }
        // Cone: Δs = W (λ \ rc) − W² Δz with y = −Δz.
        let mut complement = -product(&scaling.lambda, &scaling.lambda) - bend;
        complement[0] += *target;
        let shift = scaling.times(&quotient(&scaling.lambda, &complement));
        // z_0 + Δz_0 = W
        let y0 = -residuals.t;
        let mut g = DVector::zeros(self.columns);
        for k in 0..COMPONENTS {
            g[k] = shift[k + 1] + scaling.square(k + 1, 0) * y0;
        }
        let first = COMPONENTS + program.curvature.along.len();
        for (i, constant) in of_dense.iter().enumerate() {
            // constant = (rc + λ ρ) / s
            let pair = state.pairs[dense.start + i];
            g[first + i] = -constant * pair.slack / pair.dual;
        }
        let [mut x, mut y, mut v] = self.solve_reduced([&f, &g, &f_v]);
        for _ in 0..refinements {
            let [r_f, r_g, r_v] = self.miss(system, [&f, &g, &f_v], [&x, &y, &v]);
            let [more_x, more_y, more_v] = self.solve_reduced([&r_f, &r_g, &r_v]);
            x += more_x;
            y += more_y;
            v += more_v;
        }
        let beta = [x[n], x[n + 1]];
        let d = x.rows(0, n).into_owned();
        let z = Vector4::new(-y0, -y[0], -y[1], -y[2]);
        let mut s = Vector4::zeros();
        for k in 0..COMPONENTS {
            s[k + 1] = program.slopes.row(k).tr_dot(&d);
        }
        s[0] = shift[0]
            + scaling.square(0, 0) * y0
            + (0..COMPONENTS).map(|j| scaling.square(0, j + 1) * y[j]).sum::<f64>();
        let mut pairs = Vec::with_capacity(state.pairs.len());
        let mut at = 0;
        program.room(d.as_slice(), beta, v.as_slice(), false, |more| {
            let pair = state.pairs[at];
            let slack = more - residuals.rows[at];
            let dual =
                (target - products[at] - pair.slack * pair.dual - pair.dual * slack) / pair.slack;
            pairs.push(Pair { slack, dual });
            at += 1;
        });
        Change { d, beta, v: v.data.into(), pairs, s, z }
    }

    /// Solves `K x + Pᵀ y = f`, `P x − N y − E v = g`, `F v − Eᵀ y = f_v`.
    fn solve_reduced(&self, [f, g, f_v]: [&DVector<f64>; 3]) -> [DVector<f64>; 3] {
        let columns = self.columns;
        let mut x = f.clone();
        self.triangle.solve_transposed(x.as_mut_slice(), 1);
        let mut y = -g;
        for (row, x) in self.lower.chunks_exact(columns).zip(x.iter()) {
            for (entry, own) in y.iter_mut().zip(row) {
                *entry += own * x;
            }
        }
        let mut v = f_v.clone();
        if let Some(Small { factor, by_v, of_v }) = &self.small {
            factor.solve_mut(&mut y);
            v += self.by_v.tr_mul(&y);
            of_v.solve_mut(&mut v);
            y -= by_v * &v;
        }
        for (x, row) in x.iter_mut().zip(self.lower.chunks_exact(columns)) {
            *x -= row.iter().zip(y.iter()).map(|(a, y)| a * y).sum::<f64>();
        }
        self.triangle.solve(x.as_mut_slice());
        [x, y, v]
    }

    /// By how much a solution of the reduced system misses its right-hand side.
    fn miss(
        &self,
        System { state, scaling, .. }: &System<'_>,
        [f, g, f_v]: [&DVector<f64>; 3],
        [x, y, v]: [&DVector<f64>; 3],
    ) -> [DVector<f64>; 3] {
        let program = self.program;
        let (columns, n) = (self.columns, program.variables());
        let mut numbers = Vec::with_capacity(state.pairs.len());
        let mut pairs = state.pairs.iter();
        let mut unused = vec![0.0; state.v.len()];
        program.room(&x.as_slice()[..n], [x[n], x[n + 1]], &unused, false, |more| {
            numbers.push(pairs.next().map_or(0.0, |pair| more * pair.dual / pair.slack));
        });
        let dense = program.dense_pairs();
        numbers[dense..].fill(0.0);
        let mut r_f = f.clone();
        let by_beta = program.pull(&numbers, &mut r_f.as_mut_slice()[..n], &mut unused);
        for k in 0..BORDER {
            r_f[n + k] += by_beta[k];
        }
        r_f.rows_mut(0, n).axpy(-program.curvature.floor, &x.rows(0, n), 1.0);
        let mut r_g = g + &self.by_v * v;
        let r_v = f_v + self.by_v.tr_mul(y) - v.component_mul(&self.floors);
        for (i, row) in self.border.chunks_exact(columns).enumerate() {
            for (k, entry) in row.iter().enumerate() {
                r_f[i] -= entry * y[k];
                r_g[k] -= entry * x[i];
            }
        }
        for k in 0..COMPONENTS {
            for l in 0..COMPONENTS {
                r_g[k] += scaling.square(k + 1, l + 1) * y[l];
            }
        }
        for (k, c) in program.curvature.along.iter().enumerate() {
            r_g[COMPONENTS + k] += y[COMPONENTS + k] / c;
        }
        let first = COMPONENTS + program.curvature.along.len();
        for (i, pair) in state.pairs[dense..].iter().take(program.dense.len()).enumerate() {
            r_g[first + i] += y[first + i] * pair.slack / pair.dual;
        }
        [r_f, r_g, r_v]
    }
}
