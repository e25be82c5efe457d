//! The exact peaks of splines.

use std::sync::Arc;

use super::bernstein::Bernstein;
use super::bspline::{Knots, MOST_DEGREE};
use super::family::Site;
use super::peaks::{Limits, LocalPeak, Peak, Peaks, duration_asked, longest_asked, powers};

/// What peaks of splines are found with: how Bernstein coefficients follow from control points.
#[derive(Debug, Clone)]
pub struct SplineSampler(Arc<Tables>);

#[derive(Debug)]
struct Tables {
    knots: Knots,
    /// For each order and each piece.
    bernstein: [Vec<[[f64; MOST_DEGREE + 1]; MOST_DEGREE + 1]>; ORDERS],
    /// The basis functions at the start of every piece, and at the end of the last, from the right where there is one.
    at_knots: Vec<(usize, Bumps)>,
}

/// Orders of derivatives that have limits: position, rate, acceleration, jerk.
const ORDERS: usize = 4;

/// The derivatives of the basis functions that are not zero at a time.
type Bumps = [[f64; ORDERS]; MOST_DEGREE + 1];

/// The control points of one path's derivatives.
#[derive(Debug, Clone)]
pub struct SplineSamples {
    tables: Arc<Tables>,
    /// For each joint those of position, rate, acceleration and jerk, each with room for as many.
    points: Vec<f64>,
}

impl SplineSampler {
    pub(super) fn new(knots: Knots) -> Self {
        let bernstein = std::array::from_fn(|order| {
            (0..knots.pieces()).map(|piece| knots.bernstein(piece, order)).collect()
        });
        let pieces = knots.pieces();
        let at_knots = (0..=pieces).map(|i| knots.bumps(i as f64 / pieces as f64)).collect();
        Self(Arc::new(Tables { knots, bernstein, at_knots }))
    }

    pub(super) fn samples(&self, joints: usize) -> SplineSamples {
        let points = vec![0.0; joints * 4 * self.0.knots.points()];
        SplineSamples { tables: self.0.clone(), points }
    }

    /// Takes over a joint's control points and differentiates them.
    pub(super) fn sample(
        &self,
        joint: usize,
        samples: &mut SplineSamples,
        write: impl FnOnce(&mut [f64]),
    ) {
        let count = self.0.knots.points();
        let own = &mut samples.points[joint * 4 * count..(joint + 1) * 4 * count];
        write(&mut own[..count]);
        for order in 1..=3 {
            let (before, derivative) = own[(order - 1) * count..].split_at_mut(count);
            let before = &before[..=count - order];
            self.0.knots.differentiate(before, order, &mut derivative[..count - order]);
        }
    }
}

/// What no value of a spline with these control points exceeds.
fn largest_magnitude(points: &[f64]) -> f64 {
    points.iter().fold(0.0, |largest, point| f64::max(largest, point.abs()))
}

/// One derivative of one joint's path.
#[derive(Clone, Copy)]
struct Row<'a> {
    tables: &'a Tables,
    order: usize,
    /// Control points.
    points: &'a [f64],
}

impl Row<'_> {
    fn degree(&self) -> usize {
        self.tables.knots.degree() - self.order
    }

    fn pieces(&self) -> usize {
        self.tables.knots.pieces()
    }

    /// What the magnitude does not exceed on a piece.
    fn bound(&self, piece: usize) -> f64 {
        largest_magnitude(&self.points[piece..=piece + self.degree()])
    }

    /// The polynomial of a piece.
    fn polynomial(&self, piece: usize) -> Bernstein {
        let own = &self.points[piece..=piece + self.degree()];
        let mut coefficients = [0.0; MOST_DEGREE + 1];
        let rows = &self.tables.bernstein[self.order][piece];
        for (coefficient, row) in coefficients.iter_mut().zip(rows).take(own.len()) {
            *coefficient = own.iter().zip(row).map(|(point, share)| point * share).sum();
        }
        Bernstein::new(coefficients, self.degree())
    }

    fn tau(&self, piece: usize, t: f64) -> f64 {
        (piece as f64 + t) / self.pieces() as f64
    }

    /// Where the magnitude may be largest, with its value there: in degree 0 the middle of every piece, in degree 1 every
    /// knot, else every local maximum. Those below `floor` may be left out.
    fn candidates(self, floor: f64) -> impl Iterator<Item = Peak> {
        let degree = self.degree();
        let simple = (degree < 2).then(|| {
            let middle = if degree == 0 { 0.5 } else { 0.0 };
            self.points
                .iter()
                .enumerate()
                .map(move |(i, point)| Peak { value: point.abs(), tau: self.tau(i, middle) })
        });
        let smooth = (degree >= 2).then(|| {
            let pieces = (0..self.pieces()).filter(move |&piece| self.bound(piece) >= floor);
            pieces.flat_map(move |piece| self.maxima(piece))
        });
        let all = simple.into_iter().flatten().chain(smooth.into_iter().flatten());
        all.filter(move |peak| peak.value >= floor)
    }

    /// The local maxima of the magnitude on a piece, its start and, of the last one, its end among them.
    fn maxima(self, piece: usize) -> impl Iterator<Item = Peak> {
        let polynomial = self.polynomial(piece);
        let mut places = polynomial.turns();
        places.push(0.0);
        places.extend((piece + 1 == self.pieces()).then_some(1.0));
        places
            .into_iter()
            .map(move |t| Peak { value: polynomial.value(t).abs(), tau: self.tau(piece, t) })
    }

    fn peak(self) -> Peak {
        if self.degree() < 2 {
            return self.candidates(0.0).fold(Peak::default(), Peak::or);
        }
        let mut best = Peak::default();
        for piece in 0..self.pieces() {
            if self.bound(piece) > best.value {
                best = self.maxima(piece).fold(best, Peak::or);
            }
        }
        best
    }
}

