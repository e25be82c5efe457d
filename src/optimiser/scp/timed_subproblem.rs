//! The convex subproblem of the search on a [`Timed`](crate::search::Timed) cost.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::bends::Curvature;
use super::interior_point::{DenseRow, Minimum, Program, Row, Slack};
use super::subproblem::{Region, Rows, by_clarabel};
use crate::search::{
    Bent, LinearLimit, LinearLimits, Oracle, Piece, PieceId, Stop, Term, TimedWeights,
};

/// What a solution may miss of the least cost, as a share of the cost.
const GAP: f64 = 1e-9;

/// A limit is in the subproblem where over this many times the last step it may come so near to what bounds it.
const STEPS: f64 = 4.0;
const NEAR: f64 = 0.9;

/// Share of what a step promises that limits which are not in the subproblem may take from it.
const MISS: f64 = 0.3;

/// The least such share, of the cost.
const LEAST_MISS: f64 = 1e-10;

/// Most subproblems to find the limits that matter.
const ROUNDS: usize = 6;

/// How near to what bounds it a limit is active.
const ACTIVE: f64 = 1e-3;

/// Limits whose slopes differ by no more than this share of the largest are one.
const SAME: f64 = 1e-3;

/// Limits that mattered in the last subproblem and are not the same at every point.
#[derive(Default)]
pub(super) struct Cuts(Vec<LinearLimit>);

impl Cuts {
    /// Makes their values those at another point.
    pub(super) fn move_by(&mut self, step: &DVector<f64>) {
        for limit in &mut self.0 {
            limit.value += limit.change(step);
        }
    }

    fn keep(&mut self, limit: &LinearLimit) {
        let same = |known: &LinearLimit| {
            let largest = known.slopes.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
            let mut pairs = known.slopes.iter().zip(&limit.slopes);
            (known.power, known.first) == (limit.power, limit.first)
                && pairs.all(|(a, b)| (a - b).abs() <= SAME * largest)
        };
        if !self.0.iter().any(same) {
            self.0.push(*limit);
        }
    }
}

/// What stands for the cost near a point. With `c = T³` and `u = c / c_0`, minimise over `d` in the region
///
/// ```text
/// w_T T_0 u / 3 + w_r ‖r + R d‖ + w_s s + ½ dᵀ B d
/// |ℓ_i + g_i · d| ≤ T_0^p_i (1 + p_i (u − 1) / 3)    p_i = 1, 2, 3
/// |ℓ_i + g_i · d| ≤ 1 + s                            p_i = 0
/// v_i + g_i · d ≤ T_0 (1 + (u − 1) / 3)              durations that bend
/// ```
///
/// and maxima that bend with their pieces linearised.
///
/// Powers of `c` are concave, so their tangents, which stand for them, lie above.
pub(super) struct Model<'a> {
    pub(super) weights: TimedWeights,
    /// The cost at the point.
    pub(super) here: f64,
    pub(super) x: &'a DVector<f64>,
    /// `T_0`.
    pub(super) time: f64,
    pub(super) limits: &'a LinearLimits,
    /// `r`, or what corrects it.
    pub(super) error: &'a DVector<f64>,
    /// `R`.
    pub(super) slopes: &'a DMatrix<f64>,
    /// What bends but the error.
    pub(super) bent: &'a Bent,
    pub(super) curvature: &'a Curvature,
    pub(super) region: &'a Region,
    /// The last step, where there was one.
    pub(super) last: Option<&'a DVector<f64>>,
}

/// A minimum of the model.
pub(super) struct Solution {
    pub(super) d: DVector<f64>,
    /// The model's cost there, with the time and excess that all limits ask for.
    pub(super) cost: f64,
    /// `‖r + R d‖`.
    pub(super) left: f64,
    /// The error's multiplier.
    pub(super) nu: DVector<f64>,
    /// Those of pieces that bend; of all others zero.
    pub(super) multipliers: Vec<(PieceId, f64)>,
}

