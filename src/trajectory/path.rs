//! One path: every joint's angle and derivatives at any normalised time.

use super::basis::Basis;
use super::family::AtPhase;
use super::window::{BINOMIAL, ORDERS, leibniz, step, windowed};
use crate::robot::Follow;
use crate::scalar::Scalar;

/// What a joint's range and end points say of its path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    /// Half the range, `Δ_1` \[rad\]; negative where the joint follows another one the other way.
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

    /// That of a joint which follows this one's.
    pub(super) fn followed(&self, follow: &Follow) -> Self {
        Self {
            amplitude: follow.multiplier * self.amplitude,
            centre: follow.position(self.centre),
            ..*self
        }
    }
}

/// One path of a family: its shape, free of timing.
#[derive(Debug, Clone)]
pub struct Path<'a> {
    spans: &'a [Span],
    basis: &'a Basis,
    /// The polynomials of the free part in powers of `x = 2τ − 1`, one row per joint.
    free: Vec<f64>,
}

/// One joint's part of a path.
#[derive(Debug, Clone, Copy)]
pub struct JointPath<'a> {
    span: &'a Span,
    basis: &'a Basis,
    free: &'a [f64],
}

impl<'a> Path<'a> {
    pub(super) fn new(spans: &'a [Span], basis: &'a Basis, free: Vec<f64>) -> Self {
        Self { spans, basis, free }
    }

    /// The joints' parts, from the base outward.
    pub fn joints(&self) -> impl ExactSizeIterator<Item = JointPath<'_>> {
        let rows = self.free.chunks_exact(self.basis.terms());
        self.spans.iter().zip(rows).map(|(span, free)| JointPath { span, basis: self.basis, free })
    }

    /// One joint's part.
    ///
    /// # Panics
    ///
    /// Panics when there is no such joint.
    pub fn joint(&self, index: usize) -> JointPath<'_> {
        let terms = self.basis.terms();
        let free = &self.free[index * terms..(index + 1) * terms];
        JointPath { span: &self.spans[index], basis: self.basis, free }
    }

    /// Free coefficients in all.
    pub fn dimension(&self) -> usize {
        self.free.len()
    }

    /// The bumps that a path's coefficients multiply.
    pub fn basis(&self) -> &'a Basis {
        self.basis
    }

    /// Writes every joint's angle \[rad\] and its derivative by `τ` \[rad\].
    pub fn angles_and_rates(&self, tau: f64, angles: &mut [f64], rates: &mut [f64]) {
        for ((angle, rate), joint) in angles.iter_mut().zip(rates).zip(self.joints()) {
            let at = joint.span.at_phase(phase(joint.span, joint.free, tau));
            (*angle, *rate) = (at.angle, at.rate);
        }
    }
}

impl Span {
    /// Angle \[rad\] and its derivative by `τ` at a phase with its derivative (eqs. 11 and 12), and
    /// how they follow the phase.
    #[inline(always)]
    pub(super) fn at_phase<T: Scalar>(&self, [s, s1]: [T; 2]) -> AtPhase<T> {
        let (sin, cos) = s.sin_cos();
        let amplitude = T::of(self.amplitude);
        let angle_slope = amplitude * cos;
        AtPhase {
            angle: amplitude.mul_add(sin, T::of(self.centre)),
            rate: angle_slope * s1,
            angle_slope,
            rate_slope: -(amplitude * sin * s1),
        }
    }

