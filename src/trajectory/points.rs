//! Paths through given points, as controllers of robots play them.

use std::borrow::Cow;

use super::bernstein::Bernstein;
use super::peaks::{Peak, Peaks};

/// What lies between two points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight lines between positions: rates jump at points.
    Linear,
    /// Cubics with the points' rates: accelerations jump.
    Cubic,
    /// Quintics with the points' rates and accelerations.
    Quintic,
}

/// Positions \[rad or m\] of all joints at given times \[s\], perhaps with rates and accelerations.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    start: f64,
    times: Vec<f64>,
    joints: usize,
    /// Positions, rates and accelerations, point by point; empty where none are given.
    values: [Vec<f64>; 3],
}

/// A path through points: one polynomial per joint between each two of them.
#[derive(Debug, Clone)]
pub struct PointPath<'a> {
    points: &'a Points,
    rates: Cow<'a, [f64]>,
    interpolation: Interpolation,
}

/// The least and the largest position of a joint, and when \[s\] it is there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Position \[rad or m\].
    pub position: [f64; 2],
    /// Time since the first point \[s\].
    pub at: [f64; 2],
}

/// By how much a derivative jumps at one of the points, or between a start or an end and standing still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Index of the joint.
    pub joint: usize,
    /// Index of the point.
    pub point: usize,
    /// Change of rate \[rad/s or m/s\] and acceleration \[rad/s² or m/s²\].
    pub by: [f64; 2],
}

impl Points {
    /// Points at times that grow, at least two, with a position of each joint at each of them; rates and accelerations
    /// are of all points or none, and accelerations stand beside rates only.
    pub(crate) fn new(times: Vec<f64>, joints: usize, values: [Vec<f64>; 3]) -> Self {
        let start = times[0];
        let times = times.into_iter().map(|time| time - start).collect();
        Self { start, times, joints, values }
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.times.len()
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// The time of the first point, as given \[s\].
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Times since the first point \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// From the first point to the last \[s\].
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Positions \[rad or m\] at a point.
    pub fn positions(&self, point: usize) -> &[f64] {
        &self.values[0][point * self.joints..(point + 1) * self.joints]
    }

    /// The interpolation of `ros2_control`'s `joint_trajectory_controller`: the smoothest that what is given allows.
    pub fn interpolation(&self) -> Interpolation {
        match &self.values {
            [_, rates, _] if rates.is_empty() => Interpolation::Linear,
            [_, _, accelerations] if accelerations.is_empty() => Interpolation::Cubic,
            _ => Interpolation::Quintic,
        }
    }

    /// The path that the controller plays.
    pub fn played(&self) -> PointPath<'_> {
        let rates = Cow::Borrowed(&*self.values[1]);
        PointPath { points: self, rates, interpolation: self.interpolation() }
    }

    /// The path with this interpolation, if the points have what it takes.
    pub fn path(&self, interpolation: Interpolation) -> Option<PointPath<'_>> {
        let is_given = interpolation as usize <= self.interpolation() as usize;
        is_given.then(|| PointPath { interpolation, ..self.played() })
    }

    /// The cubic spline through the positions alone with a continuous acceleration, at rest at both ends.
    pub fn smooth(&self) -> PointPath<'_> {
        let rates = Cow::Owned(self.spline_rates());
        PointPath { points: self, rates, interpolation: Interpolation::Cubic }
    }

    /// Rates at which accelerations before and behind every point are equal: a tridiagonal system for each joint, by
    /// elimination without pivots, which its dominant diagonal allows.
    fn spline_rates(&self) -> Vec<f64> {
        let (count, joints) = (self.count(), self.joints);
        let positions = &self.values[0];
        let mut rates = vec![0.0; positions.len()];
        let mut ratios = vec![0.0; count];
        for i in 1..count - 1 {
            let [before, behind] = [i, i + 1].map(|i| (self.times[i] - self.times[i - 1]).recip());
            let pivot = 2.0 * (before + behind) - before * ratios[i - 1];
            ratios[i] = behind / pivot;
            for at in i * joints..(i + 1) * joints {
                let rise = (positions[at] - positions[at - joints]) * before * before;
                let next_rise = (positions[at + joints] - positions[at]) * behind * behind;
                rates[at] = (3.0 * (rise + next_rise) - before * rates[at - joints]) / pivot;
            }
        }
        for i in (1..count - 1).rev() {
            for at in i * joints..(i + 1) * joints {
                rates[at] -= ratios[i] * rates[at + joints];
            }
        }
        rates
    }
}

