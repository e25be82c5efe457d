//! Joint positions that bring the tool where it is to be while the base has a given attitude.
//!
//! No force acts from outside, so the system's centre of mass stays where it is, and with the base's attitude the joints tell where
//! the tool is in inertial axes, too: that is the virtual manipulator of Vafa and Dubowsky (DOI 10.1177/027836499000900401).
//! In base axes the tool's place is `p(q)` from the base's centre of mass and `p(q) − c(q)` from the system's.

mod descent;
mod system;
mod target;

use descent::{Descent, PRECISION};
pub use target::{Miss, Orientation, Origin, ToolTarget};

use crate::robot::Robot;

/// Random configurations that searches start from, and how many more where none of these has led to a solution.
const STARTS: usize = 96;
const MORE_STARTS: usize = 160;

/// Two solutions are the same if no joint differs by more than this \[rad or m\].
const SAME: f64 = 1e-3;

/// All joint positions \[rad or m\] that were found within the joints' ranges, nearest first; `near`, one position per joint, is what
/// they are to be near to, and `efforts` is what a unit of each joint's way counts. An arm with joints to spare has a continuum of
/// solutions, of which these are the ones nearest to `near` for themselves. Where none was found, the error is by how much the best
/// attempt misses.
///
/// # Panics
///
/// Panics unless there is one of `near` and of `efforts` for each joint that moves.
pub fn solve(
    robot: &Robot,
    target: &ToolTarget,
    near: &[f64],
    efforts: &[f64],
) -> Result<Vec<Vec<f64>>, Miss> {
    let descent = Descent::new(robot, target, near, efforts);
    let mut solutions: Vec<Vec<f64>> = Vec::new();
    let mut best: Option<(f64, Miss)> = None;
    let starts = std::iter::once(near.to_vec()).chain(robot.random_configurations());
    for (i, mut positions) in starts.take(1 + STARTS + MORE_STARTS).enumerate() {
        if i > STARTS && !solutions.is_empty() {
            break;
        }
        let error = descent.run(&mut positions, 0.0);
        if error > PRECISION {
            let miss = miss(robot, target, &positions);
            if best.is_none_or(|(least, _)| error < least) {
                best = Some((error, miss));
            }
            continue;
        }
        let positions = descent.nearest(positions);
        let is_known =
            |known: &Vec<f64>| known.iter().zip(&positions).all(|(a, b)| (a - b).abs() < SAME);
        if !solutions.iter().any(is_known) {
            solutions.push(positions);
        }
    }
    if solutions.is_empty() {
        return Err(best.map(|(_, miss)| miss).unwrap_or_default());
    }
    solutions.sort_by(|a, b| descent.way(a).total_cmp(&descent.way(b)));
    Ok(solutions)
}

/// By how much the tool misses its target with these joint positions \[rad or m\].
///
/// # Panics
///
/// Panics when there are more or fewer positions than joints that move.
pub fn miss(robot: &Robot, target: &ToolTarget, positions: &[f64]) -> Miss {
    let place = system::Place::of(robot, positions);
    let off = place.error(target);
    Miss { position: off.position.norm(), angle: off.angle }
}
