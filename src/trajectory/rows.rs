//! Whose coefficients joints have.

use crate::robot::Follow;

/// Of every joint whose coefficients its path has: its own, or those of the joint that it follows.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    of_joint: Vec<usize>,
    leading: Vec<usize>,
    /// One per joint; empty where none follows another one.
    follows: Vec<Option<Follow>>,
}

impl Rows {
    /// Each of so many joints has its own.
    pub(super) fn own(joints: usize) -> Self {
        let all: Vec<usize> = (0..joints).collect();
        Self { of_joint: all.clone(), leading: all, follows: Vec::new() }
    }

    /// Those of joints of which some follow others.
    pub(super) fn following(follows: &[Option<Follow>]) -> Self {
        let is_leading = |joint: &usize| follows[*joint].is_none();
        let leading: Vec<usize> = (0..follows.len()).filter(is_leading).collect();
        if leading.len() == follows.len() {
            return Self::own(follows.len());
        }
        let row = |(joint, follow): (usize, &Option<Follow>)| {
            let leader = follow.map_or(joint, |follow| follow.leader);
            assert!(follows[leader].is_none(), "leaders that follow no other joint");
            leading.partition_point(|&before| before < leader)
        };
        let of_joint = follows.iter().enumerate().map(row).collect();
        Self { of_joint, leading, follows: follows.to_vec() }
    }

    /// Number of joints.
    pub(super) fn joints(&self) -> usize {
        self.of_joint.len()
    }

    /// Rows of coefficients.
    pub(super) fn count(&self) -> usize {
        self.leading.len()
    }

    /// The row that a joint has.
    #[inline(always)]
    pub(super) fn of(&self, joint: usize) -> usize {
        self.of_joint[joint]
    }

    /// The joints that have rows of their own.
    pub(super) fn leading(&self) -> &[usize] {
        &self.leading
    }

    /// How a joint follows another one, if it does.
    #[inline(always)]
    pub(super) fn follow(&self, joint: usize) -> Option<Follow> {
        self.follows.get(joint).copied().flatten()
    }
}
