//! Random numbers, the same for the same seed; uniform ones and indices to the last bit on every
//! machine, normal and Cauchy ones as far as its mathematics library agrees.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};
use rand_distr::{Distribution as _, StandardNormal};

/// A stream of random numbers, fixed by its seed.
#[derive(Debug, Clone)]
pub struct Rng {
    seed: u64,
    stream: ChaCha8Rng,
}

impl Rng {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Self {
        Self { seed, stream: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Uniform in `[0, 1)`, all 53 bits of the mantissa used.
    pub fn unit(&mut self) -> f64 {
        (self.stream.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in `[lower, upper)`.
    pub fn uniform(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * self.unit()
    }

    /// A whole number from 0 to `count − 1`, each as likely.
    pub fn index(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Normal, with mean 0 and standard deviation 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.stream)
    }

    /// Cauchy, with mode and median at `location` and quartiles `scale` away from it.
    pub fn cauchy(&mut self, location: f64, scale: f64) -> f64 {
        location + scale * (std::f64::consts::PI * (self.unit() - 0.5)).tan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of 100 000 draws for which `holds`; its standard deviation is below 0.0016.
    fn share(mut holds: impl FnMut(&mut Rng) -> bool) -> f64 {
        let mut rng = Rng::new(5);
        (0..100_000).filter(|_| holds(&mut rng)).count() as f64 / 1e5
    }

    /// Shares from tables of the distributions; four standard deviations of room.
    #[test]
    fn draws_are_distributed_as_named() {
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 0.0064, "{found} is not {expected}");
        };
        near(share(|rng| rng.normal().abs() < 1.0), 0.682_69);
        near(share(|rng| rng.normal() < -1.644_85), 0.05);
        near(share(|rng| (rng.cauchy(3.0, 0.1) - 3.0).abs() < 0.1), 0.5);
        near(share(|rng| rng.cauchy(0.0, 1.0) > 3.077_68), 0.1);
        for face in 0..6 {
            near(share(|rng| rng.index(6) == face), 1.0 / 6.0);
        }
    }
}
