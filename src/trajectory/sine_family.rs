//! The sine polynomial as the kernels see it.

use std::ops::Range;

use super::family::{AtPhase, Curve, Family};
use super::grid::Grid;
use super::path::JointPath;
use super::peaks::{Limits, LocalPeak, Peaks};
use super::samples::{Sampler, Samples};
use super::sine::SinePolynomial;
use crate::lanes::Lanes;
use crate::scalar::Scalar;

/// The fewest terms that a search begins with, where there are more: the paper's.
const COARSEST: usize = 2;

/// One joint's path.
#[derive(Debug)]
pub struct SineCurve<'a> {
    family: &'a SinePolynomial,
    joint: usize,
    /// The free part in powers of `2τ − 1`.
    powers: Vec<f64>,
}

impl SineCurve<'_> {
    fn path(&self) -> JointPath<'_> {
        JointPath::new(&self.family.spans()[self.joint], self.family.basis(), &self.powers)
    }
}

impl Curve for SineCurve<'_> {
    fn derivatives<const N: usize>(&self, tau: f64) -> [f64; N] {
        self.path().derivatives(tau)
    }

    fn coefficient_slopes(&self, order: usize, tau: f64) -> impl Iterator<Item = f64> {
        self.path().coefficient_slopes(order, tau)
    }

    fn coefficient_curvature(&self, order: usize, tau: f64) -> impl Fn(usize, usize) -> f64 {
        self.path().coefficient_curvature(order, tau)
    }
}

impl Family for SinePolynomial {
    type Nodes = Grid<2>;
    type Sampler = Sampler;
    type Samples = Samples;
    type Curve<'a> = SineCurve<'a>;

    fn joints(&self) -> usize {
        self.joints()
    }

    fn dimension(&self) -> usize {
        self.dimension()
    }

    fn leading(&self) -> &[usize] {
        self.rows().leading()
    }

    #[inline(always)]
    fn coefficients_of(&self, joint: usize) -> Range<usize> {
        self.places(joint)
    }

    fn nodes(&self, times: impl IntoIterator<Item = f64>) -> Grid<2> {
        Grid::new(self, times)
    }

    #[inline(always)]
    fn phase<T: Lanes>(&self, nodes: &Grid<2>, first: usize, joint: usize, own: &[f64]) -> [T; 2] {
        self.phase(nodes, first, joint, own)
    }

    #[inline(always)]
    fn at_phase<T: Scalar>(&self, joint: usize, phase: [T; 2]) -> AtPhase<T> {
        self.at_phase(joint, phase)
    }

    #[inline(always)]
    fn bump<T: Lanes>(&self, nodes: &Grid<2>, _joint: usize, k: usize, first: usize) -> [T; 2] {
        nodes.bump(k, first)
    }

    fn sampler(&self, intervals: usize) -> Sampler {
        Sampler::new(self, intervals)
    }

    fn samples(&self, sampler: &Sampler) -> Samples {
        sampler.samples(self.joints())
    }

    #[inline(always)]
    fn sample<T: Lanes>(&self, sampler: &Sampler, coefficients: &[f64], samples: &mut Samples) {
        sampler.sample::<T>(self, coefficients, samples);
    }

    #[inline(always)]
    fn largest_ratio<T: Lanes>(
        &self,
        samples: &mut Samples,
        limits: &Limits,
        matters: impl Fn([f64; 3]) -> [f64; 3],
        coefficients: &[f64],
    ) -> [f64; 3] {
        samples.largest_ratio::<T>(limits, matters, self, coefficients)
    }

    fn local_peaks(
        &self,
        samples: &Samples,
        coefficients: &[f64],
        limits: &Limits,
        share: f64,
    ) -> Vec<LocalPeak> {
        samples.local_peaks(&self.path(coefficients), limits, share)
    }

    fn peaks(&self, samples: &Samples, coefficients: &[f64]) -> Peaks {
        samples.peaks(&self.path(coefficients))
    }

    fn coarser(&self) -> Option<Self> {
        (self.terms() > COARSEST).then(|| self.with_terms(self.terms() - 1))
    }

    fn prolong(&self, coefficients: &[f64]) -> Vec<f64> {
        let joints = coefficients.chunks_exact(self.terms());
        joints.flat_map(|own| own.iter().copied().chain([0.0])).collect()
    }

    fn curve(&self, joint: usize, own: &[f64]) -> SineCurve<'_> {
        let mut powers = vec![0.0; self.terms()];
        self.basis().gather(own, &mut powers);
        SineCurve { family: self, joint, powers }
    }
}
