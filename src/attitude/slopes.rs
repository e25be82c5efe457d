//! The base's rotation along a path with its derivatives by the path's coefficients.

use nalgebra::{Matrix3xX, UnitQuaternion, Vector3};

use super::magnus::{magnus, magnus_slopes, step_moments};
use super::node::{Evaluator, Node};
use super::rollout::{NODES, Rollout, STEPS};
use crate::lanes::{LaneWork, Lanes, MOST, Width};
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

impl RotationSlopes {
    /// From changes along the axes at the start.
    fn of(rotation: Quat<f64>, from_start: &Matrix3xX<f64>) -> Self {
        let rotation = UnitQuaternion::from(rotation);
        let by_coefficient = rotation.inverse().to_rotation_matrix().matrix() * from_start;
        Self { rotation, by_coefficient }
    }

    /// This rotation, then `next`.
    fn then(&self, next: &Self) -> Self {
        let back = next.rotation.inverse().to_rotation_matrix();
        Self {
            rotation: self.rotation * next.rotation,
            by_coefficient: back.matrix() * &self.by_coefficient + &next.by_coefficient,
        }
    }
}

/// As many panels as there are lanes.
struct Panels<T> {
    first: usize,
    nodes: Vec<Node<T>>,
    moments: [[Vec3<T>; 3]; STEPS],
    /// The rotation of each step.
    steps: [Quat<T>; STEPS],
}

/// The slopes after each of these numbers of panels.
struct AfterPanels<'a, F: Family> {
    rollout: &'a Rollout<F>,
    robot: &'a Robot,
    family: &'a F,
    coefficients: &'a [f64],
    wanted: &'a [usize],
}

impl<F: Family> LaneWork for AfterPanels<'_, F> {
    type Output = Vec<RotationSlopes>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Vec<RotationSlopes> {
        let Self { rollout, robot, family, coefficients, wanted } = self;
        let mut evaluator = Evaluator::<T, F>::new(robot, family);
        let mut net = Quat::identity();
        // Along the axes at the start.
        let mut sums = Matrix3xX::zeros(family.dimension());
        let mut after = vec![RotationSlopes::of(net, &sums); wanted.len()];
        for first in (0..rollout.panels).step_by(T::COUNT) {
            let panels = rollout.panels(&mut evaluator, family, coefficients, first);
            let mut rotation = panels.steps[0];
            for step in &panels.steps[1..] {
                rotation = rotation.then(*step);
            }
            let mut nets = [Quat::identity(); MOST];
            rotation.spread(&mut nets);
            let used = T::COUNT.min(rollout.panels - first);
            for rotation in &mut nets[..used] {
                net = net.then(*rotation);
                *rotation = net;
            }
            let turns = rollout.turns(family, &panels, Quat::gather(&nets));
            let turns: Vec<_> = turns.into_iter().map(Vec3::lanes).collect();
            for (lane, net) in nets.into_iter().enumerate().take(used) {
                for (mut sum, turns) in sums.column_iter_mut().zip(&turns) {
                    sum += Vector3::from(turns[lane]);
                }
                for (after, wanted) in after.iter_mut().zip(wanted) {
                    if *wanted == first + lane + 1 {
                        *after = RotationSlopes::of(net, &sums);
                    }
                }
            }
        }
        after
    }
}

/// Share of a panel that is nothing.
const ROUNDING: f64 = 1e-9;

impl<F: Family> Rollout<F> {
    /// [`net_rotation`](Self::net_rotation) up to each of these normalised times, with its derivatives.
    ///
    /// A change of the rotation vector `Ω` of one step turns its end by `J(Ω) dΩ`, where `J` is the right Jacobian. Seen from the
    /// start these turns add up, so one pass serves all times; a time within a panel takes one more panel that ends there.
    pub fn slopes_at(
        &self,
        width: Width,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
        taus: &[f64],
    ) -> Vec<RotationSlopes> {
        let count = self.panels as f64;
        let whole = |tau: &f64| ((tau * count + ROUNDING).floor() as usize).min(self.panels);
        let wholes: Vec<usize> = taus.iter().map(whole).collect();
        let work = AfterPanels { rollout: self, robot, family, coefficients, wanted: &wholes };
        let mut found = width.run(work);
        for ((found, whole), tau) in found.iter_mut().zip(wholes).zip(taus) {
            let start = whole as f64 / count;
            if tau - start > ROUNDING / count {
                let part = Self::between(family, [start, *tau]);
                *found = found.then(&part.slopes(Width::Scalar, robot, family, coefficients));
            }
        }
        found
    }

    /// [`slopes_at`](Self::slopes_at) the end alone.
    pub fn slopes(
        &self,
        width: Width,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
    ) -> RotationSlopes {
        self.slopes_at(width, robot, family, coefficients, &[1.0]).remove(0)
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

    /// What each coefficient's change within a lane's panel turns its end by, along the axes at the path's start, from where `net`
    /// leads to that end.
    #[inline(always)]
    fn turns<T: Lanes>(&self, family: &F, panels: &Panels<T>, mut net: Quat<T>) -> Vec<Vec3<T>> {
        let zero = Mat3::diagonal(T::of(0.0));
        let mut turns = [zero; NODES];
        for step in (0..STEPS).rev() {
            let moments = panels.moments[step];
            let turn = net.matrix() * so3::right_jacobian(magnus(moments));
            for (slope, weights) in magnus_slopes(moments).into_iter().zip(&self.moments[step]) {
                let by_moment = turn * slope;
                for n in 0..NODES {
                    turns[n] = turns[n] + by_moment.times(weights[n]);
                }
            }
            net = net.then(panels.steps[step].inverse());
        }
        let mut sums = vec![Vec3::zero(); family.dimension()];
        for (n, node) in panels.nodes.iter().enumerate() {
            let place = Self::place(panels.first, n);
            self.add_turns(family, node, place, turns[n], &mut sums);
        }
        sums
    }

    /// Adds to each coefficient's sum what its change at a node turns the end by, where `turn` is what a change of the rate there
    /// does.
    #[inline(always)]
    pub(super) fn add_turns<T: Lanes>(
        &self,
        family: &F,
        node: &Node<T>,
        place: usize,
        turn: Mat3<T>,
        sums: &mut [Vec3<T>],
    ) {
        for (joint, slopes) in node.joints.iter().enumerate() {
            let by_phase = turn * slopes.by_phase;
            let by_phase_rate = turn * slopes.by_phase_rate;
            let first = family.coefficients_of(joint).start;
            for k in family.support::<T>(&self.nodes, joint, place) {
                let [bump, slope] = family.bump::<T>(&self.nodes, joint, k, place);
                sums[first + k] += by_phase * bump + by_phase_rate * slope;
            }
        }
    }
}