impl PointPath<'_> {
    /// The points.
    pub fn points(&self) -> &Points {
        self.points
    }

    /// What lies between them.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Number of polynomials per joint.
    pub fn segments(&self) -> usize {
        self.points.count() - 1
    }

    /// How long a segment takes \[s\].
    pub fn width(&self, segment: usize) -> f64 {
        self.points.times[segment + 1] - self.points.times[segment]
    }

    /// A joint's position by the share of the segment that has passed.
    fn polynomial(&self, segment: usize, joint: usize) -> Bernstein {
        let width = self.width(segment);
        let ends = [segment, segment + 1].map(|point| point * self.points.joints + joint);
        let [p, q] = ends.map(|end| self.points.values[0][end]);
        if self.interpolation == Interpolation::Linear {
            return Bernstein::new([p, q, 0.0, 0.0, 0.0, 0.0], 1);
        }
        let [v, w] = ends.map(|end| self.rates[end] * width);
        if self.interpolation == Interpolation::Cubic {
            return Bernstein::new([p, p + v / 3.0, q - w / 3.0, q, 0.0, 0.0], 3);
        }
        let [a, b] = ends.map(|end| self.points.values[2][end] * width * width);
        let (inner, outer) = (p + 0.4 * v + a / 20.0, q - 0.4 * w + b / 20.0);
        Bernstein::new([p, p + v / 5.0, inner, outer, q - w / 5.0, q], 5)
    }

    /// A joint's position and first three derivatives \[rad or m, s\] where a share of the segment has passed.
    pub fn derivatives(&self, segment: usize, joint: usize, share: f64) -> [f64; 4] {
        let (mut polynomial, per_width) =
            (self.polynomial(segment, joint), self.width(segment).recip());
        let mut scale = 1.0;
        std::array::from_fn(|_| {
            let value = polynomial.value(share) * scale;
            polynomial = polynomial.derivative();
            scale *= per_width;
            value
        })
    }

    /// All joints' positions, and their rates by the share of the segment that has passed.
    pub fn write(&self, segment: usize, share: f64, positions: &mut [f64], rates: &mut [f64]) {
        for (joint, (position, rate)) in positions.iter_mut().zip(rates).enumerate() {
            let polynomial = self.polynomial(segment, joint);
            *position = polynomial.value(share);
            *rate = polynomial.derivative().value(share);
        }
    }

    /// What no joint exceeds in going to and fro on a segment \[rad or m\].
    pub fn reach(&self, segment: usize) -> f64 {
        let joints = 0..self.points.joints;
        let reach = |joint| self.polynomial(segment, joint).derivative().largest();
        joints.map(reach).fold(0.0, f64::max)
    }

    /// The segment in which a time since the first point \[s\] lies, and the share of it that has passed.
    pub fn place(&self, time: f64) -> (usize, f64) {
        let behind = self.points.times.partition_point(|&other| other <= time);
        let segment = behind.saturating_sub(1).min(self.segments() - 1);
        (segment, (time - self.points.times[segment]) / self.width(segment))
    }

    /// Largest rate, acceleration and jerk of each joint between the points; what jumps at them is in
    /// [`jumps`](Self::jumps).
    pub fn peaks(&self) -> Peaks {
        let mut peaks = vec![[Peak::default(); 3]; self.points.joints];
        for segment in 0..self.segments() {
            let per_width = self.width(segment).recip();
            for (joint, own) in peaks.iter_mut().enumerate() {
                let mut polynomial = self.polynomial(segment, joint);
                let mut scale = 1.0;
                for peak in own {
                    polynomial = polynomial.derivative();
                    scale *= per_width;
                    if polynomial.largest() * scale > peak.value {
                        for share in polynomial.turns().into_iter().chain([0.0, 1.0]) {
                            let value = polynomial.value(share).abs() * scale;
                            *peak = peak.or(Peak { value, tau: self.tau(segment, share) });
                        }
                    }
                }
            }
        }
        Peaks(peaks)
    }

    fn tau(&self, segment: usize, share: f64) -> f64 {
        self.time(segment, share) / self.points.duration()
    }

    fn time(&self, segment: usize, share: f64) -> f64 {
        self.points.times[segment] + share * self.width(segment)
    }

    /// How far each joint goes.
    pub fn extents(&self) -> Vec<Extent> {
        let start = |&position| Extent { position: [position; 2], at: [0.0; 2] };
        let mut extents: Vec<Extent> = self.points.positions(0).iter().map(start).collect();
        for segment in 0..self.segments() {
            for (joint, extent) in extents.iter_mut().enumerate() {
                let polynomial = self.polynomial(segment, joint);
                let [least, most] = polynomial.hull();
                if least >= extent.position[0] && most <= extent.position[1] {
                    continue;
                }
                for share in polynomial.turns().into_iter().chain([1.0]) {
                    let (position, at) = (polynomial.value(share), self.time(segment, share));
                    for (side, is_further) in
                        [(0, position < extent.position[0]), (1, position > extent.position[1])]
                    {
                        if is_further {
                            (extent.position[side], extent.at[side]) = (position, at);
                        }
                    }
                }
            }
        }
        extents
    }

    /// Calls `each` for every joint at every point; before the first and behind the last it stands still.
    pub fn jumps(&self, mut each: impl FnMut(Jump)) {
        let mut before = vec![[0.0; 2]; self.points.joints];
        for point in 0..=self.segments() {
            for (joint, before) in before.iter_mut().enumerate() {
                let at = |segment, share| {
                    let [_, rate, acceleration, _] = self.derivatives(segment, joint, share);
                    [rate, acceleration]
                };
                let behind = if point < self.segments() { at(point, 0.0) } else { [0.0; 2] };
                each(Jump { joint, point, by: [behind[0] - before[0], behind[1] - before[1]] });
                if point < self.segments() {
                    *before = at(point, 1.0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates and accelerations of `sin t`, whose error in a quintic is of the sixth order.
    #[test]
    fn quintics_follow_a_sine() {
        let times: Vec<f64> = (0..=20).map(|i| 0.3 * f64::from(i)).collect();
        let values =
            [f64::sin, f64::cos, |t: f64| -t.sin()].map(|f| times.iter().map(|&t| f(t)).collect());
        let points = Points::new(times, 1, values);
        let path = points.path(Interpolation::Quintic).unwrap();
        let (segment, share) = path.place(2.2);
        assert_eq!(segment, 7);
        let t: f64 = 2.2;
        let found = path.derivatives(segment, 0, share);
        for (found, expected) in found.iter().zip([t.sin(), t.cos(), -t.sin(), -t.cos()]) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
        let [rate, acceleration, _] = path.peaks().0[0];
        assert!((rate.value - 1.0).abs() < 1e-9 && rate.tau == 0.0, "{rate:?}");
        assert!((acceleration.value - 1.0).abs() < 1e-5, "{acceleration:?}");
        let [extent] = path.extents()[..] else { panic!() };
        for (side, sign) in [(1, 1.0), (0, -1.0)] {
            assert!((extent.position[side] - sign).abs() < 1e-7, "{extent:?}");
        }
        assert!((extent.at[1] - std::f64::consts::FRAC_PI_2).abs() < 1e-4, "{extent:?}");
    }

    /// By SciPy 1.17: `CubicSpline([0, 1, 1.5, 3], [0, 1, 0.5, 2], bc_type='clamped')(x, 1)` at its points, and the value at 2.
    #[test]
    fn the_smooth_path_is_the_clamped_spline() {
        let points = Points::new(
            vec![5.0, 6.0, 6.5, 8.0],
            1,
            [vec![0.0, 1.0, 0.5, 2.0], Vec::new(), Vec::new()],
        );
        let path = points.smooth();
        let expected = [0.0, -0.285_714_285_714_285_7, -0.642_857_142_857_142_9, 0.0];
        for (found, expected) in path.rates.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{:?}", path.rates);
        }
        let (segment, share) = path.place(2.0);
        assert!((path.derivatives(segment, 0, share)[0] - 0.746_031_746_031_745_9).abs() < 1e-14);
        path.jumps(|jump| {
            let is_inner = (1..3).contains(&jump.point);
            assert!(
                jump.by[0].abs() < 1e-14 && (!is_inner || jump.by[1].abs() < 1e-13),
                "{jump:?}"
            );
        });
    }

    /// A line through three points: its rates, and where they jump.
    #[test]
    fn lines_jump() {
        let points =
            Points::new(vec![0.0, 1.0, 3.0], 1, [vec![0.0, 1.0, 0.0], Vec::new(), Vec::new()]);
        assert_eq!(points.interpolation(), Interpolation::Linear);
        assert!(points.path(Interpolation::Cubic).is_none());
        let path = points.path(Interpolation::Linear).unwrap();
        let mut jumps = Vec::new();
        path.jumps(|jump| jumps.push(jump.by[0]));
        assert_eq!(jumps, [1.0, -1.5, 0.5]);
        assert_eq!(path.peaks().0[0][0], Peak { value: 1.0, tau: 0.0 });
    }
}
