//! At which times a motion is sampled.

/// Intervals between the samples of an exported motion.
pub const INTERVALS: usize = 500;

/// Most samples of a motion, as many as `replay` reads.
pub const MOST_SAMPLES: usize = 1_000_000;

/// The least share of a step that the last one may be: polynomials between samples that are closer have jerks made of rounding.
const LEAST_STEP: f64 = 0.1;

/// At which times a motion is sampled, from its start to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// In so many equal intervals.
    Intervals(usize),
    /// At all multiples of a step, given as steps per second, and at the end. A multiple less than a tenth of a step before the end
    /// is left out.
    Rate(f64),
}

/// A motion that would have too many samples.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "found {rate:?} samples per second of a motion of {duration:.3} s, expected {MOST_SAMPLES} samples or fewer: {:.0} per second at most", 
    .most.floor()
)]
pub struct TooManySamples {
    rate: f64,
    duration: f64,
    most: f64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self::Intervals(INTERVALS)
    }
}

impl From<usize> for Sampling {
    fn from(intervals: usize) -> Self {
        Self::Intervals(intervals)
    }
}

impl Sampling {
    /// So many samples per second; none unless that is finite and above zero.
    pub fn of_rate(rate: f64) -> Option<Self> {
        (rate > 0.0 && rate.is_finite()).then_some(Self::Rate(rate))
    }

    /// So many seconds between samples; none unless that is finite and above zero.
    pub fn of_step(seconds: f64) -> Option<Self> {
        let rate = 1.0 / seconds;
        // Hundredths of a second are told with two digits where they are 1 / 100, 2 / 100, ….
        let is_whole = (rate - rate.round()).abs() <= 4.0 * f64::EPSILON * rate;
        Self::of_rate(if is_whole { rate.round() } else { rate }).filter(|_| seconds.is_finite())
    }

    /// Refuses more samples than [`MOST_SAMPLES`].
    pub fn check(self, duration: f64) -> Result<(), TooManySamples> {
        let most = (MOST_SAMPLES - 2) as f64 / duration;
        match self {
            Self::Rate(rate) if rate * duration > (MOST_SAMPLES - 2) as f64 => {
                Err(TooManySamples { rate, duration, most })
            }
            _ => Ok(()),
        }
    }

    /// How many equal intervals there are, and which share of the duration they take; the rest is one interval more.
    pub(super) fn grid(self, duration: f64) -> (usize, f64) {
        match self {
            Self::Intervals(intervals) => (intervals, 1.0),
            Self::Rate(rate) => {
                let intervals = (duration * rate - LEAST_STEP).floor().max(0.0);
                (intervals as usize, intervals / (rate * duration))
            }
        }
    }

    /// The times \[s\] in a motion of that duration \[s\].
    pub fn times(self, duration: f64) -> Vec<f64> {
        let (intervals, _) = self.grid(duration);
        let time = |i: usize| match self {
            Self::Intervals(_) => duration * (i as f64 / intervals as f64),
            Self::Rate(rate) => i as f64 / rate,
        };
        let end = matches!(self, Self::Rate(_)).then_some(duration);
        (0..=intervals).map(time).chain(end).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_sample_is_the_end() {
        for (sampling, duration, count, before_last) in [
            (Sampling::Intervals(4), 6.0, 5, 4.5),
            (Sampling::Rate(100.0), 1.0, 101, 0.99),
            (Sampling::Rate(100.0), 1.0005, 101, 0.99),
            (Sampling::Rate(100.0), 1.002, 102, 1.0),
            (Sampling::Rate(0.1), 3.0, 2, 0.0),
            (Sampling::Rate(0.5), 7.0, 5, 6.0),
        ] {
            let times = sampling.times(duration);
            let last = times.len() - 1;
            assert_eq!((times[0], times[last]), (0.0, duration), "{sampling:?}");
            assert_eq!((times.len(), times[last - 1]), (count, before_last), "{sampling:?}");
        }
        let times = Sampling::of_step(0.01).unwrap().times(0.5);
        assert_eq!(times[7], 0.07);
    }

    #[test]
    fn steps_are_above_zero() {
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!((Sampling::of_step(wrong), Sampling::of_rate(wrong)), (None, None));
        }
        assert_eq!(Sampling::of_step(1e-320), None);
        assert_eq!(Sampling::of_step(0.02), Some(Sampling::Rate(50.0)));
    }

    #[test]
    fn samples_are_limited() {
        let sampling = Sampling::Rate(1e6);
        assert!(sampling.check(0.99).is_ok());
        assert_eq!(
            sampling.check(8.0).unwrap_err().to_string(),
            "found 1000000.0 samples per second of a motion of 8.000 s, expected 1000000 samples or fewer: 124999 per second at \
             most"
        );
        assert!(Sampling::Rate(MOST_SAMPLES as f64).times(0.999_998).len() <= MOST_SAMPLES);
    }
}
