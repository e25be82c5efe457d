//! How far a robot reaches, and configurations that it can have.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng};

use super::link::Joint;
use super::tree::Robot;

/// Uniform in `[0, 1)`, all 53 bits of the mantissa used.
pub(crate) fn unit(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

impl Robot {
    /// Random configurations within the joints' ranges \[rad or m\], the same ones every time. Joints that follow others are where
    /// these put them.
    pub(crate) fn random_configurations(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        std::iter::repeat_with(move || {
            let position = |[lower, upper]: [f64; 2]| lower + (upper - lower) * unit(&mut random);
            let mut positions: Vec<f64> =
                self.joints().map(|joint| joint.range).map(position).collect();
            self.place_followers(&mut positions);
            positions
        })
    }

    /// How far from its mount the robot reaches when it is stretched out \[m\]; one where nothing is known of that.
    pub(crate) fn reach(&self) -> f64 {
        let mut reaches: Vec<f64> = Vec::with_capacity(self.links().len());
        for link in self.links() {
            let slide = match &link.joint {
                Joint::Prismatic(axis) => {
                    axis.range.iter().fold(0.0, |most: f64, end| most.max(end.abs()))
                }
                _ => 0.0,
            };
            let inner =
                link.parent.map(|parent| reaches[parent] + link.placement.translation().norm());
            reaches.push(inner.unwrap_or_default() + slide);
        }
        let tool = self.tool();
        let at_tool = tool.link.map(|link| reaches[link] + tool.placement.translation().norm());
        let most = reaches.into_iter().chain(at_tool).fold(0.0, f64::max);
        if most > 0.0 { most } else { 1.0 }
    }
}
