//! A path sampled in lanes, and the peaks between samples.

use super::grid::Grid;
use super::path::{JointPath, Path};
use super::peaks::{Limits, LocalPeak, Peak, Peaks, duration_asked, longest_asked};
use super::sine::SinePolynomial;
use crate::lanes::{Lanes, MOST};
use crate::scalar::{Pair, Scalar};

/// Samples the paths of one family at the ends of equal intervals. Both ends of the path are among
/// them: a jerk is often largest there.
#[derive(Debug, Clone)]
pub struct Sampler {
    grid: Grid<5>,
    intervals: usize,
}

/// The samples of one path.
#[derive(Debug, Clone)]
pub struct Samples {
    /// The number of times, as in the grid.
    times: usize,
    intervals: usize,
    /// For every joint four rows, one number a time: rate, acceleration, jerk and one derivative more.
    rows: Vec<f64>,
    /// For every joint, of each order the largest magnitude among the samples.
    largest: Vec<[f64; 3]>,
    /// And what no peak between samples exceeds.
    bounds: Vec<[f64; 3]>,
    room: ArchRoom,
}

/// By which share of a peak's height its place may miss it: for its height, and for its place, which
/// misses by the root.
const HEIGHT: f64 = 1e-13;
const PLACE: f64 = 1e-21;

impl Sampler {
    /// At the ends of so many intervals.
    pub fn new(family: &SinePolynomial, intervals: usize) -> Self {
        let times = (0..=intervals).map(|i| i as f64 / intervals as f64);
        Self { grid: Grid::new(family, times), intervals }
    }

    /// Room for the samples of a path with so many joints.
    pub fn samples(&self, joints: usize) -> Samples {
        let times = self.grid.times();
        Samples {
            times,
            intervals: self.intervals,
            rows: vec![0.0; joints * 4 * times + MOST],
            largest: vec![[0.0; 3]; joints],
            bounds: vec![[0.0; 3]; joints],
            room: ArchRoom::default(),
        }
    }

    /// Samples the path with these coefficients.
    ///
    /// # Panics
    ///
    /// Panics when the room was not made for this family.
    #[inline(always)]
    pub fn sample<T: Lanes>(
        &self,
        family: &SinePolynomial,
        coefficients: &[f64],
        samples: &mut Samples,
    ) {
        let times = self.grid.times();
        assert_eq!(
            samples.rows.len(),
            family.joints() * 4 * times + MOST,
            "samples of this family"
        );
        let reach = Pair::of(2.0 / self.intervals as f64);
        for (joint, rows) in samples.rows.chunks_exact_mut(4 * times).enumerate() {
            let coefficients = family.of_joint(joint, coefficients);
            let zeros = [Pair::<T>::of(0.0); 3];
            let (mut largest, mut bounds) = (zeros, zeros);
            for near in (0..times).step_by(2 * T::COUNT) {
                let far = near + T::COUNT;
                let phases = family.phases::<T, 5>(&self.grid, [near, far], joint, coefficients);
                let rates = family.rates(joint, phases);
                for k in 0..3 {
                    let size = rates[k].abs();
                    largest[k] = largest[k].larger(size);
                    bounds[k] = bounds[k].larger(reach.mul_add(rates[k + 1].abs(), size));
                }
                for (n, rate) in rates.into_iter().enumerate() {
                    rate.0.store(&mut rows[n * times + near..]);
                    rate.1.store(&mut rows[n * times + far..]);
                }
            }
            for k in 0..3 {
                samples.largest[joint][k] = largest_lane(largest[k].0.larger(largest[k].1));
                samples.bounds[joint][k] = largest_lane(bounds[k].0.larger(bounds[k].1));
            }
        }
    }
}

impl Peaks {
    /// The peaks of the path with these coefficients in normalised time \[rad\].
    pub fn of(family: &SinePolynomial, coefficients: &[f64], intervals: usize) -> Self {
        let sampler = Sampler::new(family, intervals);
        let mut samples = sampler.samples(family.joints());
        sampler.sample::<f64>(family, coefficients, &mut samples);
        samples.peaks(&family.path(coefficients))
    }
}

#[inline(always)]
fn largest_lane<T: Lanes>(lanes: T) -> f64 {
    lanes.numbers().into_iter().fold(0.0, Scalar::larger)
}

/// An interval in which the magnitude of a derivative may rise above its floor.
#[derive(Debug, Clone, Copy)]
struct Arch {
    /// What it can reach at most.
    bound: f64,
    /// The same, as a multiple of the floor.
    above: f64,
    joint: usize,
    order: usize,
    interval: usize,
}

/// Room for what [`Samples::largest_ratio`] looks at.
#[derive(Debug, Clone, Default)]
struct ArchRoom {
    arches: Vec<Arch>,
    /// One joint's coefficients in powers.
    powers: Vec<f64>,
}

/// One derivative of one joint's path at the samples.
#[derive(Clone, Copy)]
struct Row<'a> {
    /// As many as there are intervals and one more, and something behind them.
    values: &'a [f64],
    slopes: &'a [f64],
    intervals: usize,
    order: usize,
}

