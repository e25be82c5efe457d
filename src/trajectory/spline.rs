//! Joint paths that are splines.

use std::ops::Range;

use super::bspline::{Knots, MOST_DEGREE};
use super::family::{AtPhase, Curve, Family, Site};
use super::peaks::{Limits, LocalPeak, Peaks};
use super::rows::Rows;
use super::spline_peaks::{SplineSampler, SplineSamples};
use super::window::step;
use crate::lanes::{Block, Lanes, MOST};
use crate::robot::Follow;
use crate::scalar::Scalar;

/// Control points at each end that rest there fixes: with the angle, a rate and an acceleration of zero.
const FIXED: usize = 3;

/// The fewest pieces that a search begins with, where there are more.
const COARSEST: usize = 8;

/// All splines of one degree over equal pieces between two configurations, at rest at both.
///
/// ```text
/// θ(τ) = θ_0 + (θ_f − θ_0) Σ_i σ(ξ_i) B_i(τ) + Σ_k c_k B_{k+3}(τ)
/// ```
///
/// with the step `σ = 10ξ³ − 15ξ⁴ + 6ξ⁵` at the places `ξ_i` where control points belong, so that without
/// coefficients every joint goes straight from start to goal. In degree 3 the jerk is constant on each piece, in degree
/// 4 it is continuous, in degree 5 so is its slope. The coefficients \[rad\] are ordered joint by joint,
/// `pieces + degree − 6` for each that follows no other.
#[derive(Debug, Clone)]
pub struct Spline {
    knots: Knots,
    /// Start and goal of every joint, or of the one that it follows \[rad\].
    ends: Vec<[f64; 2]>,
    rows: Rows,
    /// `σ(ξ_i)`, zero and one at the control points that rest fixes.
    straight: Vec<f64>,
}

impl Spline {
    /// Between two configurations \[rad\].
    ///
    /// # Panics
    ///
    /// Panics when the lists differ in length, of a degree that is not 3 to 5, or with so few pieces that rest at
    /// both ends leaves nothing free: `pieces + degree` has to be 7 at least.
    pub fn new(start: &[f64], goal: &[f64], pieces: usize, degree: usize) -> Self {
        assert_eq!(start.len(), goal.len(), "a start and a goal for each joint");
        let ends = start.iter().zip(goal).map(|(start, goal)| [*start, *goal]).collect();
        Self::between(ends, Rows::own(start.len()), pieces, degree)
    }

    /// The same where joints follow others, whatever their own start and goal.
    ///
    /// # Panics
    ///
    /// Panics unless there is an entry for each joint, or where a leader does not exist or follows another joint itself.
    #[must_use]
    pub fn following(mut self, follows: &[Option<Follow>]) -> Self {
        assert_eq!(follows.len(), self.ends.len(), "whether each joint follows another one");
        for (joint, follow) in follows.iter().enumerate() {
            if let Some(follow) = follow {
                self.ends[joint] = self.ends[follow.leader];
            }
        }
        Self { rows: Rows::following(follows), ..self }
    }

    fn between(ends: Vec<[f64; 2]>, rows: Rows, pieces: usize, degree: usize) -> Self {
        assert!((3..=MOST_DEGREE).contains(&degree), "degree 3, 4 or 5");
        assert!(pieces + degree > 2 * FIXED, "something free");
        let knots = Knots::new(pieces, degree);
        let points = knots.points();
        let straight = (0..points).map(|i| match i {
            _ if i < FIXED => 0.0,
            _ if i + FIXED >= points => 1.0,
            _ => step::<1>(knots.place_of(i))[0],
        });
        Self { straight: straight.collect(), knots, ends, rows }
    }

    /// The same over so many pieces.
    fn with_pieces(&self, pieces: usize) -> Self {
        Self::between(self.ends.clone(), self.rows.clone(), pieces, self.knots.degree())
    }

    /// The knots of every joint.
    pub fn knots(&self) -> &Knots {
        &self.knots
    }

