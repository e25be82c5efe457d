//! The exact peaks of splines.

use std::sync::Arc;

use super::bernstein::Bernstein;
use super::bspline::{Knots, MOST_DEGREE};
use super::peaks::{Limits, LocalPeak, Peak, Peaks, duration_asked, longest_asked, powers};

/// What peaks of splines are found with: how Bernstein coefficients follow from control points.
#[derive(Debug, Clone)]
pub struct SplineSampler(Arc<Tables>);

#[derive(Debug)]
struct Tables {
    knots: Knots,
    /// For each order from one and each piece.
    bernstein: [Vec<[[f64; MOST_DEGREE + 1]; MOST_DEGREE + 1]>; 3],
}

/// The control points of one path's derivatives.
#[derive(Debug, Clone)]
pub struct SplineSamples {
    tables: Arc<Tables>,
    /// For each joint those of position, rate, acceleration and jerk, each with room for as many.
    points: Vec<f64>,
}

impl SplineSampler {
    pub(super) fn new(knots: Knots) -> Self {
        let bernstein = [1, 2, 3]
            .map(|order| (0..knots.pieces()).map(|piece| knots.bernstein(piece, order)).collect());
        Self(Arc::new(Tables { knots, bernstein }))
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
        let rows = &self.tables.bernstein[self.order - 1][piece];
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
