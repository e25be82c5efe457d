//! Whether a motion brings the base to its goal, and if it does not, whether any can.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use serde::{Serialize, Serializer};

use super::fitness::Assessment;
use crate::momentum::base_twist;
use crate::search::Rng;
use crate::task::Task;

/// Configurations within the joints' ranges at which the base's answer to the joints is looked at, and the seed that they
/// are drawn with.
const CONFIGURATIONS: usize = 512;
const SEED: u64 = 1;

/// Below this share of the largest, a turn is none.
const NOTHING: f64 = 1e-9;

/// Limits and ranges are kept where the cost's penalty is no larger: an excess of 10⁻⁶.
const KEPT: f64 = 1e-4;

/// How a motion stands to the goal's attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// It ends there, within the goal's tolerance, and keeps limits and ranges.
    Reached,
    /// It does not, and others may.
    NotFound,
    /// No motion does.
    Blocked(Block),
    /// None does within this time \[s\], for joints at their largest rates do not turn the base faster.
    TooSlow(f64),
}

/// Why no motion reaches the goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// Joints do not turn the base at all.
    NoTurn,
    /// There is one joint, so where the base ends follows from where the joint ends.
    OneJoint,
    /// All joints turn the base about the same axis, and the goal is a turn about another.
    OneAxis,
}

/// By its name.
impl Serialize for Reach {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl Reach {
    /// How a motion stands to the goal of its task, where motions of up to `longest` \[s\] were searched: only a goal that
    /// needs longer than those, and than the motion itself, is [`TooSlow`](Self::TooSlow).
    pub fn of(task: &Task, motion: &Assessment, longest: f64) -> Self {
        if motion.residual() <= task.goal_tolerance {
            return if motion.penalty() <= KEPT { Self::Reached } else { Self::NotFound };
        }
        let turns = BaseTurns::of(task);
        let turn = (task.start.base.inverse() * task.goal.base).scaled_axis();
        if let Some(block) = turns.block(&turn, task) {
            return Self::Blocked(block);
        }
        // Within the tolerance the goal is reached as well.
        let least = (turn.norm() - task.goal_tolerance) / turns.fastest;
        if least > motion.duration.max(longest) { Self::TooSlow(least) } else { Self::NotFound }
    }

    /// The name used in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::NotFound => "not-found",
            Self::Blocked(_) | Self::TooSlow(_) => "out-of-reach",
        }
    }

    /// The least time \[s\] in which the goal could be reached, where it is known to be too long.
    pub const fn least_time(self) -> Option<f64> {
        match self {
            Self::TooSlow(seconds) => Some(seconds),
            _ => None,
        }
    }
}

/// How joints at their largest rates turn the base, in base axes.
struct BaseTurns {
    joints: usize,
    /// The largest angular speed \[rad/s\].
    fastest: f64,
    /// `Σ ω ωᵀ` over joints and configurations.
    moment: Matrix3<f64>,
}

impl BaseTurns {
    fn of(task: &Task) -> Self {
        let ranges: Vec<[f64; 2]> = task.robot.joints().map(|joint| joint.range).collect();
        let joints = ranges.len();
        let mut rng = Rng::new(SEED);
        let mut turns = Self { joints, fastest: 0.0, moment: Matrix3::zeros() };
        for _ in 0..CONFIGURATIONS {
            let at: Vec<f64> = ranges.iter().map(|[from, to]| rng.uniform(*from, *to)).collect();
            let mut speed = 0.0;
            for (joint, limits) in task.limits.0.iter().enumerate() {
                let mut rates = vec![0.0; joints];
                rates[joint] = limits[0];
                let turn: Vector3<f64> = base_twist(&task.robot, &at, &rates).angular.into();
                speed += turn.norm();
                turns.moment += turn * turn.transpose();
            }
            turns.fastest = turns.fastest.max(speed);
        }
        turns
    }

    /// Why no motion turns the base so, if none does.
    fn block(&self, turn: &Vector3<f64>, task: &Task) -> Option<Block> {
        let eigen = SymmetricEigen::new(self.moment);
        let largest = eigen.eigenvalues.imax();
        let is_nothing = |value: f64| value <= NOTHING * eigen.eigenvalues[largest];
        let axis = eigen.eigenvectors.column(largest);
        let across = turn - axis * axis.dot(turn);
        match eigen.eigenvalues.iter().filter(|value| !is_nothing(**value)).count() {
            0 => Some(Block::NoTurn),
            _ if self.joints == 1 => Some(Block::OneJoint),
            1 if across.norm() > task.goal_tolerance => Some(Block::OneAxis),
            _ => None,
        }
    }
}
