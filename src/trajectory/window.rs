//! The phase's building blocks: a step, and a window that vanishes at both ends.

/// The step `σ` from 0 to 1 and its first derivatives by `τ`.
pub(super) fn step<const N: usize>(tau: f64) -> [f64; N] {
    let x = 2.0 * tau - 1.0;
    let (u, xx) = (1.0 - x * x, x * x);
    // Written in `u`, so that what vanishes at both ends vanishes exactly.
    let step = [
        0.5 + x * (15.0 - xx * (10.0 - 3.0 * xx)) / 16.0,
        15.0 / 16.0 * u * u,
        15.0 / 16.0 * (-4.0 * x * u),
        15.0 / 16.0 * (12.0 * xx - 4.0),
        15.0 / 16.0 * (24.0 * x),
        15.0 / 16.0 * 24.0,
    ];
    std::array::from_fn(|n| step[n] * by_tau(n))
}

/// What a derivative by `x = 2τ − 1` is multiplied with to be one by `τ`.
fn by_tau(order: usize) -> f64 {
    f64::from(1 << order)
}

/// Values and derivatives: the most there are of anything here.
pub(super) const ORDERS: usize = 6;

/// Binomial coefficients.
pub(super) const BINOMIAL: [[f64; ORDERS]; ORDERS] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
];

/// The `n`-th derivative of a product from those of its factors, by Leibniz's rule.
pub(super) fn leibniz(n: usize, a: &[f64], b: &[f64]) -> f64 {
    (0..=n).map(|k| a[k] * b[n - k] * BINOMIAL[n][k]).sum()
}

/// The window `(1 − x²)³` times a polynomial in `x = 2τ − 1`, lowest power first, and first derivatives
/// by `τ`.
pub(super) fn windowed<const N: usize>(polynomial: &[f64], tau: f64) -> [f64; N] {
    let x = 2.0 * tau - 1.0;
    let (u, xx) = (1.0 - x * x, x * x);
    let window = [
        u * u * u,
        -6.0 * x * u * u,
        (24.0 * xx - 6.0 * u) * u,
        (72.0 * u - 48.0 * xx) * x,
        72.0 * u - 288.0 * xx,
        -720.0 * x,
    ];
    let factor: [f64; N] = taylor(polynomial, x);
    std::array::from_fn(|n| leibniz(n, &factor, &window) * by_tau(n))
}

/// A polynomial, lowest power first, and its first derivatives by Horner's rule.
fn taylor<const N: usize>(coefficients: &[f64], x: f64) -> [f64; N] {
    let mut taylor = [0.0; N];
    for &coefficient in coefficients.iter().rev() {
        for k in (1..N).rev() {
            taylor[k] = taylor[k] * x + taylor[k - 1];
        }
        taylor[0] = taylor[0] * x + coefficient;
    }
    let mut factorial = 1.0;
    for (k, value) in taylor.iter_mut().enumerate().skip(2) {
        factorial *= k as f64;
        *value *= factorial;
    }
    taylor
}
