//! Joints that follow others: they move as these do, as fingers of a gripper or wheels on a gear.

/// How a joint follows another one: it is at `multiplier` times that one's position and `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follow {
    /// Index of the other joint, which follows none.
    pub leader: usize,
    /// Of radians and metres; not zero.
    pub multiplier: f64,
    /// Where it is when the other joint is at zero \[rad or m\].
    pub offset: f64,
}

impl Follow {
    /// Where the joint is when the other one is at a position \[rad or m\].
    pub fn position(&self, leader: f64) -> f64 {
        self.multiplier * leader + self.offset
    }

    /// How a joint follows that leads so a joint which follows this way.
    pub(super) fn through(&self, next: &Self) -> Self {
        Self {
            leader: next.leader,
            multiplier: self.multiplier * next.multiplier,
            offset: self.position(next.offset),
        }
    }

    /// Positions of the other joint that keep this one within its range.
    pub(super) fn allowed(&self, range: [f64; 2]) -> [f64; 2] {
        ordered(range.map(|end| (end - self.offset) / self.multiplier))
    }

    /// The joint's positions where the other one is within a range.
    pub(super) fn reached(&self, range: [f64; 2]) -> [f64; 2] {
        ordered(range.map(|end| self.position(end)))
    }
}

fn ordered([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}
