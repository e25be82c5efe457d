//! The terms of the cost (eqs. 25–28, 33), for all that needs them.

use crate::search::{Linearisation, Piece, Shape, Term};

/// The base error that counts as one: `k_q = sin(½ · 1°)` (eq. 33; its "δ" is π).
const K_Q_DEG: f64 = 1.0;

/// `k_v = k_a = k_j`, the relative excess over a limit that counts as one (eq. 33).
const K_EXCESS: f64 = 0.01;

/// `J = K_b ‖δq_b‖ / k_q + K_t t_f + (F_v + F_a + F_j) / 0.01`, a norm, a maximum and a hinge.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms([(Shape, f64); 3]);

impl Terms {
    /// With `K_b`; `K_t` is the rest of one.
    pub(super) fn new(base_weight: f64) -> Self {
        let k_q = (K_Q_DEG.to_radians() / 2.0).sin();
        Self([
            (Shape::Norm, base_weight / k_q),
            (Shape::Max, 1.0 - base_weight),
            // Of excesses in the unit that counts as one.
            (Shape::Hinge, 1.0),
        ])
    }

    /// `J` of a motion: `‖δq_b‖`, its duration \[s\] and its excess over the limits.
    pub(super) fn cost(&self, error: f64, duration: f64, excess: &[f64; 3]) -> f64 {
        let [(_, error_weight), (_, time_weight), (_, excess_weight)] = self.0;
        error_weight * error + time_weight * duration + excess_weight * penalty(excess)
    }

    /// The terms over smooth pieces: the components of the error, and the duration \[s\] that each limit
    /// asks for. Within the limits the last one is nothing.
    pub(super) fn time_free(&self, error: Vec<Piece>, durations: Vec<Piece>) -> Linearisation {
        let terms = self.0.into_iter().zip([error, durations]);
        let term = |((shape, weight), pieces)| Term { weight, shape, pieces };
        Linearisation { terms: terms.map(term).collect() }
    }
}

/// The last term, of the excess `F` of eqs. 26–28.
pub(super) fn penalty(excess: &[f64; 3]) -> f64 {
    excess.iter().sum::<f64>() / K_EXCESS
}