    /// Control points at each end of a joint that are the same on every path.
    pub fn fixed(&self) -> usize {
        FIXED
    }

    /// Free coefficients per joint.
    pub fn free(&self) -> usize {
        self.knots.points() - 2 * FIXED
    }

    /// Writes a joint's control points \[rad\]; coefficients that are missing are zero.
    pub fn write_points(&self, joint: usize, own: &[f64], points: &mut [f64]) {
        let [start, goal] = self.ends[joint];
        for (point, straight) in points.iter_mut().zip(&self.straight) {
            *point = start + (goal - start) * straight;
        }
        for (point, coefficient) in points[FIXED..].iter_mut().zip(own) {
            *point += coefficient;
        }
        if let Some(follow) = self.rows.follow(joint) {
            for point in points {
                *point = follow.position(*point);
            }
        }
    }
}

/// The basis functions of a spline at fixed times, in lanes.
#[derive(Debug, Clone)]
pub struct SplineNodes {
    /// For each [`MOST`] times, the straight path's value and slope per unit of change.
    straight: Vec<[Block; 2]>,
    /// For each [`MOST`] times the own coefficients that matter there, and where their functions begin.
    supports: Vec<(Range<usize>, usize)>,
    /// Value and slope of these functions.
    bumps: Vec<[Block; 2]>,
}

impl SplineNodes {
    fn new(family: &Spline, times: impl IntoIterator<Item = f64>) -> Self {
        let (degree, free) = (family.knots.degree(), family.free());
        let mut times: Vec<f64> = times.into_iter().collect();
        times.resize(times.len().next_multiple_of(2 * MOST), 0.0);
        let mut nodes = Self { straight: Vec::new(), supports: Vec::new(), bumps: Vec::new() };
        for times in times.chunks_exact(MOST) {
            let at: Vec<_> = times.iter().map(|&tau| family.knots.bumps::<2>(tau)).collect();
            // Nothing depends on coefficients at the path's start, which lanes are filled up with.
            let moving = || at.iter().zip(times).filter(|(_, tau)| **tau > 0.0).map(|(at, _)| at.0);
            let first = moving().min().unwrap_or(0).saturating_sub(FIXED).min(free);
            let last = moving().max().map_or(0, |piece| (piece + degree + 1).saturating_sub(FIXED));
            let support = first..last.clamp(first, free);
            let mut straight = [Block::default(); 2];
            let begin = nodes.bumps.len();
            nodes.bumps.resize(begin + support.len(), [Block::default(); 2]);
            for (lane, (piece, bumps)) in at.iter().enumerate() {
                for (i, bump) in bumps.iter().enumerate().take(degree + 1) {
                    let point = piece + i;
                    for (straight, bump) in straight.iter_mut().zip(bump) {
                        straight.0[lane] += family.straight[point] * bump;
                    }
                    if let Some(k) = point.checked_sub(FIXED).filter(|k| support.contains(k)) {
                        let place = &mut nodes.bumps[begin + k - support.start];
                        for (block, bump) in place.iter_mut().zip(bump) {
                            block.0[lane] = *bump;
                        }
                    }
                }
            }
            nodes.straight.push(straight);
            nodes.supports.push((support, begin));
        }
        nodes
    }
}

/// One joint's spline, by its control points.
#[derive(Debug)]
pub struct SplineCurve<'a> {
    family: &'a Spline,
    points: Vec<f64>,
    /// By what the points follow the coefficients.
    multiplier: f64,
}

/// The last of `N` derivatives, from the value on, of the basis functions that are not zero at a time, and the number of the first.
fn bumps_of<const N: usize>(knots: &Knots, tau: f64) -> (usize, [f64; MOST_DEGREE + 1]) {
    let (first, bumps) = knots.bumps::<N>(tau);
    (first, bumps.map(|derivatives| derivatives[N - 1]))
}

