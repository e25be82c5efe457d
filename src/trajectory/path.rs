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
    /// Phase polynomials in powers of `x = 2τ − 1`, one row a joint.
    phases: Vec<T>,
}

/// One joint's part of a path.
#[derive(Debug, Clone, Copy)]
pub struct JointPath<'a, T> {
    span: &'a Span,
    phase: &'a [T],
}

impl<'a, T: Scalar> Path<'a, T> {
    pub(super) fn new(spans: &'a [Span], phases: Vec<T>) -> Self {
        Self { spans, phases }
    }

    /// The joints' parts, from the base outward.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointPath<'_, T>> {
        let length = self.phases.len() / self.spans.len();
        let rows = self.phases.chunks_exact(length);
        self.spans.iter().zip(rows).map(|(span, phase)| JointPath { span, phase })
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
        let [s, s1] = derivatives(self.phase, tau);
        let (sin, cos) = s.simd_sin_cos();
        let amplitude = T::of(self.span.amplitude);
        (amplitude * sin + T::of(self.span.centre), amplitude * cos * s1)
    }

    /// Angle \[rad\] and its first four derivatives by `τ`: eqs. 11–14, eq. 13 with the square it
    /// lacks, and one more.
    pub fn derivatives(&self, tau: f64) -> [T; 5] {
        let [s, s1, s2, s3, s4] = derivatives(self.phase, tau);
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
        let mut theta = shape.map(|value| value * T::of(self.span.amplitude));
        theta[0] += T::of(self.span.centre);
        theta
    }
}

/// A polynomial in `x = 2τ − 1` and its first derivatives by `τ`, by Horner's rule.
fn derivatives<T: Scalar, const N: usize>(polynomial: &[T], tau: f64) -> [T; N] {
    let x = T::of(2.0 * tau - 1.0);
    let mut taylor = [T::zero(); N];
    for &coefficient in polynomial.iter().rev() {
        for k in (1..N).rev() {
            taylor[k] = taylor[k] * x + taylor[k - 1];
        }
        taylor[0] = taylor[0] * x + coefficient;
    }
    // The k-th derivative by τ is k! 2^k times the k-th Taylor coefficient in x.
    let mut scale = 1.0;
    for (k, value) in taylor.iter_mut().enumerate().skip(1) {
        scale *= 2.0 * k as f64;
        *value *= T::of(scale);
    }
    taylor
}
