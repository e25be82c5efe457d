//! Random numbers for the tests.

mod robots;
mod shapes;

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};

struct Random(ChaCha8Rng);

impl Random {
    fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    fn within(&mut self, limit: f64) -> f64 {
        (self.0.next_u64() as f64 / u64::MAX as f64 * 2.0 - 1.0) * limit
    }

    fn index(&mut self, count: u64) -> u64 {
        self.0.next_u64() % count
    }

    fn vector(&mut self, limit: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.within(limit))
    }
}
