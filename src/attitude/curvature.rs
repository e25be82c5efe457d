//! The second derivative of the base's rotation by the path's coefficients.

use nalgebra::{DMatrix, Matrix3xX, Vector3};

use super::node::{Evaluator, Node};
use crate::lanes::{Lanes, MOST};
use crate::robot::Robot;
use crate::so3::{self, Quat};
use crate::trajectory::Family;
use crate::vec3::{Mat3, Vec3};

/// How the end of a path turns with its coefficients, to second order.
#[derive(Debug, Clone)]
pub struct RotationCurvature {
    /// First derivative of the rotation vector from the path's own end \[rad\], one column a
    /// coefficient.
    pub by_coefficient: Matrix3xX<f64>,
    /// Second derivative of that vector's product with a given one.
    pub curvature: DMatrix<f64>,
}

/// Step of the differences that stand for the second derivatives of the base's rate.
const STEP: f64 = 1e-5;

/// Second derivatives by the midpoint rule: of second order, so for a few digits.
#[derive(Debug, Clone)]
pub struct Midpoints<F: Family> {
    steps: usize,
    /// Filled up with the path's start, where nothing depends on coefficients.
    nodes: F::Nodes,
    /// How many times these are.
    times: usize,
}

/// As many midpoints as there are lanes.
struct Part<T> {
    first: usize,
    phases: Vec<[T; 2]>,
    node: Node<T>,
}

impl<F: Family> Midpoints<F> {
    /// At the middles of so many steps.
    pub fn new(family: &F, steps: usize) -> Self {
        let times = (0..steps).map(|i| (i as f64 + 0.5) / steps as f64);
        Self { steps, nodes: family.nodes(times), times: steps.next_multiple_of(2 * MOST) }
    }

    /// First and second derivative.
    ///
    /// The base's rate `ω` bends with the coefficients, and what a node adds to the end, `e`, is turned
    /// by the nodes that follow it, hence with the given vector `p`
    ///
    /// ```text
    ///     Σ_n  Q_n p · ∂²ω/∂c_k ∂c_l  +  p · (e_nk × Σ_{m>n} e_ml)      symmetric in k and l
    /// ```
    #[inline(always)]
    pub fn curvature<T: Lanes>(
        &self,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
        p: &Vector3<f64>,
    ) -> RotationCurvature {
        let width = 1.0 / self.steps as f64;
        let mut evaluator = Evaluator::<T, F>::new(robot, family);
        let mut parts = Vec::new();
        let mut following = vec![Quat::identity(); self.times];
        let joints = family.joints();
        for first in (0..self.times).step_by(T::COUNT) {
            let (mut phases, mut node) = (Vec::with_capacity(joints), Node::new(joints));
            evaluator.phases(&self.nodes, first, coefficients, &mut phases);
            evaluator.evaluate(&phases, &mut node);
            so3::exp(node.rate.times(width / 2.0)).spread(&mut following[first..]);
            parts.push(Part { first, phases, node });
        }
        let mut end = Quat::identity();
        for half in following.iter_mut().rev() {
            let own = *half;
            *half = own.then(end);
            end = own.then(*half);
        }

        let dimension = family.dimension();
        let mut curvature = DMatrix::zeros(dimension, dimension);
        // One block of columns per time.
        let mut slopes = Matrix3xX::zeros(self.times * dimension);
        let mut beside = Node::new(joints);
        for part in parts {
            let turn = Quat::<T>::gather(&following[part.first..]);
            let turn_back = turn.inverse().matrix().times(width);
            self.add_slopes(family, &part, turn_back, &mut slopes);
            let p = turn_back.tr_mul(Vec3::of(p));
            self.add_bend(&mut evaluator, family, part, p, &mut beside, &mut curvature);
        }
        let mut by_coefficient = Matrix3xX::zeros(dimension);
        let mut moved = by_coefficient.clone();
        for step in (0..self.steps).rev() {
            let own = slopes.columns(step * dimension, dimension);
            p.cross_matrix().mul_to(&own, &mut moved);
            curvature.gemm_tr(1.0, &moved, &by_coefficient, 1.0);
            by_coefficient += own;
        }
        curvature = (&curvature + curvature.transpose()) / 2.0;
        RotationCurvature { by_coefficient, curvature }
    }

