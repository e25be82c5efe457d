//! What the planner's kernels ask of a family of joint paths.

use std::fmt::Debug;
use std::ops::Range;

use super::bspline::MOST_DEGREE;
use super::peaks::{Limits, LocalPeak, Peaks};
use crate::lanes::Lanes;
use crate::scalar::{Pair, Scalar};

/// All paths of one kind between two configurations, in normalised time `τ = t / t_f`.
///
/// A joint's position is a function of a *phase*, `θ = g(s(τ))`, and the phase is linear in the joint's own
/// coefficients, `s = s_0(τ) + Σ_k c_k b_k(τ)`. For a spline `g` is the identity. Coefficients are ordered
/// joint by joint. A joint that follows another one has that one's phase and coefficients, and a `g` of its own.
///
/// What takes a `T` works in lanes: implementations have to be `#[inline(always)]`, like all that they call.
pub trait Family: Debug + Clone + Send + Sync + 'static {
    /// What coefficients do not change at fixed times, one time per lane.
    type Nodes: Debug + Clone + Send + Sync;

    /// The same where peaks are sought.
    type Sampler: Debug + Clone + Send + Sync;

    /// Room for the samples of one path.
    type Samples: Debug + Clone + Send;

    /// One joint's path.
    type Curve<'a>: Curve;

    /// Number of joints.
    fn joints(&self) -> usize;

    /// Free coefficients in all.
    fn dimension(&self) -> usize;

    /// The joints that follow none, each of which has coefficients of its own.
    fn leading(&self) -> &[usize];

    /// The places of a joint's coefficients among all; of a joint that follows another one they are that one's.
    fn coefficients_of(&self, joint: usize) -> Range<usize>;

    /// So many panels of equal width at least, for rules of quadrature that want smooth paths in each.
    fn panels(&self, least: usize) -> usize {
        least
    }

    /// Tables for these times, filled up with the path's start to a number that pairs of lanes divide.
    fn nodes(&self, times: impl IntoIterator<Item = f64>) -> Self::Nodes;

    /// A joint's phase and its derivative by `τ` from time `first` on, from its own coefficients.
    fn phase<T: Lanes>(
        &self,
        nodes: &Self::Nodes,
        first: usize,
        joint: usize,
        own: &[f64],
    ) -> [T; 2];

    /// The same at two places at once.
    #[inline(always)]
    fn phase_pair<T: Lanes>(
        &self,
        nodes: &Self::Nodes,
        [near, far]: [usize; 2],
        joint: usize,
        own: &[f64],
    ) -> [Pair<T>; 2] {
        let near = self.phase::<T>(nodes, near, joint, own);
        let far = self.phase::<T>(nodes, far, joint, own);
        [Pair(near[0], far[0]), Pair(near[1], far[1])]
    }

    /// A joint's position and rate at a phase with its derivative, and how they follow it.
    fn at_phase<T: Scalar>(&self, joint: usize, phase: [T; 2]) -> AtPhase<T>;

    /// Those of a joint's coefficients that change anything at the times from `first` on.
    #[inline(always)]
    fn support<T: Lanes>(&self, _nodes: &Self::Nodes, joint: usize, _first: usize) -> Range<usize> {
        0..self.coefficients_of(joint).len()
    }

    /// Derivative of the phase, and of its derivative by `τ`, by a joint's `k`-th own coefficient.
    fn bump<T: Lanes>(&self, nodes: &Self::Nodes, joint: usize, k: usize, first: usize) -> [T; 2];

    /// Tables to find peaks with, for so many intervals at least.
    fn sampler(&self, intervals: usize) -> Self::Sampler;

    /// Room for the samples of a path.
    fn samples(&self, sampler: &Self::Sampler) -> Self::Samples;

    /// Samples the path with these coefficients.
    fn sample<T: Lanes>(
        &self,
        sampler: &Self::Sampler,
        coefficients: &[f64],
        samples: &mut Self::Samples,
    );

    /// Of each order the sampled path's largest peak as a multiple of its limit. One that is below what
    /// `matters` makes of those known so far need not be found, and a smaller one may stand for it.
    fn largest_ratio<T: Lanes>(
        &self,
        samples: &mut Self::Samples,
        limits: &Limits,
        matters: impl Fn([f64; 3]) -> [f64; 3],
        coefficients: &[f64],
    ) -> [f64; 3];

    /// All local maxima of the sampled path that ask for a duration not below `share` of the longest asked
    /// for.
    fn local_peaks(
        &self,
        samples: &Self::Samples,
        coefficients: &[f64],
        limits: &Limits,
        share: f64,
    ) -> Vec<LocalPeak>;

    /// The largest peaks of the sampled path.
    fn peaks(&self, samples: &Self::Samples, coefficients: &[f64]) -> Peaks;

    /// By how much the sampled path leaves the joints' ranges, as a share of half the range of the joint that does so most;
    /// zero within, and for a family that never leaves them.
    fn range_excess(&self, _samples: &Self::Samples, _ranges: &[[f64; 2]]) -> f64 {
        0.0
    }

    /// The family of some of these paths with fewer coefficients, where there is one to search first.
    fn coarser(&self) -> Option<Self> {
        None
    }

    /// The same path's coefficients in the family whose [coarser](Self::coarser) one this is; they are affine in its own.
    fn prolong(&self, coefficients: &[f64]) -> Vec<f64> {
        coefficients.to_vec()
    }

    /// Whether derivatives of the path are linear in the coefficients, so that [`sites`](Self::sites) has all that they
    /// may do.
    fn is_linear(&self) -> bool {
        false
    }

    /// Of a family that [is linear](Self::is_linear), calls `each` for every place where a derivative of the sampled path
    /// may be largest in magnitude.
    fn sites(&self, _samples: &Self::Samples, _each: &mut dyn FnMut(&Site)) {}

    /// One joint's path, from its own coefficients.
    fn curve(&self, joint: usize, own: &[f64]) -> Self::Curve<'_>;
}

/// A derivative of a joint's path at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// Index of the joint.
    pub joint: usize,
    /// 0 for the position, 1 for the rate, 2 for the acceleration, 3 for the jerk.
    pub order: usize,
    /// The derivative by `τ`.
    pub value: f64,
    /// Which of the places that are the same on every path; none for one that moves with the path.
    pub place: Option<usize>,
    /// The first coefficient that the derivative follows.
    pub first: usize,
    /// Its slopes by those from there on.
    pub slopes: [f64; MOST_DEGREE + 1],
}

/// One joint's path, at any time.
pub trait Curve {
    /// Position \[rad or m\] and first derivatives by `τ`, at most six in all.
    fn derivatives<const N: usize>(&self, tau: f64) -> [f64; N];

    /// Derivative of the `order`-th derivative of the position by each of the joint's coefficients.
    fn coefficient_slopes(&self, order: usize, tau: f64) -> impl Iterator<Item = f64>;

    /// Second derivative of the `order`-th derivative of the position by any two of the joint's
    /// coefficients.
    fn coefficient_curvature(&self, order: usize, tau: f64) -> impl Fn(usize, usize) -> f64;
}

/// A joint's position and rate at a phase.
#[derive(Debug, Clone, Copy)]
pub struct AtPhase<T> {
    /// `θ` \[rad\].
    pub angle: T,
    /// `θ'`, by `τ` \[rad\].
    pub rate: T,
    /// `∂θ/∂s`, which is `∂θ'/∂s'` too.
    pub angle_slope: T,
    /// `∂θ'/∂s`.
    pub rate_slope: T,
}
