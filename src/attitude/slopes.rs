//! The base's rotation along a path with its derivatives by the path's coefficients.

use nalgebra::{Matrix3xX, UnitQuaternion, Vector3};

use super::node::{Evaluator, Node};
use super::rollout::{NODES, Rollout, STEPS, step_moments};
use super::{magnus, magnus_slopes};
use crate::lanes::Lanes;
use crate::robot::Robot;
use crate::so3::{self, Quat};
use crate::trajectory::Family;
use crate::vec3::{Mat3, Vec3};

/// The base's rotation over a path and how it changes with the path.
#[derive(Debug, Clone)]
pub struct RotationSlopes {
    /// The rotation, from the attitude at the start, in base axes.
    pub rotation: UnitQuaternion<f64>,
    /// Angular change in base axes at the end \[rad\], one column per coefficient of the path.
    pub by_coefficient: Matrix3xX<f64>,
}

/// As many panels as there are lanes.
struct Panels<T> {
    first: usize,
    nodes: Vec<Node<T>>,
    moments: [[Vec3<T>; 3]; STEPS],
    /// The rotation of each step.
    steps: [Quat<T>; STEPS],
}

impl<F: Family> Rollout<F> {
    /// [`net_rotation`](Self::net_rotation) with its derivatives.
    ///
    /// A change of the rotation vector `Ω` of one step turns the end by `Qᵀ J(Ω) dΩ`, where `J` is the
    /// right Jacobian and `Q` the rotation of all steps that follow.
    #[inline(always)]
    pub fn slopes<T: Lanes>(
        &self,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
    ) -> RotationSlopes {
        let mut evaluator = Evaluator::<T, F>::new(robot, family);
        let mut all = Vec::new();
        let mut rotations = Vec::new();
        for first in (0..self.panels).step_by(T::COUNT) {
            let panels = self.panels(&mut evaluator, family, coefficients, first);
            let mut rotation = panels.steps[0];
            for step in &panels.steps[1..] {
                rotation = rotation.then(*step);
            }
            rotations.resize(first + T::COUNT, Quat::identity());
            rotation.spread(&mut rotations[first..]);
            all.push(panels);
        }
        let mut net = Quat::identity();
        for rotation in rotations.iter_mut().rev() {
            // What follows a panel takes its place.
            let following = net;
            net = rotation.then(net);
            *rotation = following;
        }
        let mut by_coefficient = Matrix3xX::zeros(family.dimension());
        for panels in &all {
            let sums = self.turns(family, panels, Quat::gather(&rotations[panels.first..]));
            for (mut column, sum) in by_coefficient.column_iter_mut().zip(sums) {
                for part in &sum.lanes()[..T::COUNT] {
                    column += Vector3::from(*part);
                }
            }
        }
        RotationSlopes { rotation: net.into(), by_coefficient }
    }

    /// Everything of the panels from `first` on that does not depend on others.
    #[inline(always)]
    fn panels<T: Lanes>(
        &self,
        evaluator: &mut Evaluator<'_, T, F>,
        family: &F,
        coefficients: &[f64],
        first: usize,
    ) -> Panels<T> {
        let mut nodes = Vec::with_capacity(NODES);
        let mut rates = [Vec3::zero(); NODES];
        let joints = family.joints();
        let mut phases = Vec::with_capacity(joints);
        for (n, rate) in rates.iter_mut().enumerate() {
            let mut node = Node::new(joints);
            evaluator.phases(&self.nodes, Self::place(first, n), coefficients, &mut phases);
            evaluator.evaluate(&phases, &mut node);
            *rate = node.rate;
            nodes.push(node);
        }
        let mut moments = [[Vec3::zero(); 3]; STEPS];
        let mut steps = [Quat::identity(); STEPS];
        for step in 0..STEPS {
            moments[step] = step_moments(&self.moments[step], &rates);
            steps[step] = so3::exp(magnus(moments[step]));
        }
        Panels { first, nodes, moments, steps }
    }

    /// What each coefficient's change within a lane's panel turns the path's end by, `following` being
    /// the rotation of all panels that follow.
    #[inline(always)]
    fn turns<T: Lanes>(
        &self,
        family: &F,
        panels: &Panels<T>,
        mut following: Quat<T>,
    ) -> Vec<Vec3<T>> {
        let zero = Mat3::diagonal(T::of(0.0));
        let mut turns = [zero; NODES];
        for step in (0..STEPS).rev() {
            let moments = panels.moments[step];
            let turn = following.inverse().matrix() * so3::right_jacobian(magnus(moments));
            for (slope, weights) in magnus_slopes(moments).into_iter().zip(&self.moments[step]) {
                let by_moment = turn * slope;
                for n in 0..NODES {
                    turns[n] = turns[n] + by_moment.times(weights[n]);
                }
            }
            following = panels.steps[step].then(following);
        }
        let mut sums = vec![Vec3::zero(); family.dimension()];
        for (n, node) in panels.nodes.iter().enumerate() {
            let place = Self::place(panels.first, n);
            for (joint, slopes) in node.joints.iter().enumerate() {
                let by_phase = turns[n] * slopes.by_phase;
                let by_phase_rate = turns[n] * slopes.by_phase_rate;
                let first = family.coefficients_of(joint).start;
                for k in family.support::<T>(&self.nodes, joint, place) {
                    let [bump, slope] = family.bump::<T>(&self.nodes, joint, k, place);
                    sums[first + k] += by_phase * bump + by_phase_rate * slope;
                }
            }
        }
        sums
    }
}
