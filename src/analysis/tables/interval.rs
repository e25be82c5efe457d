//! Bootstrap intervals as the tables have them.

use crate::analysis::statistics::Bootstrap;
use crate::search::Rng;

/// Level of the bootstrap's intervals.
const LEVEL: f64 = 0.95;

/// The bootstrap's interval of a statistic: 1000 resamples; of a sample of more than 1000, as many as
/// make a million draws, 400 at least.
pub(super) fn interval<T: Copy>(sample: &[T], statistic: impl Fn(&[T]) -> f64) -> [f64; 2] {
    let resamples = (1_000_000 / sample.len().max(1)).clamp(400, 1000);
    let mut rng = Rng::new(1);
    let draw = |count| rng.index(count);
    Bootstrap { level: LEVEL, resamples }.interval(sample, statistic, draw)
}
