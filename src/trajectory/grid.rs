//! A family's phases at fixed times, in lanes.

use super::family::AtPhase;
use super::sine::SinePolynomial;
use super::window::step;
use crate::lanes::{Block, Lanes, MOST};
use crate::scalar::{Pair, Scalar};

/// Step and bumps of a family at fixed times, with their first `N − 1` derivatives by `τ`: all of a phase
/// that coefficients do not change, tabulated once.
#[derive(Debug, Clone)]
pub struct Grid<const N: usize> {
    /// Blocks for each [`MOST`] times: `N` for the step, then `N` for every bump.
    rows: usize,
    table: Vec<Block>,
}

impl<const N: usize> Grid<N> {
    /// At these times; filled up with the path's start to a number that pairs of lanes divide.
    pub(crate) fn new(family: &SinePolynomial, times: impl IntoIterator<Item = f64>) -> Self {
        let mut times: Vec<f64> = times.into_iter().collect();
        times.resize(times.len().next_multiple_of(2 * MOST), 0.0);
        let rows = N * (family.terms() + 1);
        let mut table = vec![Block::default(); times.len() / MOST * rows];
        for (t, &tau) in times.iter().enumerate() {
            let parts = std::iter::once(step(tau)).chain(family.basis().bumps(tau));
            for (row, value) in parts.flat_map(|part: [f64; N]| part).enumerate() {
                table[t / MOST * rows + row].0[t % MOST] = value;
            }
        }
        Self { rows, table }
    }

    /// The number of times, those it was filled up with among them.
    pub(crate) fn times(&self) -> usize {
        self.table.len() / self.rows * MOST
    }

    /// `N` blocks for each part from time `first` on.
    #[inline(always)]
    fn parts(&self, first: usize) -> std::slice::ChunksExact<'_, Block> {
        self.table[first / MOST * self.rows..].chunks_exact(N)
    }

    /// What bump `k` and its derivatives are from time `first` on, one time a lane.
    #[inline(always)]
    pub(crate) fn bump<T: Lanes>(&self, k: usize, first: usize) -> [T; N] {
        let row = first / MOST * self.rows + (k + 1) * N;
        load(&self.table[row..row + N], first)
    }
}

#[inline(always)]
fn load<T: Lanes, const N: usize>(blocks: &[Block], first: usize) -> [T; N] {
    let mut numbers = [T::of(0.0); N];
    for (number, block) in numbers.iter_mut().zip(blocks) {
        *number = T::load(&block.0[first % MOST..]);
    }
    numbers
}

impl SinePolynomial {
    /// One joint's phase and its derivatives from time `first` on, for the joint's coefficients.
    #[inline(always)]
    pub(crate) fn phase<T: Lanes, const N: usize>(
        &self,
        grid: &Grid<N>,
        first: usize,
        joint: usize,
        coefficients: &[f64],
    ) -> [T; N] {
        let span = &self.spans()[joint];
        let mut parts = grid.parts(first);
        let mut phase = [T::of(0.0); N];
        if let Some(step) = parts.next() {
            phase = load::<T, N>(step, first);
        }
        for part in &mut phase {
            *part = *part * T::of(span.phase_change);
        }
        phase[0] += T::of(span.start_phase);
        for (&coefficient, bump) in coefficients.iter().zip(parts) {
            let bump = load::<T, N>(bump, first);
            for n in 0..N {
                phase[n] = bump[n].mul_add(T::of(coefficient), phase[n]);
            }
        }
        phase
    }

    /// The same at two places at once.
    #[inline(always)]
    pub(crate) fn phases<T: Lanes, const N: usize>(
        &self,
        grid: &Grid<N>,
        [near, far]: [usize; 2],
        joint: usize,
        coefficients: &[f64],
    ) -> [Pair<T>; N] {
        let near = self.phase::<T, N>(grid, near, joint, coefficients);
        let far = self.phase::<T, N>(grid, far, joint, coefficients);
        let mut phases = [Pair::of(0.0); N];
        for n in 0..N {
            phases[n] = Pair(near[n], far[n]);
        }
        phases
    }

    /// A joint's angle and rate at a phase with its derivative, and how they follow it.
    #[inline(always)]
    pub(crate) fn at_phase<T: Scalar>(&self, joint: usize, phase: [T; 2]) -> AtPhase<T> {
        self.spans()[joint].at_phase(phase)
    }

    /// A joint's rate, acceleration, jerk and one derivative more, by `τ`, where its phase has these
    /// derivatives.
    #[inline(always)]
    pub(crate) fn rates<T: Scalar>(&self, joint: usize, phase: [T; 5]) -> [T; 4] {
        self.spans()[joint].rates(phase)
    }
}
