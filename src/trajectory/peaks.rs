//! The largest rate, acceleration and jerk over continuous time, and the duration they allow.

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
#[derive(Debug, Clone, PartialEq)]
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

impl Peaks {
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
        longest_asked(limits.largest_ratio(self.heights()))
    }

    /// `F` of eqs. 26–28: the largest relative excess over the joints, zero when inside.
    pub fn excess(&self, limits: &Limits) -> [f64; 3] {
        excess(limits.largest_ratio(self.heights()))
    }

    fn heights(&self) -> impl Iterator<Item = [f64; 3]> {
        self.0.iter().map(|peaks| peaks.map(|peak| peak.value))
    }
}

impl Limits {
    /// Of each order the largest value as a multiple of its limit, from the joints' values.
    #[inline(always)]
    pub(super) fn largest_ratio(&self, values: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
        let mut largest = [0.0; 3];
        for (value, limit) in values.zip(&self.0) {
            for k in 0..3 {
                largest[k] = f64::max(largest[k], value[k] / limit[k]);
            }
        }
        largest
    }
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

/// The longest duration that rate, acceleration and jerk ask for.
pub fn longest_asked(ratios: [f64; 3]) -> f64 {
    let asked = ratios.into_iter().zip(1..).map(|(ratio, order)| duration_asked(ratio, order));
    asked.fold(0.0, f64::max)
}

/// First to third power of a duration: what rate, acceleration and jerk over it are divided by.
pub fn powers(duration: f64) -> [f64; 3] {
    [duration, duration * duration, duration * duration * duration]
}

/// `F` of eqs. 26–28 from the largest multiples of the limits.
pub fn excess(ratios: [f64; 3]) -> [f64; 3] {
    ratios.map(|ratio| (ratio - 1.0).max(0.0))
}
