//! What methods share that move a whole population at once.

use super::places::{rank, uniform_point};
use crate::search::{Evaluation, Oracle, Points, Rng, Stop};

/// Points and what is known of them.
pub(super) struct Population {
    pub(super) points: Points,
    /// Costs to compare by; see [`rank`].
    pub(super) costs: Vec<f64>,
}

impl Population {
    /// Evaluates so many points drawn uniformly from the box.
    pub(super) fn scatter(
        count: usize,
        oracle: &mut Oracle<'_>,
        rng: &mut Rng,
    ) -> Result<Self, Stop> {
        let mut points = Points::zeros(oracle.bounds().len(), count);
        points.iter_mut().for_each(|x| uniform_point(oracle, rng, x));
        Self::evaluate(points, oracle)
    }

    /// Evaluates these points.
    pub(super) fn evaluate(points: Points, oracle: &mut Oracle<'_>) -> Result<Self, Stop> {
        let mut evaluations = vec![Evaluation::default(); points.len()];
        oracle.evaluate_batch(&points, &mut evaluations)?;
        Ok(Self { points, costs: evaluations.iter().map(rank).collect() })
    }

    pub(super) fn len(&self) -> usize {
        self.costs.len()
    }

    /// Puts another population's point in a place of this one.
    pub(super) fn take(&mut self, place: usize, other: &Self, from: usize) {
        self.points[place].copy_from_slice(&other.points[from]);
        self.costs[place] = other.costs[from];
    }

    /// The places, lowest cost first; of equal costs the earlier place first.
    pub(super) fn ranking(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..self.len()).collect();
        places.sort_by(|&a, &b| self.costs[a].total_cmp(&self.costs[b]));
        places
    }
}

/// An index below `count` that is none of `taken`; of those some must be left.
pub(super) fn index_besides(taken: &[usize], count: usize, rng: &mut Rng) -> usize {
    loop {
        let index = rng.index(count);
        if !taken.contains(&index) {
            return index;
        }
    }
}