impl Curve for SplineCurve<'_> {
    fn derivatives<const N: usize>(&self, tau: f64) -> [f64; N] {
        self.family.knots.derivatives(&self.points, tau)
    }

    fn coefficient_slopes(&self, order: usize, tau: f64) -> impl Iterator<Item = f64> {
        let knots = &self.family.knots;
        let (first, bumps) = match order {
            0 => bumps_of::<1>(knots, tau),
            1 => bumps_of::<2>(knots, tau),
            2 => bumps_of::<3>(knots, tau),
            3 => bumps_of::<4>(knots, tau),
            _ => bumps_of::<6>(knots, tau),
        };
        let degree = knots.degree();
        let multiplier = self.multiplier;
        (0..self.family.free()).map(move |k| match (k + FIXED).checked_sub(first) {
            Some(i) if i <= degree => multiplier * bumps[i],
            _ => 0.0,
        })
    }

    fn coefficient_curvature(&self, _order: usize, _tau: f64) -> impl Fn(usize, usize) -> f64 {
        |_, _| 0.0
    }
}

impl Family for Spline {
    type Nodes = SplineNodes;
    type Sampler = SplineSampler;
    type Samples = SplineSamples;
    type Curve<'a> = SplineCurve<'a>;

    fn joints(&self) -> usize {
        self.rows.joints()
    }

    fn dimension(&self) -> usize {
        self.rows.count() * self.free()
    }

    fn leading(&self) -> &[usize] {
        self.rows.leading()
    }

    #[inline(always)]
    fn coefficients_of(&self, joint: usize) -> Range<usize> {
        let (row, free) = (self.rows.of(joint), self.free());
        row * free..(row + 1) * free
    }

    /// Whole panels per piece.
    fn panels(&self, least: usize) -> usize {
        least.next_multiple_of(self.knots.pieces())
    }

    fn nodes(&self, times: impl IntoIterator<Item = f64>) -> SplineNodes {
        SplineNodes::new(self, times)
    }

    #[inline(always)]
    fn phase<T: Lanes>(
        &self,
        nodes: &SplineNodes,
        first: usize,
        joint: usize,
        own: &[f64],
    ) -> [T; 2] {
        let [start, goal] = self.ends[joint];
        let change = T::of(goal - start);
        let load = |blocks: &[Block; 2], n: usize| T::load(&blocks[n].0[first % MOST..]);
        let straight = &nodes.straight[first / MOST];
        let mut phase =
            [load(straight, 0).mul_add(change, T::of(start)), load(straight, 1) * change];
        let (support, begin) = &nodes.supports[first / MOST];
        let bumps = &nodes.bumps[*begin..*begin + support.len()];
        for (&coefficient, bump) in own[support.clone()].iter().zip(bumps) {
            let coefficient = T::of(coefficient);
            phase[0] = load(bump, 0).mul_add(coefficient, phase[0]);
            phase[1] = load(bump, 1).mul_add(coefficient, phase[1]);
        }
        phase
    }

    #[inline(always)]
    fn at_phase<T: Scalar>(&self, joint: usize, [angle, rate]: [T; 2]) -> AtPhase<T> {
        let rate_slope = T::of(0.0);
        let Some(Follow { multiplier, offset, .. }) = self.rows.follow(joint) else {
            return AtPhase { angle, rate, angle_slope: T::of(1.0), rate_slope };
        };
        let multiplier = T::of(multiplier);
        AtPhase {
            angle: multiplier.mul_add(angle, T::of(offset)),
            rate: multiplier * rate,
            angle_slope: multiplier,
            rate_slope,
        }
    }

    #[inline(always)]
    fn support<T: Lanes>(&self, nodes: &SplineNodes, _joint: usize, first: usize) -> Range<usize> {
        nodes.supports[first / MOST].0.clone()
    }

    #[inline(always)]
    fn bump<T: Lanes>(&self, nodes: &SplineNodes, _joint: usize, k: usize, first: usize) -> [T; 2] {
        let (support, begin) = &nodes.supports[first / MOST];
        let bump = &nodes.bumps[begin + k - support.start];
        [T::load(&bump[0].0[first % MOST..]), T::load(&bump[1].0[first % MOST..])]
    }