/// A piece of what bends: of the durations, or of one of the terms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    term: Option<usize>,
    index: usize,
}

impl Bent {
    fn places(&self) -> Vec<Place> {
        let of_term = |(k, term): (usize, &Term)| {
            (0..term.pieces.len()).map(move |index| Place { term: Some(k), index })
        };
        let durations = (0..self.durations.len()).map(|index| Place { term: None, index });
        durations.chain(self.terms.iter().enumerate().flat_map(of_term)).collect()
    }

    /// All pieces.
    pub(super) fn pieces(&self) -> Vec<Piece> {
        self.places().into_iter().map(|place| self.piece(place).clone()).collect()
    }

    fn piece(&self, Place { term, index }: Place) -> &Piece {
        match term {
            None => &self.durations[index],
            Some(k) => &self.terms[k].pieces[index],
        }
    }
}

impl Model<'_> {
    /// The minimum over all limits, unless no solver finds it: limits that a minimum over some of them breaks are added,
    /// until it breaks none that matters.
    pub(super) fn minimise(
        &self,
        oracle: &mut Oracle<'_>,
        cuts: &mut Cuts,
    ) -> Result<Option<Solution>, Stop> {
        let all = self.limits.list.iter().chain(&cuts.0);
        let mut list: Vec<LinearLimit> = all.filter(|limit| self.is_near(limit)).copied().collect();
        let mut dense = self.bent.places();
        dense.retain(|place| self.may_matter(*place));
        let mut round = 0;
        loop {
            round += 1;
            let solve =
                || self.solve(&list, &dense).or_else(|| self.solve_by_clarabel(&list, &dense));
            let Some(Minimum { d, nu, dense: multipliers }) = oracle.conic(solve)? else {
                return Ok(None);
            };
            let ends = oracle.limits((self.x + &d).as_slice())?;
            let asked = |limit: &LinearLimit| limit.asks(limit.value + limit.change(&d));
            let [mut excess, mut time] = [0.0_f64; 2];
            for limit in &list {
                let most = if limit.power == 0 { &mut excess } else { &mut time };
                *most = most.max(asked(limit));
            }
            let left = (self.error + self.slopes * &d).norm();
            let rest = self.weights.error * left + self.curvature.energy(&d) + self.bent_terms(&d);
            let bent_time = self.bent_time(&d);
            time = time.max(bent_time);
            let cost = |time: f64, excess: f64| {
                self.weights.time * time + self.weights.excess * excess + rest
            };
            let promised = (self.here - cost(time, excess)).max(0.0);
            let slack = MISS * promised + LEAST_MISS * self.here.abs();
            let known = (list.len(), dense.len());
            if round < ROUNDS {
                let missing = self.bent.places().into_iter().filter(|place| {
                    !dense.contains(place) && self.exceeds(*place, &d, time, slack)
                });
                dense.extend(missing.collect::<Vec<_>>());
                list.extend(ends.list.iter().filter_map(|limit| {
                    let more = match limit.power {
                        0 => self.weights.excess * (limit.asks(limit.value) - excess),
                        _ => self.weights.time * (limit.asks(limit.value) - time),
                    };
                    let value = limit.value - limit.change(&d);
                    (more > slack).then_some(LinearLimit { value, ..*limit })
                }));
            }
            if (list.len(), dense.len()) == known {
                let active = |limit: &&LinearLimit| match limit.power {
                    0 => asked(limit) > excess - ACTIVE,
                    _ => asked(limit) > time * (1.0 - ACTIVE),
                };
                cuts.0.clear();
                let own = list.iter().filter(|limit| limit.id.is_none()).filter(active);
                own.for_each(|limit| cuts.keep(limit));
                let cost = cost(ends.time.max(bent_time), ends.excess);
                let ids = dense.iter().map(|place| self.bent.piece(*place).id);
                let multipliers = ids.zip(multipliers).collect();
                return Ok(Some(Solution { d, cost, left, nu, multipliers }));
            }
        }
    }

    /// Whether a limit may matter, judged by the last step.
    fn is_near(&self, limit: &LinearLimit) -> bool {
        let Some(last) = self.last else { return true };
        let own = last.as_slice()[limit.first..].iter().zip(&limit.slopes);
        let reach: f64 = own.map(|(d, slope)| (d * slope).abs()).sum();
        limit.value.abs() + STEPS * reach > NEAR * self.scale(limit)
    }

    /// Whether a piece that bends may matter, judged by the last step. A constant one is a floor.
    fn may_matter(&self, place: Place) -> bool {
        let piece = self.bent.piece(place);
        if piece.gradient.amax() == 0.0 {
            return false;
        }
        let Some(last) = self.last else { return true };
        let own = piece.gradient.iter().zip(last.iter());
        let reach: f64 = own.map(|(slope, d)| (slope * d).abs()).sum();
        let bound = place.term.map_or(NEAR * self.time, |_| 0.0);
        piece.value + STEPS * reach > bound
    }

    /// Whether a piece that bends adds more than `slack` to the cost over a step, beyond what else bounds time or term.
    fn exceeds(&self, place: Place, d: &DVector<f64>, time: f64, slack: f64) -> bool {
        let piece = self.bent.piece(place);
        let value = piece.value + piece.gradient.dot(d);
        match place.term {
            None => self.weights.time * (value - time) > slack,
            Some(k) => self.bent.terms[k].weight * (value - self.bent.terms[k].floor) > slack,
        }
    }

    /// Pieces that bend as rows whose largest entry is one, and by what each was divided.
    fn dense(&self, places: &[Place]) -> Vec<(DenseRow, f64)> {
        let to_row = |place: &Place| {
            let Piece { value, gradient, .. } = self.bent.piece(*place);
            let (border, e, b) = match place.term {
                None => (Slack::Time, self.time / 3.0, 2.0 / 3.0 * self.time - value),
                Some(k) => (Slack::Term(k), 1.0, -value),
            };
            let unit = gradient.amax().max(e);
            (DenseRow { a: gradient / unit, border, e: e / unit, b: b / unit }, unit)
        };
        places.iter().map(to_row).collect()
    }

    /// The longest of the durations that bend, over a step.
    fn bent_time(&self, d: &DVector<f64>) -> f64 {
        let there = self.bent.durations.iter().map(|piece| piece.value + piece.gradient.dot(d));
        there.fold(0.0, f64::max)
    }

    /// What the maxima that bend come to over a step.
    fn bent_terms(&self, d: &DVector<f64>) -> f64 {
        let there = |term: &Term| {
            let values = term.pieces.iter().zip(term.changes(d));
            term.weight * term.value_at(values.map(|(piece, change)| piece.value + change))
        };
        self.bent.terms.iter().map(there).sum()
    }

    /// `T_0^p`.
    fn scale(&self, limit: &LinearLimit) -> f64 {
        self.time.powi(i32::from(limit.power))
    }

    /// The limits as rows whose largest entry is one.
    fn rows(&self, list: &[LinearLimit]) -> Vec<Row> {
        let to_row = |limit: &LinearLimit| {
            let scale = self.scale(limit);
            let (value, by_u) = (limit.value / scale, f64::from(limit.power) / 3.0);
            let largest = limit.slopes.iter().fold(0.0, |most: f64, g| most.max(g.abs())) / scale;
            let unit = largest.max(by_u);
            let (border, e) = if limit.power == 0 { (1, 1.0) } else { (0, by_u) };
            let mut a = limit.slopes.map(|slope| slope / scale / unit);
            // What stands after the last variable is zero.
            let first = limit.first.min(self.x.len().saturating_sub(a.len()));
            a.rotate_right(limit.first - first);
            Row {
                first,
                a,
                border,
                e: e / unit,
                b: [(1.0 - by_u - value) / unit, (1.0 - by_u + value) / unit],
            }
        };
        let mut rows: Vec<Row> = list.iter().map(to_row).collect();
        rows.sort_by_key(|row| row.first);
        rows
    }

    fn program<'a>(
        &'a self,
        rows: &'a [Row],
        dense: &'a [DenseRow],
        terms: &'a [f64],
    ) -> Program<'a> {
        Program {
            rows,
            dense,
            terms,
            lower: &self.region.lower,
            upper: &self.region.upper,
            prices: [self.weights.time * self.time / 3.0, self.weights.excess],
            // Room for every row at `d = 0`.
            start: [1.2, 0.2 + self.limits.excess],
            weight: self.weights.error,
            error: self.error,
            slopes: self.slopes,
            curvature: self.curvature,
            gap: GAP * self.here.abs(),
            here: self.here - 2.0 / 3.0 * self.weights.time * self.time,
        }
    }

    fn terms(&self) -> Vec<f64> {
        self.bent.terms.iter().map(|term| term.weight).collect()
    }

    fn solve(&self, list: &[LinearLimit], places: &[Place]) -> Option<Minimum> {
        // Its terms are never below zero.
        if self.bent.terms.iter().any(|term| term.floor != 0.0) {
            return None;
        }
        let (dense, units): (Vec<_>, Vec<_>) = self.dense(places).into_iter().unzip();
        let (rows, terms) = (self.rows(list), self.terms());
        let found = self.program(&rows, &dense, &terms).minimise()?;
        Some(in_units(found, &units))
    }

    /// The same by a general solver, which takes several times as long.
    fn solve_by_clarabel(&self, list: &[LinearLimit], places: &[Place]) -> Option<Minimum> {
        let (dense, units): (Vec<_>, Vec<_>) = self.dense(places).into_iter().unzip();
        let (rows, terms) = (self.rows(list), self.terms());
        let Program { prices, weight, curvature, .. } = self.program(&rows, &dense, &terms);
        let (n, m) = (self.x.len(), curvature.along.len());
        // Step, time and excess, norm of the error, the step's components along the curvature's directions.
        let (t, first_term) = (n + 2, n + 3 + m);
        let size = first_term + self.bent.terms.len();
        let mut q = vec![0.0; size];
        q[n..n + 2].copy_from_slice(&prices);
        q[t] = weight;
        for (q, term) in q[first_term..].iter_mut().zip(&self.bent.terms) {
            *q = term.weight;
        }
        let mut all = Rows::default();
        for row in &rows {
            for (sign, b) in [1.0, -1.0].into_iter().zip(row.b) {
                let entries = row.a.iter().enumerate().filter(|(_, a)| **a != 0.0);
                let entries = entries.map(|(k, a)| (row.first + k, sign * a));
                all.push(entries.chain([(n + row.border, -row.e)]), b);
            }
        }
        let Region { lower, upper, .. } = self.region;
        for (j, (lower, upper)) in lower.iter().zip(upper).enumerate() {
            all.push([(j, 1.0)], *upper);
            all.push([(j, -1.0)], -*lower);
        }
        for k in 0..2 {
            all.push([(n + k, -1.0)], 0.0);
        }
        let first_dense = all.b.len();
        for row in &dense {
            let column = match row.border {
                Slack::Time => n,
                Slack::Term(k) => first_term + k,
            };
            let entries = row.a.iter().copied().enumerate().filter(|(_, slope)| *slope != 0.0);
            all.push(entries.chain([(column, -row.e)]), row.b);
        }
        for (k, term) in self.bent.terms.iter().enumerate() {
            if term.floor.is_finite() {
                all.push([(first_term + k, -1.0)], -term.floor);
            }
        }
        let inequalities = all.b.len();
        all.push([(t, -1.0)], 0.0);
        for (value, slopes) in self.error.iter().zip(self.slopes.row_iter()) {
            all.push(slopes.iter().enumerate().map(|(j, slope)| (j, -slope)), *value);
        }
        let norm = 1 + self.error.len();
        for (i, direction) in curvature.directions.iter().enumerate() {
            all.push(direction.iter().copied().enumerate().chain([(t + 1 + i, -1.0)]), 0.0);
        }
        let cones = [NonnegativeConeT(inequalities), SecondOrderConeT(norm), ZeroConeT(m)];
        let places: Vec<usize> = (0..n).chain(t + 1..first_term).collect();
        let floor = std::iter::repeat_n(curvature.floor, n);
        let along = floor.chain(curvature.along.iter().copied()).collect();
        let p = CscMatrix::new_from_triplets(size, size, places.clone(), places, along);
        let a = all.matrix(size);
        let solution = by_clarabel(&p, &q, &a, &all.b, &cones, GAP)?;
        // Within the region to the last bit.
        let d = DVector::from_column_slice(&solution.x[..n]).sup(lower).inf(upper);
        let nu = &solution.z[inequalities + 1..inequalities + norm];
        let multipliers = solution.z[first_dense..first_dense + dense.len()].to_vec();
        let found = Minimum { d, nu: -DVector::from_column_slice(nu), dense: multipliers };
        Some(in_units(found, &units))
    }
}

