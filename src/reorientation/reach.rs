//! Whether a motion brings the base to its goal, and if it does not, whether any can.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Matrix3xX, SymmetricEigen, UnitQuaternion, Vector3};
use serde::{Serialize, Serializer};

use super::fitness::{Assessment, Reorientation};
use crate::attitude::increments;
use crate::momentum::base_twist;
use crate::search::Rng;
use crate::task::Task;
use crate::trajectory::Family;

/// Configurations within the joints' ranges at which the base's answer to the joints is looked at, and the seed that they
/// are drawn with.
const CONFIGURATIONS: usize = 512;
const SEED: u64 = 1;

/// Below this share of the largest, a turn is none.
const NOTHING: f64 = 1e-12;

/// Loops of the joints, steps round each, and the share of all turns on the way up to which the base has come back.
const LOOPS: usize = 8;
const LOOP_STEPS: usize = 256;
const RETURNS: f64 = 1e-8;

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
    /// None does within about this time \[s\], for joints at their largest rates do not turn the base faster.
    TooSlow(f64),
}

/// Why no motion reaches the goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Block {
    /// Joints do not turn the base at all.
    NoTurn,
    /// Where the base ends follows from where the joints end, however they go there: with one joint, or with wheels.
    Holonomic,
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
        if motion.is_within(task.goal_tolerance) {
            return if Self::keeps_limits(motion) { Self::Reached } else { Self::NotFound };
        }
        if task.angular_momentum.is_some() {
            // Momentum turns the base as well.
            return Self::NotFound;
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

    /// Whether a motion keeps all limits on rates, accelerations and jerks, and all joints' ranges.
    pub fn keeps_limits(motion: &Assessment) -> bool {
        motion.penalty() <= KEPT
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

/// Steps of coefficients for differences, and shares of the way to where the error would vanish that are tried.
const DIFFERENCE: f64 = 1e-6;
const SHARES: [f64; 4] = [1.0, 0.5, 0.2, 0.05];

impl<F: Family> Reorientation<F> {
    /// Whether motions beside this one end nearer to the goal. At the end of a search they were passed over for their time.
    pub fn is_held_by_time(&self, coefficients: &[f64], duration: f64) -> bool {
        let error = |c: &[f64]| self.error_after(self.rotation_over(c, duration)).scaled_axis();
        let here = error(coefficients);
        let mut slopes = Matrix3xX::zeros(coefficients.len());
        let mut there = coefficients.to_vec();
        for (k, mut column) in slopes.column_iter_mut().enumerate() {
            there[k] = coefficients[k] + DIFFERENCE;
            column.copy_from(&((error(&there) - here) / DIFFERENCE));
            there[k] = coefficients[k];
        }
        let Ok(inverse) = slopes.pseudo_inverse(NOTHING) else { return false };
        let step = inverse * here;
        SHARES.iter().any(|share| {
            let moved: Vec<f64> =
                coefficients.iter().zip(&step).map(|(c, step)| c - share * step).collect();
            error(&moved).norm() < (1.0 - share / 2.0) * here.norm()
        })
    }
}

/// How joints turn the base, in base axes.
struct BaseTurns {
    /// The largest angular speed that joints at their largest rates give it \[rad/s\], as far as a random search has found.
    fastest: f64,
    /// `Σ n nᵀ` over joints that turn the base at all, and configurations, where `n` is the turn by the joint as a share of its largest.
    moment: Matrix3<f64>,
}

impl BaseTurns {
    fn of(task: &Task) -> Self {
        let ranges: Vec<[f64; 2]> = task.robot.joints().map(|joint| joint.range).collect();
        let mut rng = Rng::new(SEED);
        let mut draw = || -> Vec<f64> {
            let drawn = ranges.iter().map(|[lower, upper]| rng.uniform(*lower, *upper));
            with_followers(task, drawn)
        };
        let drawn: Vec<Vec<f64>> = (0..CONFIGURATIONS).map(|_| draw()).collect();
        let turns: Vec<Vec<Vector3<f64>>> = drawn.iter().map(|at| turns_at(task, at)).collect();
        let leading: Vec<usize> = task.robot.leading().collect();
        let all = || (0..leading.len()).map(|joint| turns.iter().map(move |turns| turns[joint]));
        let largest: Vec<f64> =
            all().map(|own| own.map(|turn| turn.norm()).fold(0.0, f64::max)).collect();
        let least = NOTHING * largest.iter().copied().fold(0.0, f64::max);
        let mut moment = Matrix3::zeros();
        for (own, largest) in all().zip(&largest).filter(|(_, largest)| **largest > least) {
            for turn in own.map(|turn| turn / *largest) {
                moment += turn * turn.transpose();
            }
        }
        Self { fastest: fastest(task, &ranges, drawn.into_iter().zip(turns)), moment }
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
            _ if is_holonomic(task) => Some(Block::Holonomic),
            1 if across.norm() > task.goal_tolerance => Some(Block::OneAxis),
            _ => None,
        }
    }
}

/// Positions of all joints, those that follow others where these have them.
fn with_followers(task: &Task, positions: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut positions: Vec<f64> = positions.collect();
    task.robot.place_followers(&mut positions);
    positions
}

/// By how much each joint that follows no other turns the base per unit of its rate.
fn turns_at(task: &Task, positions: &[f64]) -> Vec<Vector3<f64>> {
    let turn = |joint| {
        let mut rates = vec![0.0; positions.len()];
        rates[joint] = 1.0;
        task.robot.drive_followers(&mut rates);
        base_twist(&task.robot, positions, &rates).angular.into()
    };
    task.robot.leading().map(turn).collect()
}

/// The largest angular speed of the base: of configurations drawn, with their turns, and from there by steps at random, ever
/// shorter.
fn fastest(
    task: &Task,
    ranges: &[[f64; 2]],
    drawn: impl Iterator<Item = (Vec<f64>, Vec<Vector3<f64>>)>,
) -> f64 {
    let speed = |turns: &[Vector3<f64>]| -> f64 {
        let limits = task.robot.leading().map(|joint| task.limits.0[joint][0]);
        turns.iter().zip(limits).map(|(turn, rate)| rate * turn.norm()).sum()
    };
    let all = drawn.map(|(at, turns)| (speed(&turns), at));
    let Some((mut best, mut here)) = all.max_by(|(a, _), (b, _)| a.total_cmp(b)) else {
        return 0.0;
    };
    let mut rng = Rng::new(SEED);
    for k in 0..CONFIGURATIONS {
        let share = 0.5 * (1.0 - k as f64 / CONFIGURATIONS as f64);
        let step = |(at, [lower, upper]): (&f64, &[f64; 2])| {
            let width = share * (upper - lower);
            (at + rng.uniform(-width, width)).clamp(*lower, *upper)
        };
        let there = with_followers(task, here.iter().zip(ranges).map(step));
        let found = speed(&turns_at(task, &there));
        if found > best {
            (best, here) = (found, there);
        }
    }
    best
}

/// Whether where the base ends follows from where the joints end: joints that go round a loop bring it back.
fn is_holonomic(task: &Task) -> bool {
    let mut rng = Rng::new(SEED);
    let ranges: Vec<[f64; 2]> = task.robot.joints().map(|joint| joint.range).collect();
    (0..LOOPS).all(|_| {
        // Two waves each: an ellipse has a symmetry that may bring back a base that other loops turn.
        let waves: Vec<[f64; 5]> = ranges
            .iter()
            .map(|[lower, upper]| {
                let half = ((upper - lower) / 2.0).min(PI);
                let mut share = |least: f64| half * rng.uniform(least, 0.5);
                let [slow, fast] = [share(0.25), share(0.1)];
                let mut phase = || rng.uniform(0.0, TAU);
                [f64::midpoint(*lower, *upper), slow, phase(), fast, phase()]
            })
            .collect();
        let steps = increments(&task.robot, LOOP_STEPS, None, |tau, positions, rates| {
            for ((position, rate), [middle, slow, first, fast, second]) in
                positions.iter_mut().zip(&mut *rates).zip(&waves)
            {
                let [(s, c), (s2, c2)] =
                    [TAU * tau + first, 2.0 * TAU * tau + second].map(f64::sin_cos);
                *position = middle + slow * s + fast * s2;
                *rate = TAU * (slow * c + 2.0 * fast * c2);
            }
            task.robot.place_followers(positions);
            task.robot.drive_followers(rates);
        });
        let (mut net, mut all) = (UnitQuaternion::identity(), 0.0);
        for step in steps {
            net *= step;
            all += step.angle();
        }
        net.angle() <= RETURNS * all
    })
}