    /// Half as many pieces.
    fn coarser(&self) -> Option<Self> {
        let half = self.knots.pieces() / 2;
        let is_one = self.knots.pieces().is_multiple_of(2) && half >= COARSEST;
        is_one.then(|| self.with_pieces(half))
    }

    fn prolong(&self, coefficients: &[f64]) -> Vec<f64> {
        let finer = self.with_pieces(2 * self.knots.pieces());
        let mut own = vec![0.0; self.knots.points()];
        let mut straight = vec![0.0; finer.knots.points()];
        let mut all = Vec::with_capacity(finer.dimension());
        for &joint in self.leading() {
            self.write_points(joint, &coefficients[self.coefficients_of(joint)], &mut own);
            finer.write_points(joint, &[], &mut straight);
            let points = self.knots.split(&own);
            let free = FIXED..FIXED + finer.free();
            all.extend(points[free.clone()].iter().zip(&straight[free]).map(|(p, s)| p - s));
        }
        all
    }

    fn sampler(&self, _intervals: usize) -> SplineSampler {
        SplineSampler::new(self.knots.clone())
    }

    fn samples(&self, sampler: &SplineSampler) -> SplineSamples {
        sampler.samples(self.joints())
    }

    #[inline(always)]
    fn sample<T: Lanes>(
        &self,
        sampler: &SplineSampler,
        coefficients: &[f64],
        samples: &mut SplineSamples,
    ) {
        for joint in 0..self.joints() {
            let own = &coefficients[self.coefficients_of(joint)];
            sampler.sample(joint, samples, |points| self.write_points(joint, own, points));
        }
    }

    #[inline(always)]
    fn largest_ratio<T: Lanes>(
        &self,
        samples: &mut SplineSamples,
        limits: &Limits,
        matters: impl Fn([f64; 3]) -> [f64; 3],
        _coefficients: &[f64],
    ) -> [f64; 3] {
        samples.largest_ratio(limits, matters)
    }

    fn local_peaks(
        &self,
        samples: &SplineSamples,
        _coefficients: &[f64],
        limits: &Limits,
        share: f64,
    ) -> Vec<LocalPeak> {
        samples.local_peaks(limits, share)
    }

    fn peaks(&self, samples: &SplineSamples, _coefficients: &[f64]) -> Peaks {
        samples.peaks()
    }

    fn range_excess(&self, samples: &SplineSamples, ranges: &[[f64; 2]]) -> f64 {
        samples.range_excess(ranges)
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn sites(&self, samples: &SplineSamples, each: &mut dyn FnMut(&Site)) {
        let free = self.free();
        samples.sites(|mut site| {
            // The slopes by control points become those by the free ones.
            let skipped = FIXED.saturating_sub(site.first);
            site.slopes.rotate_left(skipped);
            let first = (site.first + skipped).saturating_sub(FIXED);
            let count = (MOST_DEGREE + 1 - skipped).min(free.saturating_sub(first));
            site.slopes[count..].fill(0.0);
            if let Some(Follow { multiplier, .. }) = self.rows.follow(site.joint) {
                site.slopes = site.slopes.map(|slope| multiplier * slope);
            }
            site.first = self.rows.of(site.joint) * free + first;
            each(&site);
        });
    }

    fn curve(&self, joint: usize, own: &[f64]) -> SplineCurve<'_> {
        let mut points = vec![0.0; self.knots.points()];
        self.write_points(joint, own, &mut points);
        let multiplier = self.rows.follow(joint).map_or(1.0, |follow| follow.multiplier);
        SplineCurve { family: self, points, multiplier }
    }
}

#[cfg(test)]
mod tests {
    use super::super::peaks::{duration_asked, longest_asked, powers};
    use super::*;

