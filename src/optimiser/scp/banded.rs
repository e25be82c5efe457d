//! Least squares with banded rows and a border of two columns.

use crate::search::LinearLimit;

/// The most variables in a row that a row of the matrix follows.
pub(super) const WIDTH: usize = LinearLimit::MOST;

/// Columns of the border.
pub(super) const BORDER: usize = 2;

/// A row: its entries from some column on, then those of the border.
pub(super) type Entries = [f64; WIDTH + BORDER];

/// The triangle `U` of an orthogonal factorisation, `Uᵀ U = Aᵀ A`, by Givens rotations row by row (George and Heath 1980,
/// doi:10.1016/0024-3795(80)90159-7). Unlike a factor of the product `Aᵀ A` it is as good as `A` itself.
#[derive(Debug, Clone)]
pub(super) struct Triangle {
    /// The entries of each row from its diagonal on, and those of the border.
    rows: Vec<Entries>,
    /// The most entries in a row before the border's.
    width: usize,
    corner: [[f64; BORDER]; BORDER],
}

impl Triangle {
    /// Of so many columns before the border's, for rows of so many entries before it.
    pub(super) fn zeros(size: usize, width: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH + BORDER]; size], width, corner: [[0.0; BORDER]; BORDER] }
    }

    pub(super) fn clear(&mut self) {
        self.rows.fill([0.0; WIDTH + BORDER]);
        self.corner = [[0.0; BORDER]; BORDER];
    }

    /// Adds a row of `A`, whose entries begin at column `first`; rows that begin earlier have to come before it.
    pub(super) fn absorb(&mut self, first: usize, mut row: Entries) {
        for own in self.rows[first..].iter_mut().take(self.width) {
            let (a, b) = (own[0], row[0]);
            if b != 0.0 {
                let inverse = 1.0 / (a * a + b * b).sqrt();
                let (c, s) = (a * inverse, b * inverse);
                for (own, row) in own.iter_mut().zip(&mut row) {
                    let turned = c * *own + s * *row;
                    *row = c * *row - s * *own;
                    *own = turned;
                }
            }
            row = [row[1], row[2], row[3], row[4], row[5], 0.0, row[6], row[7]];
        }
        self.absorb_border([row[WIDTH], row[WIDTH + 1]]);
    }

    /// Adds a row with entries in the border alone.
    pub(super) fn absorb_border(&mut self, [p, mut q]: [f64; BORDER]) {
        let [first, second] = &mut self.corner;
        if p != 0.0 {
            let length = (first[0] * first[0] + p * p).sqrt();
            let (c, s) = (first[0] / length, p / length);
            first[0] = length;
            (first[1], q) = (c * first[1] + s * q, c * q - s * first[1]);
        }
        if q != 0.0 {
            second[1] = (second[1] * second[1] + q * q).sqrt();
        }
    }

    /// Whether every diagonal entry is there.
    pub(super) fn is_regular(&self) -> bool {
        let mut all =
            self.rows.iter().map(|row| row[0]).chain((0..BORDER).map(|k| self.corner[k][k]));
        all.all(|entry| entry.is_finite() && entry != 0.0)
    }

    /// Solves `Uᵀ x = b` for several `b` at once, `count` numbers per row, the border's last.
    pub(super) fn solve_transposed(&self, b: &mut [f64], count: usize) {
        let n = self.rows.len();
        let (body, border) = b.split_at_mut(n * count);
        for (j, row) in self.rows.iter().enumerate() {
            let (own, below) = body[j * count..].split_at_mut(count);
            for x in &mut *own {
                *x /= row[0];
            }
            for (rows, factor) in below.chunks_exact_mut(count).zip(&row[1..WIDTH]) {
                for (entry, x) in rows.iter_mut().zip(&*own) {
                    *entry -= factor * x;
                }
            }
            for (rows, factor) in border.chunks_exact_mut(count).zip(&row[WIDTH..]) {
                for (entry, x) in rows.iter_mut().zip(&*own) {
                    *entry -= factor * x;
                }
            }
        }
        let (first, second) = border.split_at_mut(count);
        for (p, q) in first.iter_mut().zip(second) {
            *p /= self.corner[0][0];
            *q = (*q - self.corner[0][1] * *p) / self.corner[1][1];
        }
    }

    /// Solves `U x = b`.
    pub(super) fn solve(&self, b: &mut [f64]) {
        let n = self.rows.len();
        let (body, border) = b.split_at_mut(n);
        border[1] /= self.corner[1][1];
        border[0] = (border[0] - self.corner[0][1] * border[1]) / self.corner[0][0];
        for (j, row) in self.rows.iter().enumerate().rev() {
            let (own, below) = body[j..].split_at_mut(1);
            let mut left = own[0];
            for (x, factor) in below.iter().zip(&row[1..WIDTH]) {
                left -= factor * x;
            }
            for (x, factor) in border.iter().zip(&row[WIDTH..]) {
                left -= factor * x;
            }
            own[0] = left / row[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    /// `Uᵀ U = Aᵀ A`, and both triangular systems are solved, whatever rows there are.
    #[test]
    fn the_triangle_is_that_of_the_whole_matrix() {
        let (n, width) = (17, 4);
        let wave = |i: usize| f64::sin(1.7 * i as f64 + 0.2);
        let mut triangle = Triangle::zeros(n, width);
        let mut dense: Vec<DVector<f64>> = Vec::new();
        let mut absorb = |first: usize, row: Entries| {
            let mut all = DVector::zeros(n + BORDER);
            for (k, entry) in row[..WIDTH].iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
                all[first + k] = *entry;
            }
            for k in 0..BORDER {
                all[n + k] = row[WIDTH + k];
            }
            dense.push(all);
            triangle.absorb(first, row);
        };
        for i in 0..n {
            for j in 0..3 {
                let entry =
                    |k: usize| if k < width && i + k < n { wave(7 * i + 3 * j + k) } else { 0.0 };
                let mut row: Entries = std::array::from_fn(entry);
                row[WIDTH] = wave(i + j);
                row[WIDTH + 1] = if j == 1 { 0.3 * wave(i) } else { 0.0 };
                absorb(i, row);
            }
        }
        triangle.absorb_border([0.0, 0.7]);
        dense.push(DVector::from_fn(n + BORDER, |i, _| if i == n + 1 { 0.7 } else { 0.0 }));
        let a = DMatrix::from_columns(&dense).transpose();
        let product = a.tr_mul(&a);
        let b = DVector::from_fn(n + BORDER, |i, _| wave(5 * i));
        let mut x = b.clone();
        triangle.solve_transposed(x.as_mut_slice(), 1);
        triangle.solve(x.as_mut_slice());
        let miss = (&product * &x - &b).amax();
        assert!(miss < 1e-10 * product.amax() * x.amax(), "{miss}");
        // Two right-hand sides at once.
        let mut two: Vec<f64> = b.iter().flat_map(|b| [*b, 2.0 * b]).collect();
        let mut one = b.clone();
        triangle.solve_transposed(&mut two, 2);
        triangle.solve_transposed(one.as_mut_slice(), 1);
        for (pair, one) in two.chunks_exact(2).zip(one.iter()) {
            assert_eq!((pair[0], pair[1]), (*one, 2.0 * one));
        }
    }
}
