//! The largest rate, acceleration and jerk over continuous time, and the duration they allow.

use serde::Serialize;

use super::path::{JointPath, Path};

/// Largest `|θ'|`, `|θ''|`, `|θ'''|` of each joint over the whole path.
#[derive(Debug, Clone, PartialEq)]
pub struct Peaks(pub Vec<[Peak; 3]>);

/// The largest absolute value of something over the whole path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Peak {
    /// The value.
    pub value: f64,
    /// Where it stands, in normalised time.
    pub tau: f64,
}

impl Peak {
    /// The larger of two; the first where they are equal.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }
}

/// The most each joint may do: rate \[rad/s\], acceleration \[rad/s²\], jerk \[rad/s³\]
/// (eqs. 30–32).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Limits(pub Vec<[f64; 3]>);

/// A local maximum of `|θ'|`, `|θ''|` or `|θ'''|` along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalPeak {
    /// Index of the joint.
    pub joint: usize,
    /// 1 for the rate, 2 for the acceleration, 3 for the jerk.
    pub order: usize,
    /// Where, in normalised time.
    pub tau: f64,
}

/// A joint's angle and first four derivatives at one time.
type Sample = [f64; 5];

impl Peaks {
    /// The peaks of a path in normalised time \[rad\].
    ///
    /// The path is sampled at the ends of equal intervals; where the slope changes sign within one
    /// and the tangents leave room for a peak above all samples, the peak itself is found. Both ends
    /// of the path count: a jerk is often largest there.
    pub fn of(path: &Path<'_, f64>, intervals: usize) -> Self {
        let width = 1.0 / intervals as f64;
        let mut samples = Vec::with_capacity(intervals + 1);
        let peaks = path.joints().map(|joint| {
            sample(&joint, intervals, &mut samples);
            [1, 2, 3].map(|order| peak(&joint, order, &samples, width))
        });
        Self(peaks.collect())
    }

    /// All local maxima that ask for a duration not below `share` of the longest asked for.
    pub fn local(
        path: &Path<'_, f64>,
        intervals: usize,
        limits: &Limits,
        share: f64,
    ) -> Vec<LocalPeak> {
        let width = 1.0 / intervals as f64;
        let mut samples = Vec::with_capacity(intervals + 1);
        let mut asked: Vec<(LocalPeak, f64)> = Vec::new();
        for (joint, part) in path.joints().enumerate() {
            sample(&part, intervals, &mut samples);
            for order in 1..=3 {
                let limit = limits.0[joint][order - 1];
                asked.extend(local_peaks(&part, order, &samples, width).map(|peak| {
                    let place = LocalPeak { joint, order, tau: peak.tau };
                    (place, duration_asked(peak.value / limit, order))
                }));
            }
        }
        let longest = asked.iter().map(|(_, duration)| *duration).fold(0.0, f64::max);
        asked.retain(|(_, duration)| *duration >= share * longest);
        asked.into_iter().map(|(place, _)| place).collect()
    }

    /// The same path's peaks when it lasts `duration` seconds \[rad/s, rad/s², rad/s³\].
    #[must_use]
    pub fn over(&self, duration: f64) -> Self {
        let scale = [1, 2, 3].map(|order| duration.powi(order));
        let over = |peak: &Peak, scale: f64| Peak { value: peak.value / scale, ..*peak };
        Self(self.0.iter().map(|p| std::array::from_fn(|k| over(&p[k], scale[k]))).collect())
    }

    /// The shortest duration within the limits, in closed form \[s\]:
    /// `max(max|θ'|/v̄, √(max|θ''|/ā), ∛(max|θ'''|/j̄))`.
    pub fn shortest_duration(&self, limits: &Limits) -> f64 {
        let ratios = self.largest_ratio(limits).into_iter().zip(1..);
        ratios.map(|(ratio, order)| duration_asked(ratio, order)).fold(0.0, f64::max)
    }

    /// `F` of eqs. 26–28: the largest relative excess over the joints, zero when inside.
    pub fn excess(&self, limits: &Limits) -> [f64; 3] {
        self.largest_ratio(limits).map(|ratio| (ratio - 1.0).max(0.0))
    }

    fn largest_ratio(&self, limits: &Limits) -> [f64; 3] {
        let mut largest = [0.0; 3];
        for (peak, limit) in self.0.iter().zip(&limits.0) {
            for k in 0..3 {
                largest[k] = f64::max(largest[k], peak[k].value / limit[k]);
            }
        }
        largest
    }
}

