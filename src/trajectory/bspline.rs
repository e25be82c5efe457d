//! Splines of one degree over equal pieces, clamped at both ends.

/// The knots of splines of one degree with equal pieces over `[0, 1]`.
///
/// A spline is `Σ_i C_i B_i(τ)` with one control point per basis function, pieces and degree in number
/// (de Boor 2001, doi:10.1007/978-1-4612-6333-3, chapter IX). The first and last knots are repeated, so the
/// first control point is the value at the start and the last that at the end.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    pieces: usize,
    degree: usize,
}

/// The highest degree.
pub(super) const MOST_DEGREE: usize = 5;

/// A number for each basis function that is not zero on one piece.
type Local = [f64; MOST_DEGREE + 1];

impl Knots {
    /// Of so many pieces and of this degree.
    ///
    /// # Panics
    ///
    /// Panics without a piece, or of a degree that is not 1 to [`MOST_DEGREE`].
    pub fn new(pieces: usize, degree: usize) -> Self {
        assert!(pieces > 0 && (1..=MOST_DEGREE).contains(&degree), "pieces and a degree");
        Self { pieces, degree }
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.pieces
    }

    /// Degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of control points.
    pub fn points(&self) -> usize {
        self.pieces + self.degree
    }

    /// The place of a knot, counted with those that are repeated.
    fn knot(&self, i: usize) -> f64 {
        i.saturating_sub(self.degree).min(self.pieces) as f64 / self.pieces as f64
    }

    /// The mean of the knots that a control point sees, where it belongs (Greville's abscissa).
    pub fn place_of(&self, point: usize) -> f64 {
        let seen = (1..=self.degree).map(|k| self.knot(point + k));
        seen.sum::<f64>() / self.degree as f64
    }

    /// The piece that a time lies in; the right one of two, but for the end.
    pub fn piece_at(&self, tau: f64) -> usize {
        ((tau * self.pieces as f64) as usize).min(self.pieces - 1)
    }

    /// Makes the control points of a spline those of its derivative of the `order`-th from those of the one
    /// before.
    pub fn differentiate(&self, points: &[f64], order: usize, derivative: &mut [f64]) {
        for (i, (own, pair)) in derivative.iter_mut().zip(points.windows(2)).enumerate() {
            *own = (pair[1] - pair[0]) * self.quotient(i, order);
        }
    }

    /// What the difference of control points `i` and `i + 1` of the derivative before is multiplied by.
    fn quotient(&self, i: usize, order: usize) -> f64 {
        let degree = self.degree + 1 - order;
        degree as f64 / (self.knot(i + self.degree + 1) - self.knot(i + order))
    }

    /// On one piece, the values at `args` of the multi-affine form of the `order`-th derivative whose control
    /// points are `points`: one argument per degree, all equal for the derivative's own value (Ramshaw 1989,
    /// doi:10.1016/0167-8396(89)90032-0).
    fn blossom(&self, piece: usize, order: usize, mut points: Local, args: &[f64]) -> f64 {
        let degree = self.degree - order;
        for r in 1..=degree {
            for i in 0..=degree - r {
                let [low, high] =
                    [self.knot(piece + order + r + i), self.knot(piece + order + degree + 1 + i)];
                let share = (args[r - 1] - low) / (high - low);
                points[i] += share * (points[i + 1] - points[i]);
            }
        }
        points[0]
    }

    /// Makes the control points of a spline those of the same one with every piece split into two.
    pub fn split(&self, points: &[f64]) -> Vec<f64> {
        let fine = Self { pieces: 2 * self.pieces, degree: self.degree };
        let point = |i: usize| {
            // Any piece that the point's basis function is not zero on serves.
            let piece = i.saturating_sub(self.degree / 2).min(fine.pieces - 1) / 2;
            let mut own = Local::default();
            own[..=self.degree].copy_from_slice(&points[piece..=piece + self.degree]);
            let knots: [f64; MOST_DEGREE] = std::array::from_fn(|r| fine.knot(i + 1 + r));
            self.blossom(piece, 0, own, &knots)
        };
        (0..fine.points()).map(point).collect()
    }

    /// On one piece, the Bernstein coefficients of each basis function of the `order`-th derivative's own
    /// degree: `bernstein[j][i]` is the `j`-th of function `i`.
    pub fn bernstein(&self, piece: usize, order: usize) -> [Local; MOST_DEGREE + 1] {
        let degree = self.degree - order;
        let [start, end] = [piece, piece + 1].map(|i| i as f64 / self.pieces as f64);
        let mut all = [Local::default(); MOST_DEGREE + 1];
        for (j, coefficients) in all.iter_mut().enumerate().take(degree + 1) {
            let args: [f64; MOST_DEGREE] =
                std::array::from_fn(|r| if r < degree - j { start } else { end });
            for (i, coefficient) in coefficients.iter_mut().enumerate().take(degree + 1) {
                let mut unit = Local::default();
                unit[i] = 1.0;
                *coefficient = self.blossom(piece, order, unit, &args);
            }
        }
        all
    }

    /// The values at a time of one piece of the basis functions of every degree up to the spline's own that are not zero there:
    /// `functions[q]` of degree `q`, one more than `q` in number (the Cox–de Boor recurrence, de Boor 2001, chapter X).
    fn functions(&self, piece: usize, tau: f64) -> [Local; MOST_DEGREE + 1] {
        let first = piece + self.degree;
        let mut all = [Local::default(); MOST_DEGREE + 1];
        all[0][0] = 1.0;
        for q in 1..=self.degree {
            for r in 0..q {
                let [low, high] = [self.knot(first + 1 + r - q), self.knot(first + 1 + r)];
                let share = all[q - 1][r] / (high - low);
                all[q][r] += (high - tau) * share;
                all[q][r + 1] = (tau - low) * share;
            }
        }
        all
    }

