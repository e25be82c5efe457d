//! The free part of the phase: bumps that leave both ends untouched to the second derivative.

use nalgebra::{DMatrix, DVector};

use super::window::windowed;

/// The bumps `64 τ³(1 − τ)³ P_k(x) = (1 − x²)³ P_k(x)`, `x = 2τ − 1`, with `P_k` orthonormal for the weight `(1 − x²)⁶` and `P_0 = 1`:
/// Gegenbauer polynomials with λ = 13/2. A unit of any coefficient moves the phase equally far in
/// the mean square, whatever its `k`.
#[derive(Debug, Clone)]
pub struct Basis {
    /// `P_0`, `P_1`, … in powers of `x`.
    polynomials: Vec<Vec<f64>>,
    /// From coefficients to the paper's `A_j = α_j t_f^j`, `j = 6, 7, …`.
    to_powers: DMatrix<f64>,
    /// And back.
    from_powers: DMatrix<f64>,
}

impl Basis {
    /// The first `terms` bumps; two span the paper's family.
    pub fn new(terms: usize) -> Self {
        let polynomials = orthonormal(terms);
        let mut to_powers = DMatrix::zeros(terms, terms);
        for (k, polynomial) in polynomials.iter().enumerate() {
            to_powers.set_column(k, &highest_powers(polynomial, terms));
        }
        let from_powers = inverse(&to_powers);
        Self { polynomials, to_powers, from_powers }
    }

    /// Number of bumps, which is the number of free coefficients a joint.
    pub fn terms(&self) -> usize {
        self.polynomials.len()
    }

    /// `P_0`, `P_1`, … in powers of `x`, lowest first.
    pub fn polynomials(&self) -> &[Vec<f64>] {
        &self.polynomials
    }

    /// A bump and its first derivatives by `τ`, at most five.
    pub fn bump<const N: usize>(&self, k: usize, tau: f64) -> [f64; N] {
        windowed(&self.polynomials[k], tau)
    }

    /// All bumps, each with its first derivatives by `τ`.
    pub fn bumps<const N: usize>(&self, tau: f64) -> impl Iterator<Item = [f64; N]> {
        (0..self.terms()).map(move |k| self.bump(k, tau))
    }

    /// Writes the sum of the bumps' polynomials, each times its coefficient, in powers of `x`.
    pub(super) fn gather(&self, coefficients: &[f64], powers: &mut [f64]) {
        powers.fill(0.0);
        for (polynomial, coefficient) in self.polynomials.iter().zip(coefficients) {
            for (power, p) in powers.iter_mut().zip(polynomial) {
                *power += coefficient * p;
            }
        }
    }

    /// Adds the coefficients that make `A` of the power `6 + k`.
    pub(super) fn add_power(&self, k: usize, a: f64, coefficients: &mut [f64]) {
        for (coefficient, from) in coefficients.iter_mut().zip(self.from_powers.column(k).iter()) {
            *coefficient += from * a;
        }
    }

    /// One joint's `A_6, A_7, …` from its coefficients.
    pub fn to_powers(&self, coefficients: &[f64]) -> Vec<f64> {
        apply(&self.to_powers, coefficients)
    }

    /// One joint's coefficients from its `A_6, A_7, …`.
    ///
    /// Powers of `τ` are nearly parallel: every further term costs about a digit and a half.
    pub fn from_powers(&self, powers: &[f64]) -> Vec<f64> {
        apply(&self.from_powers, powers)
    }
}

fn apply(matrix: &DMatrix<f64>, v: &[f64]) -> Vec<f64> {
    (matrix * DVector::from_column_slice(v)).as_slice().to_vec()
}

/// The orthonormal Gegenbauer polynomials in powers of `x`, by their three-term recurrence
/// `x P_k = a_{k+1} P_{k+1} + a_k P_{k−1}`.
fn orthonormal(terms: usize) -> Vec<Vec<f64>> {
    const LAMBDA: f64 = 6.5;
    let a = |k: usize| {
        let k = k as f64;
        (k * (k + 2.0 * LAMBDA - 1.0) / (4.0 * (k + LAMBDA) * (k + LAMBDA - 1.0))).sqrt()
    };
    let mut polynomials = vec![vec![1.0]];
    for k in 1..terms {
        let mut next = product(&[0.0, 1.0], &polynomials[k - 1]);
        if k >= 2 {
            for (n, p) in next.iter_mut().zip(&polynomials[k - 2]) {
                *n -= a(k - 1) * p;
            }
        }
        for n in &mut next {
            *n /= a(k);
        }
        polynomials.push(next);
    }
    polynomials
}