/// Multipliers of rows as those of pieces, which were divided by their units.
fn in_units(mut found: Minimum, units: &[f64]) -> Minimum {
    found.dense.iter_mut().zip(units).for_each(|(multiplier, unit)| *multiplier /= unit);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::Bounds;

    /// A program like those of splines: jerks as third differences, some rates, a wide and a narrow region.
    fn both(pieces: usize, radius: f64, weight: f64, bent: &Bent) -> [Solution; 2] {
        let n = pieces;
        let wave = |i: usize, k: f64| f64::sin(k * i as f64 + 0.3);
        let mut list = Vec::new();
        for i in 0..n - 3 {
            let slopes = [-1.0, 3.0, -3.0, 1.0, 0.0, 0.0].map(|entry| entry * 1e4);
            list.push(LinearLimit {
                id: None,
                power: 3,
                value: 180.0 * wave(i, 1.7),
                first: i,
                slopes,
            });
            let slopes = [1.0, -1.0, 0.0, 0.0, 0.0, 0.0].map(|entry| entry * 30.0);
            list.push(LinearLimit {
                id: None,
                power: 1,
                value: 5.0 * wave(i, 0.7),
                first: i,
                slopes,
            });
            let slopes = [0.2, 0.6, 0.2, 0.0, 0.0, 0.0];
            list.push(LinearLimit {
                id: None,
                power: 0,
                value: 0.99 * wave(i, 0.2),
                first: i,
                slopes,
            });
        }
        let asked = |timed: bool| {
            let own = list.iter().filter(move |limit| (limit.power > 0) == timed);
            own.map(|limit| limit.asks(limit.value)).fold(0.0, f64::max)
        };
        let limits = LinearLimits { time: asked(true), excess: asked(false), list: list.clone() };
        let x = DVector::zeros(n);
        let curvature = Curvature {
            floor: 0.01,
            directions: (0..4)
                .map(|k| DVector::from_fn(n, |i, _| 0.1 * wave(i, 0.4 * f64::from(k))))
                .collect(),
            along: vec![0.3, 0.1, 0.02, 0.5],
        };
        let model = Model {
            weights: TimedWeights { time: 0.1, error: weight, excess: 100.0 },
            // So little that no gain over it is enough.
            here: 0.1,
            x: &x,
            time: limits.time,
            limits: &limits,
            bent,
            error: &DVector::from_vec(vec![0.02, -0.03, 0.01]),
            slopes: &DMatrix::from_fn(3, n, |j, i| 0.05 * wave(i, 0.1 + 0.2 * j as f64)),
            curvature: &curvature,
            region: &Region::around(&Bounds::cube(n, [-1.0, 1.0]), &x, radius),
            last: None,
        };
        let places = bent.places();
        [model.solve(&list, &places), model.solve_by_clarabel(&list, &places)].map(|found| {
            let Minimum { d, nu, dense } = found.unwrap();
            // The least `u` and `s` that the model's limits leave.
            let [mut u, mut s] = [0.0_f64; 2];
            for limit in &list {
                let (value, p) = (limit.value + limit.change(&d), f64::from(limit.power));
                if limit.power == 0 {
                    s = s.max(limit.asks(value));
                } else {
                    u = u.max(1.0 + (value.abs() / model.scale(limit) - 1.0) * 3.0 / p);
                }
            }
            let left = (model.error + model.slopes * &d).norm();
            u = u.max(1.0 + (model.bent_time(&d) / limits.time - 1.0) * 3.0);
            let rest = weight * left + model.curvature.energy(&d) + model.bent_terms(&d);
            let cost = 0.1 * limits.time / 3.0 * u + 100.0 * s + rest;
            let ids = places.iter().map(|place| model.bent.piece(*place).id);
            let multipliers = ids.zip(dense).collect();
            Solution { d, cost, left, nu, multipliers }
        })
    }

    /// Two interior-point methods that have nothing in common but the program find the same minimum.
    #[test]
    fn our_own_solver_agrees_with_clarabel() {
        for (pieces, radius, weight) in [(12, 0.5, 3.0), (40, 0.1, 50.0), (90, 0.02, 0.4)] {
            let [own, general] = both(pieces, radius, weight, &Bent::default());
            assert!(own.d.amax() <= radius * (1.0 + 1e-12), "{}", own.d.amax());
            let [a, b] = [own.cost, general.cost];
            assert!((a - b).abs() < 1e-6 * b.abs(), "{pieces} pieces: {a} and {b}");
            let miss = (&own.nu - &general.nu).norm();
            assert!(miss < 1e-3 * general.nu.norm(), "{pieces}: {} and {}", own.nu, general.nu);
            assert!(own.nu.norm() <= weight * (1.0 + 1e-6), "{}", own.nu.norm());
        }
    }

    /// Also where durations bend and maxima are added that do.
    #[test]
    fn dense_rows_are_kept_by_both() {
        for (pieces, radius, weight) in [(12, 0.5, 3.0), (40, 0.1, 50.0), (90, 0.02, 0.4)] {
            let piece = |track: u64, value: f64, slope: f64| {
                let gradient: Vec<f64> =
                    (0..pieces).map(|i| slope * f64::cos(0.3 * i as f64 + track as f64)).collect();
                Piece::new(track, value, gradient)
            };
            let durations = vec![piece(0, 9.0, 3.0), piece(1, 11.0, 2.0)];
            let terms = vec![
                Term::max(100.0, vec![piece(2, 0.004, 0.2), piece(3, -0.01, 0.7)]).at_least(0.0),
                Term::max(0.5, vec![piece(4, 0.3, 0.4)]).at_least(0.0),
            ];
            let bent = Bent::new(durations, terms, 0.0);
            let [own, general] = both(pieces, radius, weight, &bent);
            let [a, b] = [own.cost, general.cost];
            assert!((a - b).abs() < 1e-6 * b.abs(), "{pieces} pieces: {a} and {b}");
            let largest = general.multipliers.iter().fold(0.0, |most: f64, (_, m)| most.max(*m));
            assert!(largest > 1e-3, "{:?}", general.multipliers);
            for ((place, own), (_, general)) in own.multipliers.iter().zip(&general.multipliers) {
                assert!((own - general).abs() < 2e-3 * largest, "{place:?}: {own} and {general}");
            }
        }
    }
}