    /// The value and derivatives at a time of one piece of the spline with these control points there. A `k`-th derivative is a
    /// spline of a degree lower by `k`, whose control points are differences.
    fn values<const N: usize>(
        &self,
        piece: usize,
        functions: &[Local; MOST_DEGREE + 1],
        mut points: Local,
    ) -> [f64; N] {
        let mut values = [0.0; N];
        for (order, value) in values.iter_mut().enumerate().take(self.degree + 1) {
            let degree = self.degree - order;
            if order > 0 {
                for k in 0..=degree {
                    points[k] = (points[k + 1] - points[k]) * self.quotient(piece + k, order);
                }
            }
            let terms = points.iter().zip(&functions[degree]).take(degree + 1);
            *value = terms.map(|(point, function)| point * function).sum();
        }
        values
    }

    /// The derivatives by `τ`, from the value on, of the basis functions that are not zero at a time: those
    /// from the piece's own number on, one more than the degree.
    pub fn bumps<const N: usize>(&self, tau: f64) -> (usize, [[f64; N]; MOST_DEGREE + 1]) {
        let piece = self.piece_at(tau);
        let functions = self.functions(piece, tau);
        let mut bumps = [[0.0; N]; MOST_DEGREE + 1];
        for (i, bump) in bumps.iter_mut().enumerate().take(self.degree + 1) {
            let mut points = Local::default();
            points[i] = 1.0;
            *bump = self.values(piece, &functions, points);
        }
        (piece, bumps)
    }

    /// The value and derivatives at a time of the spline with these control points.
    pub fn derivatives<const N: usize>(&self, points: &[f64], tau: f64) -> [f64; N] {
        let piece = self.piece_at(tau);
        let mut own = Local::default();
        own[..=self.degree].copy_from_slice(&points[piece..=piece + self.degree]);
        self.values(piece, &self.functions(piece, tau), own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> impl Iterator<Item = Knots> {
        [3, 4, 5]
            .into_iter()
            .flat_map(|degree| [1, 2, 5, 8].map(|pieces| Knots::new(pieces, degree)))
    }

    /// Marsden's identity: with control points `Π_k (t_{i+k} − y)` the spline is `(τ − y)^p`.
    #[test]
    fn powers_are_reproduced_with_their_derivatives() {
        for knots in all() {
            for y in [-0.3, 0.4, 1.2] {
                let degree = knots.degree();
                let point = |i: usize| (1..=degree).map(|k| knots.knot(i + k) - y).product();
                let points: Vec<f64> = (0..knots.points()).map(point).collect();
                for tau in [0.0, 0.1, 0.2, 0.37, 0.5, 0.875, 1.0] {
                    let found = knots.derivatives::<6>(&points, tau);
                    let mut factor = 1.0;
                    for (order, found) in found.iter().enumerate().take(degree + 1) {
                        let expected = factor * f64::powi(tau - y, (degree - order) as i32);
                        // Each difference multiplies rounding errors by so much.
                        let grown = f64::powi((2 * degree * knots.pieces()) as f64, order as i32);
                        let miss = (found - expected).abs();
                        assert!(miss < 1e-14 * grown, "{knots:?} {tau} {order}: {miss}");
                        factor *= (degree - order) as f64;
                    }
                }
            }
        }
    }

    /// A spline has one continuous derivative fewer than its degree, and its ends are its outer control points.
    #[test]
    fn derivatives_below_the_degree_are_continuous() {
        for knots in all().filter(|knots| knots.pieces() > 1) {
            let (degree, count) = (knots.degree(), knots.points());
            let points: Vec<f64> = (0..count).map(|i| f64::sin(7.3 * i as f64)).collect();
            for knot in 1..knots.pieces() {
                let tau = knot as f64 / knots.pieces() as f64;
                let [before, after] =
                    [tau - 1e-9, tau + 1e-9].map(|tau| knots.derivatives::<6>(&points, tau));
                let jump = |order: usize| (after[order] - before[order]).abs();
                let size = |order: usize| 1.0 + before[order].abs() + after[order].abs();
                for order in 0..degree {
                    assert!(jump(order) < 1e-5 * size(order), "{knots:?} at {tau}: {order}");
                }
                assert!(jump(degree) > 1e-3 * size(degree), "{knots:?} at {tau}");
            }
            for (tau, end) in [(0.0, points[0]), (1.0, points[count - 1])] {
                assert!((knots.derivatives::<1>(&points, tau)[0] - end).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn control_points_of_derivatives_and_bernstein_coefficients_give_the_same_values() {
        for knots in all() {
            let points: Vec<f64> = (0..knots.points()).map(|i| f64::cos(3.1 * i as f64)).collect();
            let mut derivative = points.clone();
            for order in 1..=3 {
                let mut next = vec![0.0; derivative.len() - 1];
                knots.differentiate(&derivative, order, &mut next);
                derivative = next;
                for piece in 0..knots.pieces() {
                    let own = &derivative[piece..];
                    let rows = knots.bernstein(piece, order);
                    for (row, end) in [(0, 0.0), (knots.degree() - order, 1.0)] {
                        let found: f64 =
                            own.iter().zip(rows[row]).map(|(p, share)| p * share).sum();
                        let inside = (piece as f64 + 0.5 + (end - 0.5) * (1.0 - 1e-10))
                            / knots.pieces() as f64;
                        let expected = knots.derivatives::<6>(&points, inside)[order];
                        assert!((found - expected).abs() < 1e-5 * (1.0 + expected.abs()));
                    }
                }
            }
        }
    }
}
