//! One path: every joint's angle and derivatives at any normalised time.

use crate::scalar::Scalar;

/// What a joint's range and end points say of its path.
#[derive(Debug, Clone)]
pub(super) struct Span {
    /// Half the range, `Δ_1` \[rad\].
    amplitude: f64,
    /// Middle of the range, `Δ_2` \[rad\].
    centre: f64,
    /// Phase at the start.
    pub(super) start_phase: f64,
    /// Phase at the goal less that at the start.
    pub(super) phase_change: f64,
}

impl Span {
    pub(super) fn new([lower, upper]: [f64; 2], start: f64, goal: f64) -> Self {
        let (amplitude, centre) = ((upper - lower) / 2.0, f64::midpoint(upper, lower));
        // The clamp only takes off rounding of an end point that lies on the edge of its range.
        let phase = |angle: f64| ((angle - centre) / amplitude).clamp(-1.0, 1.0).asin();
        let start_phase = phase(start);
        Self { amplitude, centre, start_phase, phase_change: phase(goal) - start_phase }
    }
}

/// One path of a family: its shape, free of timing.
#[derive(Debug, Clone)]
pub struct Path<'a, T> {
    spans: &'a [Span],
    /// The polynomials of the free part in powers of `x = 2τ − 1`, one row a joint.
    free: Vec<T>,
}

/// One joint's part of a path.
#[derive(Debug, Clone, Copy)]
pub struct JointPath<'a, T> {
    span: &'a Span,
    free: &'a [T],
}

impl<'a, T: Scalar> Path<'a, T> {
    pub(super) fn new(spans: &'a [Span], free: Vec<T>) -> Self {
        Self { spans, free }
    }

    /// The joints' parts, from the base outward.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointPath<'_, T>> {
        let rows = self.free.chunks_exact(self.free.len() / self.spans.len());
        self.spans.iter().zip(rows).map(|(span, free)| JointPath { span, free })
    }

    /// One joint's part.
    ///
    /// # Panics
    ///
    /// Panics when there is no such joint.
    pub fn joint(&self, index: usize) -> JointPath<'_, T> {
        let terms = self.free.len() / self.spans.len();
        let free = &self.free[index * terms..(index + 1) * terms];
        JointPath { span: &self.spans[index], free }
    }

    /// Writes every joint's angle \[rad\] and its derivative by `τ` \[rad\].
    pub fn angles_and_rates(&self, tau: f64, angles: &mut [T], rates: &mut [T]) {
        for ((angle, rate), joint) in angles.iter_mut().zip(rates).zip(self.joints()) {
            (*angle, *rate) = joint.angle_and_rate(tau);
        }
    }
}

impl<T: Scalar> JointPath<'_, T> {
    /// Angle \[rad\] and its derivative by `τ` (eqs. 11 and 12).
    pub fn angle_and_rate(&self, tau: f64) -> (T, T) {
        let [s, s1] = phase(self.span, self.free, tau);
        let (sin, cos) = s.simd_sin_cos();
        let amplitude = T::of(self.span.amplitude);
        (amplitude * sin + T::of(self.span.centre), amplitude * cos * s1 * T::of(2.0))
    }

    /// Angle \[rad\] and its first four derivatives by `τ`: eqs. 11–14, eq. 13 with the square it
    /// lacks, and one more.
    pub fn derivatives(&self, tau: f64) -> [T; 5] {
        let [s, s1, s2, s3, s4] = phase(self.span, self.free, tau);
        let (sin, cos) = s.simd_sin_cos();
        let [three, four, six] = [3.0, 4.0, 6.0].map(T::of);
        let square = s1 * s1;
        let shape = [
            sin,
            cos * s1,
            cos * s2 - sin * square,
            cos * (s3 - square * s1) - sin * three * s1 * s2,
            cos * (s4 - six * square * s2)
                + sin * (square * square - three * s2 * s2 - four * s1 * s3),
        ];
        // Each derivative by τ is twice that by x.
        let mut scale = self.span.amplitude;
        let mut theta = shape.map(|value| {
            let scaled = value * T::of(scale);
            scale *= 2.0;
            scaled
        });
        theta[0] += T::of(self.span.centre);
        theta
    }
}

/// Phase and its first derivatives by `x = 2τ − 1`: the step `σ` scaled to the phase's change, and
/// the window `(1 − x²)³` times the polynomial of the free part.
///
/// Written in `u = 1 − x²`, so that what vanishes at both ends vanishes exactly.
fn phase<T: Scalar, const N: usize>(span: &Span, free: &[T], tau: f64) -> [T; N] {
    let x = 2.0 * tau - 1.0;
    let (u, xx) = (1.0 - x * x, x * x);
    let step = [
        0.5 + x * (15.0 - xx * (10.0 - 3.0 * xx)) / 16.0,
        15.0 / 16.0 * u * u,
        15.0 / 16.0 * (-4.0 * x * u),
        15.0 / 16.0 * (12.0 * xx - 4.0),
        15.0 / 16.0 * (24.0 * x),
    ];
    let window = [
        u * u * u,
        -6.0 * x * u * u,
        (24.0 * xx - 6.0 * u) * u,
        (72.0 * u - 48.0 * xx) * x,
        72.0 * u - 288.0 * xx,
    ];
    let free: [T; N] = polynomial(free, T::of(x));
    let mut phase = [T::zero(); N];
    for n in 0..N {
        let start = if n == 0 { span.start_phase } else { 0.0 };
        phase[n] = T::of(start + span.phase_change * step[n]);
        // Leibniz's rule.
        for k in 0..=n {
            phase[n] += free[k] * T::of(BINOMIAL[n][k] * window[n - k]);
        }
    }
    phase
}

/// Binomial coefficients.
const BINOMIAL: [[f64; 5]; 5] = [
    [1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0],
];

/// A polynomial, lowest power first, and its first derivatives by Horner's rule.
fn polynomial<T: Scalar, const N: usize>(coefficients: &[T], x: T) -> [T; N] {
    let mut taylor = [T::zero(); N];
    for &coefficient in coefficients.iter().rev() {
        for k in (1..N).rev() {
            taylor[k] = taylor[k] * x + taylor[k - 1];
        }
        taylor[0] = taylor[0] * x + coefficient;
    }
    let mut factorial = 1.0;
    for (k, value) in taylor.iter_mut().enumerate().skip(2) {
        factorial *= k as f64;
        *value *= T::of(factorial);
    }
    taylor
}