    /// What each node adds to the first derivatives.
    #[inline(always)]
    fn add_slopes<T: Lanes>(
        &self,
        family: &F,
        Part { first, node, .. }: &Part<T>,
        turn: Mat3<T>,
        slopes: &mut Matrix3xX<f64>,
    ) {
        for (joint, own) in node.joints.iter().enumerate() {
            for k in family.support::<T>(&self.nodes, joint, *first) {
                let [bump, slope] = family.bump::<T>(&self.nodes, joint, k, *first);
                let change = own.by_phase * bump + own.by_phase_rate * slope;
                let column = family.coefficients_of(joint).start + k;
                for (time, change) in (*first..).zip(&(turn * change).lanes()[..T::COUNT]) {
                    let place = time * family.dimension() + column;
                    // Joints that follow another one share its coefficients.
                    let mut column = slopes.column_mut(place);
                    column += Vector3::from(*change);
                }
            }
        }
    }

    /// Adds the second derivatives of `p · ω`, once symmetrised: those by the joints' `s`, and by `s'`
    /// (row) and `s` (column), both halves of which stand on one side; those by `s'` alone vanish.
    #[inline(always)]
    fn add_bend<T: Lanes>(
        &self,
        evaluator: &mut Evaluator<'_, T, F>,
        family: &F,
        Part { first, mut phases, node }: Part<T>,
        p: Vec3<T>,
        beside: &mut Node<T>,
        sum: &mut DMatrix<f64>,
    ) {
        let joints = family.joints();
        let mut bumps: Vec<[T; 2]> = Vec::with_capacity(family.dimension());
        // Of each joint the first of its bumps here, how many these are, and the first's coefficient.
        let mut parts = Vec::with_capacity(joints);
        for joint in 0..joints {
            let support = family.support::<T>(&self.nodes, joint, first);
            let place = family.coefficients_of(joint).start + support.start;
            parts.push((bumps.len(), support.len(), place));
            for k in support {
                bumps.push(family.bump(&self.nodes, joint, k, first));
            }
        }
        for j in 0..joints {
            let here = phases[j];
            phases[j][0] += T::of(STEP);
            evaluator.evaluate(&phases, beside);
            phases[j] = here;
            let (start, count, column) = parts[j];
            let columns = &bumps[start..start + count];
            for (i, &(start, count, row_place)) in parts.iter().enumerate() {
                let per_step = T::of(1.0 / STEP);
                let (there, here) = (beside.joints[i], node.joints[i]);
                let phase = p.dot(there.by_phase - here.by_phase) * per_step;
                let mixed = p.dot(there.by_phase_rate - here.by_phase_rate) * per_step;
                for (k, &[value, slope]) in bumps[start..start + count].iter().enumerate() {
                    let row = value * phase + (slope + slope) * mixed;
                    for (l, &[other, _]) in columns.iter().enumerate() {
                        let entry = &mut sum[(row_place + k, column + l)];
                        // One place after the other, whatever the number of lanes.
                        for place in &(row * other).numbers()[..T::COUNT] {
                            *entry += place;
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;
    use crate::trajectory::SinePolynomial;

    /// Any number of steps, so however many lanes stay idle, comes near what many steps give.
    #[test]
    fn idle_lanes_add_nothing() {
        let document = Robot::embedded("xiao2023").unwrap();
        let robot = Robot::from_document(&document).unwrap();
        let ranges: Vec<_> = robot.joints().map(|joint| joint.range).collect();
        let (start, goal) = ([0.2, 0.5, 0.8, -0.3, -0.4, 0.7], [0.7, 1.0, 1.5, -0.2, -0.5, 1.0]);
        let family = SinePolynomial::new(&ranges, &start, &goal, 2);
        let coefficients: Vec<f64> = (0..12).map(|i| 0.03 * f64::from(i) - 0.2).collect();
        let p = Vector3::new(0.4, -0.7, 0.6);
        let curvature = |steps| {
            Midpoints::new(&family, steps).curvature::<f64>(&robot, &family, &coefficients, &p)
        };
        let exact = curvature(400).curvature;
        for steps in 8..=33 {
            let miss = (curvature(steps).curvature - &exact).norm() / exact.norm();
            // The midpoint rule's error falls with the square; here its factor is 1.3.
            assert!(miss < 2.0 / (steps * steps) as f64, "{steps} steps: {miss}");
        }
    }
}