impl SplineSamples {
    fn joints(&self) -> usize {
        self.points.len() / (4 * self.tables.knots.points())
    }

    fn row(&self, joint: usize, order: usize) -> Row<'_> {
        let count = self.tables.knots.points();
        let first = (joint * 4 + order) * count;
        Row { tables: &self.tables, order, points: &self.points[first..first + count - order] }
    }

    pub(super) fn peaks(&self) -> Peaks {
        let joints = 0..self.joints();
        Peaks(joints.map(|joint| [1, 2, 3].map(|order| self.row(joint, order).peak())).collect())
    }

    /// Of each order the largest peak as a multiple of its limit, where it `matters`.
    pub(super) fn largest_ratio(
        &self,
        limits: &Limits,
        matters: impl Fn([f64; 3]) -> [f64; 3],
    ) -> [f64; 3] {
        let mut known = [0.0; 3];
        // Jerks and accelerations, which matter most, are the simplest to find.
        for order in [3, 2, 1] {
            let k = order - 1;
            for (joint, limit) in limits.0.iter().enumerate() {
                let row = self.row(joint, order);
                let floor = matters(known)[k] * limit[k];
                if largest_magnitude(row.points) > floor {
                    known[k] = f64::max(known[k], row.peak().value / limit[k]);
                }
            }
        }
        known
    }

    /// By how much positions leave their ranges, as a share of half the range; zero within.
    pub(super) fn range_excess(&self, ranges: &[[f64; 2]]) -> f64 {
        let mut excess: f64 = 0.0;
        for (joint, &[lower, upper]) in ranges.iter().enumerate() {
            let (row, half) = (self.row(joint, 0), (upper - lower) / 2.0);
            // The path stays where its control points are.
            let beyond = |position: f64| f64::max(lower - position, position - upper);
            if row.points.iter().all(|&point| beyond(point) <= 0.0) {
                continue;
            }
            for piece in 0..row.pieces() {
                let polynomial = row.polynomial(piece);
                // Start and goal, which no path changes, are in the range but for rounding.
                let knot = (piece > 0).then_some(0.0);
                for t in polynomial.turns().into_iter().chain(knot) {
                    excess = excess.max(beyond(polynomial.value(t)) / half);
                }
            }
        }
        excess
    }

    /// Every place where a derivative of a joint's path may be largest in magnitude: all knots, and where it turns between
    /// them.
    ///
    /// `first` and `slopes` of a site are those of the joint's control points.
    pub(super) fn sites(&self, mut each: impl FnMut(Site)) {
        let Tables { knots, at_knots, .. } = &*self.tables;
        for joint in 0..self.joints() {
            let points = self.row(joint, 0).points;
            let mut site = |order: usize, place, (first, bumps): &(usize, Bumps)| {
                let slopes = bumps.map(|bump| bump[order]);
                let own = points[*first..].iter().zip(&slopes).take(knots.degree() + 1);
                let value = own.map(|(point, slope)| point * slope).sum();
                each(Site { joint, order, value, place, first: *first, slopes });
            };
            for order in 0..ORDERS {
                let row = self.row(joint, order);
                let last = knots.pieces() - usize::from(row.degree() == 0);
                for (i, at) in at_knots[..=last].iter().enumerate() {
                    site(order, Some(i), at);
                }
                if row.degree() >= 2 {
                    for piece in 0..row.pieces() {
                        for t in row.polynomial(piece).turns() {
                            site(order, None, &knots.bumps(row.tau(piece, t)));
                        }
                    }
                }
            }
        }
    }

    /// All candidates for peaks that ask for a duration not below `share` of the longest asked for.
    pub(super) fn local_peaks(&self, limits: &Limits, share: f64) -> Vec<LocalPeak> {
        let largest = self.largest_ratio(limits, |known| powers(longest_asked(known)));
        let least = share * longest_asked(largest);
        let mut places = Vec::new();
        for (joint, limit) in limits.0.iter().enumerate() {
            for order in 1..=3 {
                let limit = limit[order - 1];
                let floor = limit * powers(least)[order - 1];
                let peaks = self.row(joint, order).candidates(floor);
                let near = peaks.filter(|peak| duration_asked(peak.value / limit, order) >= least);
                places.extend(near.map(|peak| LocalPeak { joint, order, tau: peak.tau }));
            }
        }
        places
    }
}