/// The product of two polynomials.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            result[i + j] += x * y;
        }
    }
    result
}

/// Coefficients of `τ⁶, τ⁷, …` in `64 τ³(1 − τ)³ p(2τ − 1)`.
fn highest_powers(p: &[f64], terms: usize) -> DVector<f64> {
    // p(2τ − 1) by Horner's rule on polynomials in τ.
    let shifted = p.iter().rev().fold(vec![0.0], |sum, &c| {
        let mut next = product(&sum, &[-1.0, 2.0]);
        next[0] += c;
        next
    });
    let bump = product(&[0.0, 0.0, 0.0, 64.0, -192.0, 192.0, -64.0], &shifted);
    DVector::from_fn(terms, |j, _| bump.get(j + 6).copied().unwrap_or(0.0))
}

/// Inverse of the change to powers, triangular after the order of its rows is turned round.
#[expect(clippy::expect_used, reason = "every bump has its own highest power")]
fn inverse(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix.clone().full_piv_lu().try_inverse().expect("the bumps are independent")
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELLS: u32 = 2000;

    /// The integral of `τ⁶(1−τ)⁶ P_j P_k` vanishes off the diagonal: Simpson's rule, independent of
    /// the recurrence.
    #[test]
    fn is_orthonormal() {
        let polynomials = orthonormal(6);
        let value = |p: &[f64], x: f64| p.iter().rev().fold(0.0, |s, c| s * x + c);
        let inner = |a: &[f64], b: &[f64]| -> f64 {
            let f = |x: f64| (1.0 - x * x).powi(6) * value(a, x) * value(b, x);
            let half = 1.0 / f64::from(CELLS);
            let middles = (0..CELLS).map(|i| (2.0 * f64::from(i) + 1.0) * half - 1.0);
            let simpson = |x: f64| (f(x - half) + 4.0 * f(x) + f(x + half)) * half / 3.0;
            middles.map(simpson).sum()
        };
        let unit = inner(&[1.0], &[1.0]);
        for (j, a) in polynomials.iter().enumerate() {
            for (k, b) in polynomials.iter().enumerate() {
                let expected = if j == k { unit } else { 0.0 };
                assert!((inner(a, b) - expected).abs() < 1e-12 * unit, "{j} {k}");
            }
        }
    }

    #[test]
    fn powers_and_coefficients_are_inverse() {
        for terms in 1..=6 {
            let basis = Basis::new(terms);
            let c: Vec<f64> = (0..terms).map(|k| ((k * 37 % 11) as f64 - 5.0) / 7.0).collect();
            for (a, b) in basis.from_powers(&basis.to_powers(&c)).iter().zip(&c) {
                assert!((a - b).abs() < 1e-9, "{terms} terms: {a} {b}");
            }
        }
    }

    /// Eq. 24's free part is `−τ³(1−τ)³ [A6 + A7(τ + 3)]`.
    #[test]
    fn two_terms_are_the_papers() {
        let basis = Basis::new(2);
        let (a6, a7) = (1.7, -0.6);
        let c = basis.from_powers(&[a6, a7]);
        for tau in [0.1_f64, 0.35, 0.5, 0.8] {
            let expected = -(tau * (1.0 - tau)).powi(3) * (a6 + a7 * (tau + 3.0));
            let x = 2.0 * tau - 1.0;
            let value = |p: &[f64]| p.iter().rev().fold(0.0, |s, c| s * x + c);
            let sum: f64 = basis.polynomials().iter().zip(&c).map(|(p, c)| c * value(p)).sum();
            let found = (1.0 - x * x).powi(3) * sum;
            assert!((found - expected).abs() < 1e-15, "{tau}: {found} {expected}");
        }
    }
}
