//! What a motion does on its way, beside the joints' limits: how far the base turns, where it points, how fast base and tool
//! are.
//!
//! All that follows from the path's shape but for powers of the duration. With `g` a speed or a torque by normalised time, a
//! limit `ḡ` asks for a duration of `(g / ḡ)^(1/p)`, as limits of joints do: `p` is one for speeds and two for torques, since
//! the momentum is zero. Angles and distances do not depend on the duration, and what they are beyond their limits is
//! penalised.

mod heights;
mod peaks;
mod sampled;
mod slopes;
mod watched;

use super::accuracy::Accuracy;
use crate::attitude::Rollout;
use crate::task::Task;
use crate::trajectory::Family;
pub(super) use heights::Heights;
pub(super) use sampled::Sampled;
pub(super) use watched::Place;
pub use watched::Watched;
use watched::{KINDS, Kind};

/// Places along the path at which everything is looked at, at least.
const PLACES: usize = 48;

/// A local maximum along the path, or of a distance a local minimum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPeak {
    /// What is largest there.
    pub watched: Watched,
    /// How much of it there is: rad, or by normalised time rad, m or N·m s².
    pub value: f64,
    /// Where, in normalised time.
    pub tau: f64,
}

/// What the cost follows from on the way.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Way {
    /// Of every kind the duration \[s\] that it asks for, or the excess over it; zero where nothing is asked for.
    demands: [f64; KINDS.len()],
    /// The largest and the mean turn of the base \[rad\], where one of them has a weight.
    pub(super) turns: [f64; 2],
}

impl Way {
    /// Takes note of a demand.
    fn raise(&mut self, kind: Kind, demand: f64) {
        let own = &mut self.demands[kind as usize];
        *own = own.max(demand);
    }

    /// The longest duration \[s\] that a limit asks for.
    pub(super) fn duration(&self) -> f64 {
        let timed = KINDS.iter().zip(self.demands).filter(|(kind, _)| kind.power().is_some());
        timed.map(|(_, asked)| asked).fold(0.0, f64::max)
    }

    /// The excess over the limits as a sum over their kinds, of a motion that lasts so long \[s\].
    pub(super) fn excess(&self, duration: f64) -> f64 {
        let excess = |(kind, demand): (&Kind, f64)| match kind.power() {
            Some(power) => ((demand / duration).powi(power) - 1.0).max(0.0),
            None => demand,
        };
        KINDS.iter().zip(self.demands).map(excess).sum()
    }
}

/// What does not depend on the motion.
#[derive(Debug)]
pub(super) struct PathTables<F: Family> {
    rollout: Rollout<F>,
    /// One place per so many of its steps.
    stride: usize,
    watched: Vec<Watched>,
}

impl<F: Family> PathTables<F> {
    /// Nothing where the task asks for nothing on the way.
    pub(super) fn new(task: &Task, family: &F, accuracy: Accuracy) -> Option<Self> {
        let watched = Watched::all(task);
        let least = accuracy.attitude_steps.max(PLACES);
        (!watched.is_empty()).then(|| {
            let rollout = Rollout::new(family, least);
            let steps = rollout.steps();
            let strides = (1..=steps / least).rev();
            let stride =
                strides.into_iter().find(|stride| steps.is_multiple_of(*stride)).unwrap_or(1);
            Self { rollout, stride, watched }
        })
    }
}