    /// Rate, acceleration, jerk and one derivative more, by `τ`, where the phase has these derivatives:
    /// eqs. 12–14, eq. 13 with the square it lacks.
    #[inline(always)]
    pub(super) fn rates<T: Scalar>(&self, [s, s1, s2, s3, s4]: [T; 5]) -> [T; 4] {
        let (sin, cos) = s.sin_cos();
        let amplitude = T::of(self.amplitude);
        let (sin, cos) = (amplitude * sin, amplitude * cos);
        let square = s1 * s1;
        let twist = s1 * s2;
        let thrice = twist + twist + twist;
        let (four, six) = (T::of(4.0), T::of(6.0));
        let bend = s2 * s2;
        let odd = square.mul_sub_from(s1, s3);
        let even = (square * s2).mul_sub_from(six, s4);
        let other = square.mul_sub_from(square, four.mul_add(s1 * s3, bend + bend + bend));
        [
            cos * s1,
            sin.mul_sub_from(square, cos * s2),
            sin.mul_sub_from(thrice, cos * odd),
            sin.mul_sub_from(other, cos * even),
        ]
    }
}

impl<'a> JointPath<'a> {
    pub(super) fn new(span: &'a Span, basis: &'a Basis, free: &'a [f64]) -> Self {
        Self { span, basis, free }
    }

    /// Rate, acceleration, jerk and one derivative more \[rad\], by `τ`.
    pub fn rates(&self, tau: f64) -> [f64; 4] {
        self.span.rates(phase(self.span, self.free, tau))
    }

    /// Angle \[rad\] and its first derivatives by `τ`, at most five: eqs. 11–14, eq. 13 with the square
    /// it lacks, and two more.
    pub fn derivatives<const N: usize>(&self, tau: f64) -> [f64; N] {
        let mut theta = self.sine(tau).0.map(|value| self.span.amplitude * value);
        theta[0] += self.span.centre;
        theta
    }

    /// Derivative of the `order`-th derivative of the angle by each of the joint's coefficients.
    pub fn coefficient_slopes(
        &self,
        order: usize,
        tau: f64,
    ) -> impl Iterator<Item = f64> + use<'a> {
        let (_, cos) = self.sine::<ORDERS>(tau);
        let amplitude = self.span.amplitude;
        let bumps = self.basis.bumps::<ORDERS>(tau);
        bumps.map(move |bump| amplitude * leibniz(order, &cos, &bump))
    }

    /// Second derivative of the `order`-th derivative of the angle by any two of the joint's
    /// coefficients.
    pub fn coefficient_curvature(
        &self,
        order: usize,
        tau: f64,
    ) -> impl Fn(usize, usize) -> f64 + use<'a> {
        let (sin, _) = self.sine::<ORDERS>(tau);
        let bumps: Vec<_> = self.basis.bumps::<ORDERS>(tau).collect();
        let amplitude = self.span.amplitude;
        move |k, l| {
            let product: [f64; ORDERS] = std::array::from_fn(|n| leibniz(n, &bumps[k], &bumps[l]));
            -amplitude * leibniz(order, &sin, &product)
        }
    }

    /// Sine and cosine of the phase and their first derivatives by `τ`.
    fn sine<const N: usize>(&self, tau: f64) -> ([f64; N], [f64; N]) {
        let s: [f64; N] = phase(self.span, self.free, tau);
        let (mut sin, mut cos) = ([0.0; N], [0.0; N]);
        (sin[0], cos[0]) = Scalar::sin_cos(s[0]);
        for n in 1..N {
            // `cos s · s'` and `−sin s · s'`
            for k in 0..n {
                let slope = s[n - k] * BINOMIAL[n - 1][k];
                sin[n] += cos[k] * slope;
                cos[n] -= sin[k] * slope;
            }
        }
        (sin, cos)
    }
}

/// Phase and its first derivatives by `τ` (eq. 24): the step `σ` scaled to the phase's change, and the window
/// `(1 − x²)³` times the polynomial of the free part, `x = 2τ − 1`.
fn phase<const N: usize>(span: &Span, free: &[f64], tau: f64) -> [f64; N] {
    let step: [f64; N] = step(tau);
    let mut phase = windowed(free, tau);
    for n in 0..N {
        let start = if n == 0 { span.start_phase } else { 0.0 };
        phase[n] += start + span.phase_change * step[n];
    }
    phase
}
