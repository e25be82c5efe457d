//! Levenberg and Marquardt's method (DOI 10.1137/0111030) within the joints' ranges.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::system::linearised;
use super::target::ToolTarget;
use crate::robot::{JointKind, Robot};

/// Steps of one search.
const STEPS: usize = 200;

/// The damping that a search begins with, and the most that it tries.
const FIRST_DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e6;

/// Distances \[m\], as shares of the reach, and angles \[rad\] by which a solution may miss.
pub(super) const PRECISION: f64 = 1e-10;

/// How hard a redundant arm is pulled to the positions that it is to be near to, one after the other.
const PULLS: [f64; 3] = [1e-2, 1e-4, 0.0];

/// Errors below this are rounding.
const ROUNDING: f64 = 1e-15;

/// Searches for positions of the joints that follow none.
pub(super) struct Descent<'a> {
    robot: &'a Robot,
    target: &'a ToolTarget,
    near: &'a [f64],
    /// Weight of each joint's travel, scaled so that the largest is 1.
    efforts: Vec<f64>,
    ranges: Vec<[f64; 2]>,
    leading: Vec<usize>,
    reach: f64,
}

impl<'a> Descent<'a> {
    pub(super) fn new(
        robot: &'a Robot,
        target: &'a ToolTarget,
        near: &'a [f64],
        efforts: &[f64],
    ) -> Self {
        assert_eq!([near.len(), efforts.len()], [robot.joint_count(); 2], "one per joint");
        let most = efforts.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        Self {
            robot,
            target,
            near,
            efforts: efforts.iter().map(|effort| effort / most).collect(),
            ranges: robot.joints().map(|joint| joint.range).collect(),
            leading: robot.leading().collect(),
            reach: robot.reach(),
        }
    }

    /// The way from where the solution is to be near to: the longest of all joints.
    pub(super) fn way(&self, positions: &[f64]) -> f64 {
        let ways = positions.iter().zip(self.near).zip(&self.efforts);
        ways.map(|((at, near), effort)| (at - near).abs() * effort).fold(0.0, f64::max)
    }

    /// Moves a solution towards where it is to be near to; it usually stays on its branch.
    pub(super) fn nearest(&self, mut solution: Vec<f64>) -> Vec<f64> {
        // Whole turns lead nowhere else.
        for (joint, (own, at)) in self.robot.joints().zip(&mut solution).enumerate() {
            if own.kind == JointKind::Revolute && own.follows.is_none() {
                let turned = *at + ((self.near[joint] - *at) / TAU).round() * TAU;
                if (own.range[0]..=own.range[1]).contains(&turned) {
                    *at = turned;
                }
            }
        }
        self.robot.place_followers(&mut solution);
        let mut nearer = solution.clone();
        let mut error = f64::INFINITY;
        for pull in PULLS {
            error = self.run(&mut nearer, pull);
        }
        if error <= PRECISION { nearer } else { solution }
    }

    /// Goes down from positions \[rad or m\], pulled to where the solution is to be near to; gives the tool's error.
    pub(super) fn run(&self, positions: &mut Vec<f64>, pull: f64) -> f64 {
        let mut damping = FIRST_DAMPING;
        let (mut error, mut jacobian) = self.system(positions, pull);
        for _ in 0..STEPS {
            let gradient = jacobian.tr_mul(&error);
            let bound = self.bound(positions, &gradient);
            let left = (0..gradient.len()).filter(|i| !bound[*i]).map(|i| gradient[i].abs());
            if error.norm() < ROUNDING || left.fold(0.0, f64::max) < ROUNDING * error.norm() {
                break;
            }
            let normal = jacobian.tr_mul(&jacobian);
            let mut is_better = false;
            while damping <= MOST_DAMPING {
                let step = step(&normal, &gradient, &bound, damping);
                let trial = step.and_then(|step| self.moved(positions, &step));
                if let Some(trial) = trial {
                    let next = self.system(&trial, pull);
                    if next.0.norm() < error.norm() {
                        *positions = trial;
                        (error, jacobian) = next;
                        damping = (damping * 0.1).max(1e-12);
                        is_better = true;
                        break;
                    }
                }
                damping *= 10.0;
            }
            if !is_better {
                break;
            }
        }
        error.rows(0, 6).norm()
    }

    /// The tool's error, followed by how far each joint is from where it is to be near to; and the derivatives, joints that
    /// follow others counted with these.
    fn system(&self, positions: &[f64], pull: f64) -> (DVector<f64>, DMatrix<f64>) {
        let (tool, by_joint) = linearised(self.robot, self.target, positions, self.reach);
        let extra = if pull > 0.0 { self.leading.len() } else { 0 };
        let mut error = DVector::zeros(6 + extra);
        error.rows_mut(0, 6).copy_from(&tool);
        let mut jacobian = DMatrix::zeros(6 + extra, self.leading.len());
        jacobian.rows_mut(0, 6).copy_from(&self.robot.by_leading(by_joint.as_view()));
        if pull > 0.0 {
            for (column, &leader) in self.leading.iter().enumerate() {
                let weight = pull * self.efforts[leader];
                error[6 + column] = weight * (positions[leader] - self.near[leader]);
                jacobian[(6 + column, column)] = weight;
            }
        }
        (error, jacobian)
    }

    /// Which joints are at an end of their ranges that the error would push them beyond.
    fn bound(&self, positions: &[f64], gradient: &DVector<f64>) -> Vec<bool> {
        let is_bound = |(&joint, slope): (&usize, &f64)| {
            let ([lower, upper], at) = (self.ranges[joint], positions[joint]);
            (at <= lower && *slope > 0.0) || (at >= upper && *slope < 0.0)
        };
        self.leading.iter().zip(gradient.iter()).map(is_bound).collect()
    }

    /// Positions after a step, kept within the ranges; none where nothing moves.
    fn moved(&self, positions: &[f64], step: &DVector<f64>) -> Option<Vec<f64>> {
        let mut moved = positions.to_vec();
        for (&joint, step) in self.leading.iter().zip(step.iter()) {
            let [lower, upper] = self.ranges[joint];
            moved[joint] = (positions[joint] - step).clamp(lower, upper);
        }
        self.robot.place_followers(&mut moved);
        (moved != positions).then_some(moved)
    }
}

/// The damped step; joints at bounds stay.
fn step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    bound: &[bool],
    damping: f64,
) -> Option<DVector<f64>> {
    let mut matrix = normal.clone();
    let mut right = gradient.clone();
    for (i, is_bound) in bound.iter().enumerate() {
        matrix[(i, i)] += damping;
        if *is_bound {
            matrix.row_mut(i).fill(0.0);
            matrix.column_mut(i).fill(0.0);
            matrix[(i, i)] = 1.0;
            right[i] = 0.0;
        }
    }
    Some(matrix.cholesky()?.solve(&right))
}