impl Samples {
    fn row(&self, joint: usize, order: usize) -> Row<'_> {
        let row = |n: usize| {
            let first = (joint * 4 + n) * self.times;
            &self.rows[first..first + self.times + MOST]
        };
        Row { values: row(order - 1), slopes: row(order), intervals: self.intervals, order }
    }

    /// All peaks of the path.
    pub fn peaks(&self, path: &Path<'_>) -> Peaks {
        let peaks = path.joints().enumerate().map(|(j, joint)| {
            [1, 2, 3].map(|order| {
                let row = self.row(j, order);
                row.peak(&joint, row.highest_sample())
            })
        });
        Peaks(peaks.collect())
    }

    /// Of each order the largest peak as a multiple of its limit. One that is below what `matters` makes of
    /// those known so far need not be found, and a smaller one may stand for it.
    #[inline(always)]
    pub fn largest_ratio<T: Lanes>(
        &mut self,
        limits: &Limits,
        matters: impl Fn([f64; 3]) -> [f64; 3],
        family: &SinePolynomial,
        coefficients: &[f64],
    ) -> [f64; 3] {
        let mut known = limits.largest_ratio(self.largest.iter().copied());
        let mut floor = matters(known);
        let mut room = std::mem::take(&mut self.room);
        let ArchRoom { arches, powers } = &mut room;
        arches.clear();
        for (joint, (bounds, limit)) in self.bounds.iter().zip(&limits.0).enumerate() {
            for k in 0..3 {
                let floor = floor[k] * limit[k];
                if bounds[k] > floor {
                    self.row(joint, k + 1).add_arches::<T>(floor, joint, arches);
                }
            }
        }
        // What reaches furthest above its floor comes first, and may be all there is to find.
        arches.sort_unstable_by(|a, b| b.above.total_cmp(&a.above));
        powers.resize(family.terms(), 0.0);
        for &Arch { bound, joint, order, interval, .. } in arches.iter() {
            let k = order - 1;
            let limit = limits.0[joint][k];
            let least = floor[k] * limit;
            if bound > least {
                let path = family.joint_path(joint, coefficients, powers);
                let peak = self.row(joint, order).refine(&path, interval, HEIGHT, least);
                known[k] = f64::max(known[k], peak.value / limit);
                floor = matters(known);
            }
        }
        self.room = room;
        known
    }

    /// All local maxima that ask for a duration not below `share` of the longest asked for.
    pub fn local_peaks(&self, path: &Path<'_>, limits: &Limits, share: f64) -> Vec<LocalPeak> {
        let mut asked: Vec<(LocalPeak, f64)> = Vec::new();
        let least = share * longest_asked(limits.largest_ratio(self.largest.iter().copied()));
        for (joint, part) in path.joints().enumerate() {
            for order in 1..=3 {
                let limit = limits.0[joint][order - 1];
                let floor = limit * least.powi(order as i32);
                if self.bounds[joint][order - 1] < floor {
                    continue;
                }
                asked.extend(self.row(joint, order).local_peaks(&part, floor).map(|peak| {
                    let place = LocalPeak { joint, order, tau: peak.tau };
                    (place, duration_asked(peak.value / limit, order))
                }));
            }
        }
        let longest = asked.iter().map(|(_, duration)| *duration).fold(0.0, f64::max);
        asked.retain(|(_, duration)| *duration >= share * longest);
        asked.into_iter().map(|(place, _)| place).collect()
    }
}

