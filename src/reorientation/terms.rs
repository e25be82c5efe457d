//! The terms of the cost (eqs. 25–28, 33), for all that needs them.

use crate::search::{Linearisation, Piece, Term, TimedWeights};

/// The base error that counts as one: `k_q = sin(½ · 1°)` (eq. 33; its "δ" is π).
const K_Q_DEG: f64 = 1.0;

/// `k_v = k_a = k_j`, the relative excess over a limit that counts as one (eq. 33).
const K_EXCESS: f64 = 0.01;

/// `J = K_b ‖δq_b‖ / k_q + K_t t_f + (F_v + F_a + F_j) / 0.01`, a norm, a maximum and a
/// hinge of weight one; what the others weigh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms {
    error: f64,
    duration: f64,
}

impl Terms {
    /// With `K_b`, of which `K_t` is the rest of one, and what a degree costs with sampled robots. That is added to what a degree
    /// costs with the robot itself, or that one would be kept off its goal to bring others nearer.
    pub(super) fn new(base_weight: f64, robust_weight: f64) -> Self {
        Self { error: Self::error_weight(base_weight + robust_weight), duration: 1.0 - base_weight }
    }

    /// `J` of a motion: `‖δq_b‖`, its duration \[s\] and its excess over limits, ranges and what else is limited.
    pub(super) fn cost(
        &self,
        error: f64,
        duration: f64,
        excess: &[f64; 3],
        range_excess: f64,
    ) -> f64 {
        self.error * error + self.duration * duration + penalty(excess, range_excess)
    }

    /// The penalty of the largest excess among pieces.
    pub(super) fn excess(pieces: Vec<Piece>) -> Term {
        Term::max(1.0 / K_EXCESS, pieces).at_least(0.0)
    }

    /// What the largest and the mean turn on the way \[rad\] add to the cost, where a degree of each adds so much.
    pub(super) fn turns(weights: &[f64; 2], turns: &[f64; 2]) -> f64 {
        weights.iter().zip(turns).map(|(weight, turn)| weight.to_degrees() * turn).sum()
    }

    /// What turns of the base on the way \[rad\] add to the cost, where a degree adds so much.
    pub(super) fn turn(weight: f64, turns: Vec<Piece>) -> Term {
        Term::max(weight.to_degrees(), turns).at_least(0.0)
    }

    /// What errors of the base with sampled robots add to the cost, where they weigh so much beside the base's own.
    pub(super) fn robust(weight: f64, errors: Vec<Piece>) -> Term {
        Term::max(Self::error_weight(weight), errors).at_least(0.0)
    }

    /// What `‖δq_b‖` costs where a degree costs so much.
    pub(super) fn error_weight(weight: f64) -> f64 {
        weight / (K_Q_DEG.to_radians() / 2.0).sin()
    }

    /// What time, the error and the excess over the joints' ranges weigh.
    pub(super) fn timed(&self) -> TimedWeights {
        TimedWeights { time: self.duration, error: self.error, excess: 1.0 / K_EXCESS }
    }

    /// The terms over smooth pieces: the components of the error, and the duration \[s\] that each limit
    /// asks for.
    pub(super) fn time_free(&self, error: Vec<Piece>, durations: Vec<Piece>) -> Linearisation {
        // Such a duration leaves no excess.
        Linearisation::new(vec![
            Term::norm(self.error, error),
            Term::max(self.duration, durations).at_least(0.0),
        ])
    }
}

/// The last term, of the excess `F` of eqs. 26–28 and that over the joints' ranges, which the paper's family never leaves.
pub(super) fn penalty(excess: &[f64; 3], range_excess: f64) -> f64 {
    (excess.iter().sum::<f64>() + range_excess) / K_EXCESS
}