    fn families() -> impl Iterator<Item = (Spline, Vec<f64>)> {
        let (start, goal) = ([0.2, -0.5, 1.0], [0.7, 1.0, 1.0]);
        [(3, 5), (3, 40), (4, 4), (4, 17), (5, 3), (5, 20)].into_iter().map(
            move |(degree, pieces)| {
                let family = Spline::new(&start, &goal, pieces, degree);
                let own = (0..family.dimension()).map(|i| 0.4 * f64::sin(5.7 * i as f64)).collect();
                (family, own)
            },
        )
    }

    #[test]
    fn paths_rest_at_both_ends() {
        for (family, coefficients) in families() {
            for joint in 0..3 {
                let curve = family.curve(joint, &coefficients[family.coefficients_of(joint)]);
                for (tau, end) in [0.0, 1.0].into_iter().zip(family.ends[joint]) {
                    let [angle, rate, acceleration] = curve.derivatives(tau);
                    assert!((angle - end).abs() < 1e-15);
                    assert!(rate.abs() < 1e-12 && acceleration.abs() < 1e-10);
                }
            }
        }
    }

    /// Tables for times say what the curve says, and nothing beyond the support matters.
    #[test]
    fn nodes_are_on_the_curve() {
        for (family, coefficients) in families() {
            let times: Vec<f64> = (0..50).map(|i| f64::from(i) / 49.0).collect();
            let nodes = family.nodes(times.iter().copied());
            for joint in 0..3 {
                let own = &coefficients[family.coefficients_of(joint)];
                let curve = family.curve(joint, own);
                for (i, &tau) in times.iter().enumerate() {
                    let [angle, rate] = family.phase::<f64>(&nodes, i, joint, own);
                    let [expected, slope] = curve.derivatives(tau);
                    assert!((angle - expected).abs() < 1e-13, "{tau}");
                    assert!((rate - slope).abs() < 1e-11, "{tau}");
                    let support = family.support::<f64>(&nodes, joint, i);
                    for (k, by) in curve.coefficient_slopes(0, tau).enumerate() {
                        let found = if support.contains(&k) {
                            family.bump::<f64>(&nodes, joint, k, i)[0]
                        } else {
                            0.0
                        };
                        assert!((found - by).abs() < 1e-15, "{tau} {k}");
                    }
                }
            }
        }
    }

    /// No derivative exceeds its peak anywhere, and reaches it there.
    #[test]
    fn peaks_are_exact() {
        for (family, coefficients) in families() {
            let sampler = family.sampler(0);
            let mut samples = family.samples(&sampler);
            family.sample::<f64>(&sampler, &coefficients, &mut samples);
            let peaks = family.peaks(&samples, &coefficients);
            for joint in 0..3 {
                let curve = family.curve(joint, &coefficients[family.coefficients_of(joint)]);
                for (order, peak) in (1..).zip(peaks.0[joint]) {
                    let at = |tau: f64| curve.derivatives::<4>(tau)[order].abs();
                    let highest =
                        (0..=20_000).map(|i| at(f64::from(i) / 20_000.0)).fold(0.0, f64::max);
                    assert!(highest <= peak.value * (1.0 + 1e-12), "{order}: {highest} {peak:?}");
                    assert!((at(peak.tau) - peak.value).abs() < 1e-9 * peak.value, "{order}");
                }
            }
            let limits = Limits(vec![[1.0, 4.0, 30.0]; 3]);
            let matters = |known| powers(longest_asked(known));
            let duration = longest_asked(samples.largest_ratio(&limits, matters));
            let exact = peaks.shortest_duration(&limits);
            assert!((duration - exact).abs() < 1e-14 * exact, "{duration} {exact}");
            let places = family.local_peaks(&samples, &coefficients, &limits, 0.9);
            let asked = places.iter().map(|place| {
                let own = &coefficients[family.coefficients_of(place.joint)];
                let value = family.curve(place.joint, own).derivatives::<4>(place.tau)[place.order];
                duration_asked(value.abs() / limits.0[place.joint][place.order - 1], place.order)
            });
            let longest = asked.fold(0.0, f64::max);
            assert!((longest - exact).abs() < 1e-9 * exact, "{longest} {exact}");
        }
    }
}