impl Row<'_> {
    fn width(&self) -> f64 {
        1.0 / self.intervals as f64
    }

    fn tau(&self, i: usize) -> f64 {
        i as f64 / self.intervals as f64
    }

    fn sample(&self, i: usize) -> Peak {
        Peak { value: self.values[i].abs(), tau: self.tau(i) }
    }

    fn highest_sample(&self) -> Peak {
        (0..=self.intervals).map(|i| self.sample(i)).fold(Peak::default(), Peak::or)
    }

    /// The highest peak between samples, or `best` where none is higher.
    fn peak(&self, joint: &JointPath<'_>, mut best: Peak) -> Peak {
        for i in 0..self.intervals {
            if self.arch_bound(i) > best.value {
                best = best.or(self.refine(joint, i, HEIGHT, best.value));
            }
        }
        best
    }

    /// The local maxima of the magnitude that may reach a floor: those of arches between two samples,
    /// and samples, the ends among them, that no neighbour exceeds.
    fn local_peaks(self, joint: &JointPath<'_>, floor: f64) -> impl Iterator<Item = Peak> {
        let last = self.intervals;
        let arches = (0..last).filter(move |&i| {
            let bound = self.arch_bound(i);
            bound > 0.0 && bound >= floor
        });
        let arches = arches.map(move |i| self.refine(joint, i, PLACE, 0.0));
        // Which way the magnitude goes at a sample.
        let slope = move |i: usize| self.values[i] * self.slopes[i];
        let size = move |i: usize| self.values[i].abs();
        let tops = (0..=last).filter(move |&i| size(i) >= floor).filter(move |&i| {
            let falls_before = i == 0 || slope(i) >= 0.0 && size(i) >= size(i - 1);
            let falls_after = i == last || slope(i) <= 0.0 && size(i) >= size(i + 1);
            falls_before && falls_after
        });
        arches.chain(tops.map(move |i| self.sample(i)))
    }

    /// Adds the arches that may rise above `floor`.
    #[inline(always)]
    fn add_arches<T: Lanes>(&self, floor: f64, joint: usize, arches: &mut Vec<Arch>) {
        for first in (0..self.intervals).step_by(T::COUNT) {
            let [start, end] = [T::load(&self.values[first..]), T::load(&self.values[first + 1..])];
            let [up, down] = [T::load(&self.slopes[first..]), T::load(&self.slopes[first + 1..])];
            if arch_bound([start, end], [up, down], T::of(self.width())).all_below(floor) {
                continue;
            }
            for interval in first..self.intervals.min(first + T::COUNT) {
                let bound = self.arch_bound(interval);
                if bound > floor {
                    let above = bound / floor;
                    arches.push(Arch { bound, above, joint, order: self.order, interval });
                }
            }
        }
    }

    fn arch_bound(&self, i: usize) -> f64 {
        let ends = |row: &[f64]| [row[i], row[i + 1]];
        arch_bound(ends(self.values), ends(self.slopes), self.width())
    }

    /// The extreme value inside an interval whose slope changes sign, until the next step gains less than
    /// `tolerance` of the value, or none reaches `floor`. A step gains half its length times the slope.
    ///
    /// The first place is where the cubic through both ends has its peak; then the slope's root by regula
    /// falsi with the Illinois rule.
    fn refine(&self, joint: &JointPath<'_>, i: usize, tolerance: f64, floor: f64) -> Peak {
        let (mut a, mut b) = (self.tau(i), self.tau(i + 1));
        let (mut slope_a, mut slope_b) = (self.slopes[i], self.slopes[i + 1]);
        let sign = slope_a.signum();
        let mut middle = self.cubic_peak(i);
        let mut best = Peak::default();
        for _ in 0..40 {
            let rates = joint.rates(middle);
            best = best.or(Peak { value: sign * rates[self.order - 1], tau: middle });
            let slope = rates[self.order];
            if slope * slope_b < 0.0 {
                (a, slope_a) = (b, slope_b);
            } else {
                slope_a /= 2.0;
            }
            (b, slope_b) = (middle, slope);
            let next = (a * slope_b - b * slope_a) / (slope_b - slope_a);
            let gain = (slope * (next - middle) / 2.0).abs();
            // Less where the slope is zero; not a number only where the path is none.
            let enough = gain <= tolerance * best.value || gain.is_nan();
            if enough || best.value + 2.0 * (slope * (b - a)).abs() <= floor {
                break;
            }
            middle = next;
        }
        best
    }

    /// Where the cubic with the values and slopes at both ends of an interval has its peak.
    fn cubic_peak(&self, i: usize) -> f64 {
        let width = self.width();
        let sign = self.slopes[i].signum();
        let rise = sign * (self.values[i + 1] - self.values[i]);
        let [left, right] = [self.slopes[i], self.slopes[i + 1]].map(|slope| sign * width * slope);
        // The cubic's slope is left + linear t + square t², positive at t = 0, negative at t = 1.
        let linear = 6.0 * rise - 4.0 * left - 2.0 * right;
        let square = 3.0 * (left + right) - 6.0 * rise;
        let t = 2.0 * left / ((linear * linear - 4.0 * square * left).sqrt() - linear);
        // Cancellation may have left nothing of the denominator.
        self.tau(i) + width * if t > 0.0 && t < 1.0 { t } else { 0.5 }
    }
}

/// What an arch between two samples can reach at most, from values and slopes at both; zero where the
/// slope, with the sign that it has at the left end, does not turn from up to down.
///
/// The tangents at both ends meet above any concave arch. Over an interval much wider than the arch's bend
/// it need not be concave, hence twice the tangents' rise; where they meet outside the interval, twice that of the
/// higher end's tangent over the whole of it.
#[inline(always)]
fn arch_bound<T: Scalar>([left, right]: [T; 2], [up, down]: [T; 2], width: T) -> T {
    let sign = up.select_below(0.0, T::of(-1.0), T::of(1.0));
    let (start, end, up, down) = (sign * left, sign * right, sign * up, -(sign * down));
    let meeting = start + up * (end - start + down * width) / (up + down);
    let higher = end.larger(start);
    let rise = meeting - higher;
    let steepest = width * (start - end).select_below(0.0, down, up);
    let rise = rise.select_below(0.0, steepest, rise);
    let none = T::of(0.0);
    down.select_below(f64::MIN_POSITIVE, none, higher + (rise + rise))
}