/// Samples a joint's path at the ends of equal intervals.
fn sample(joint: &JointPath<'_, f64>, intervals: usize, samples: &mut Vec<Sample>) {
    let width = 1.0 / intervals as f64;
    samples.clear();
    samples.extend((0..=intervals).map(|i| joint.derivatives(i as f64 * width)));
}

/// The shortest duration \[s\] for a derivative that in one second is `ratio` times its limit:
/// `ratio^(1/order)`.
pub fn duration_asked(ratio: f64, order: usize) -> f64 {
    match order {
        1 => ratio,
        2 => ratio.sqrt(),
        _ => ratio.cbrt(),
    }
}

/// The largest absolute value of one derivative.
fn peak(joint: &JointPath<'_, f64>, order: usize, samples: &[Sample], width: f64) -> Peak {
    let sampled = samples.iter().enumerate();
    let sampled = sampled.map(|(i, s)| Peak { value: s[order].abs(), tau: i as f64 * width });
    let mut best = sampled.fold(Peak::default(), Peak::or);
    for (i, pair) in samples.windows(2).enumerate() {
        if arch_bound(&pair[0], &pair[1], order, width) > best.value {
            best = best.or(refine(joint, order, i as f64 * width, width, pair));
        }
    }
    best
}

/// The local maxima of one derivative's absolute value: those of arches between two samples, and
/// samples, the ends among them, that no neighbour exceeds.
fn local_peaks<'a>(
    joint: &'a JointPath<'_, f64>,
    order: usize,
    samples: &'a [Sample],
    width: f64,
) -> impl Iterator<Item = Peak> + 'a {
    let arches = samples.windows(2).enumerate().filter_map(move |(i, pair)| {
        let arch = arch_bound(&pair[0], &pair[1], order, width) > 0.0;
        arch.then(|| refine(joint, order, i as f64 * width, width, pair))
    });
    // Which way the magnitude goes at a sample.
    let slope = move |s: &Sample| s[order] * s[order + 1];
    let last = samples.len() - 1;
    let tops = samples.iter().enumerate().filter(move |(i, s)| {
        let falls_before =
            *i == 0 || slope(s) >= 0.0 && s[order].abs() >= samples[i - 1][order].abs();
        let falls_after =
            *i == last || slope(s) <= 0.0 && s[order].abs() >= samples[i + 1][order].abs();
        falls_before && falls_after
    });
    let tops = tops.map(move |(i, s)| Peak { value: s[order].abs(), tau: i as f64 * width });
    arches.chain(tops)
}

/// What an arch between two samples can reach at most, or zero where the slope does not turn from up
/// to down (in absolute value).
///
/// The tangents at both ends meet above any concave arch. Over an interval much wider than the
/// arch's bend it need not be concave, hence twice the tangents' rise.
fn arch_bound(left: &Sample, right: &Sample, order: usize, width: f64) -> f64 {
    let sign = if left[order] + right[order] < 0.0 { -1.0 } else { 1.0 };
    let (up, down) = (sign * left[order + 1], -sign * right[order + 1]);
    if up <= 0.0 || down <= 0.0 {
        return 0.0;
    }
    let (start, end) = (sign * left[order], sign * right[order]);
    let meeting = start + up * (end - start + down * width) / (up + down);
    let higher = start.max(end);
    higher + 2.0 * (meeting - higher)
}

/// The extreme value inside an interval whose slope changes sign: the slope's root by regula falsi
/// with the Illinois rule. The value's error is quadratic in the root's.
fn refine(
    joint: &JointPath<'_, f64>,
    order: usize,
    start: f64,
    width: f64,
    pair: &[Sample],
) -> Peak {
    let (mut a, mut b) = (start, start + width);
    let (mut slope_a, mut slope_b) = (pair[0][order + 1], pair[1][order + 1]);
    let mut best = Peak::default();
    for _ in 0..40 {
        let middle = (a * slope_b - b * slope_a) / (slope_b - slope_a);
        let sample: Sample = joint.derivatives(middle);
        best = best.or(Peak { value: sample[order].abs(), tau: middle });
        let slope = sample[order + 1];
        // What is still to gain is below slope × width.
        if slope.abs() * (b - a).abs() <= 1e-12 * best.value {
            break;
        }
        if slope * slope_b < 0.0 {
            (a, slope_a) = (b, slope_b);
        } else {
            slope_a /= 2.0;
        }
        (b, slope_b) = (middle, slope);
    }
    best
}
