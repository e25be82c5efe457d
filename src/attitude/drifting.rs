//! Rollouts of a robot that has angular momentum: see [`drift`](super::drift).

use nalgebra::{Matrix3, Matrix3xX, Vector3};

use super::drift::{Drift, Panel, PanelSlopes};
use super::node::{Evaluator, Node};
use super::rollout::{NODES, Rollout, STEPS};
use super::slopes::RotationSlopes;
use crate::lanes::{LaneWork, Lanes, MOST, Width};
use crate::momentum::BaseResponse;
use crate::robot::Robot;
use crate::so3::Quat;
use crate::trajectory::Family;
use crate::vec3::{Mat3, Sym3, Vec3};

/// A path that is followed with momentum.
struct Drifting<'a, F: Family> {
    rollout: &'a Rollout<F>,
    robot: &'a Robot,
    family: &'a F,
    coefficients: &'a [f64],
    drift: Drift,
}

impl<F: Family> Rollout<F> {
    /// [`net_rotation`](Self::net_rotation) of a robot that has momentum.
    pub fn drifting_rotation(
        &self,
        width: Width,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
        drift: Drift,
    ) -> nalgebra::UnitQuaternion<f64> {
        let path = Drifting { rollout: self, robot, family, coefficients, drift };
        let panels = path.follow(width.run(Responses(&path)));
        let net = panels.iter().fold(Quat::identity(), |net, panel| net.then(panel.rotation()));
        net.into()
    }

    /// The same with its derivatives by the coefficients, and by the duration.
    pub fn drifting_slopes(
        &self,
        width: Width,
        robot: &Robot,
        family: &F,
        coefficients: &[f64],
        drift: Drift,
    ) -> (RotationSlopes, Vector3<f64>) {
        let path = Drifting { rollout: self, robot, family, coefficients, drift };
        let panels = path.follow(width.run(Responses(&path)));
        let slopes: Vec<_> = panels.iter().map(|panel| self.collocation.slopes(panel)).collect();
        let own = width.run(Additions { path: &path, panels: &panels, slopes: &slopes });
        let mut net = Quat::identity();
        let mut by_coefficient = Matrix3xX::zeros(family.dimension());
        let mut by_duration = Vector3::zeros();
        let per_second = Vec3::of(&drift.momentum);
        for ((panel, PanelSlopes { by_start, by_rate }), own) in panels.iter().zip(&slopes).zip(own)
        {
            net = net.then(panel.rotation());
            by_coefficient = by_start * by_coefficient + own;
            by_duration = by_start * by_duration;
            for (n, by_rate) in by_rate.iter().enumerate() {
                by_duration += by_rate * Vector3::from(panel.answer(n, per_second));
            }
        }
        (RotationSlopes { rotation: net.into(), by_coefficient }, by_duration)
    }
}

impl<F: Family> Drifting<'_, F> {
    /// All panels, one after the other.
    fn follow(&self, responses: Vec<[BaseResponse<f64>; NODES]>) -> Vec<Panel<NODES, STEPS>> {
        let collocation = &self.rollout.collocation;
        let mut attitude = Quat::from(self.drift.start);
        let follow = |responses| {
            let panel = collocation.panel(attitude, self.drift.scaled_momentum(), responses);
            attitude = attitude.then(panel.rotation());
            panel
        };
        responses.into_iter().map(follow).collect()
    }
}

/// How the base answers at the nodes of every panel.
struct Responses<'a, F: Family>(&'a Drifting<'a, F>);

impl<F: Family> LaneWork for Responses<'_, F> {
    type Output = Vec<[BaseResponse<f64>; NODES]>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Self::Output {
        let Drifting { rollout, robot, family, coefficients, .. } = self.0;
        let mut evaluator = Evaluator::<T, F>::new(robot, *family);
        let mut phases = Vec::with_capacity(family.joints());
        let none = BaseResponse { rate: Vec3::zero(), inverse_inertia: Sym3::zero() };
        let mut responses = vec![[none; NODES]; rollout.panels];
        for first in (0..rollout.panels).step_by(T::COUNT) {
            for n in 0..NODES {
                let place = Rollout::<F>::place(first, n);
                evaluator.phases(&rollout.nodes, place, coefficients, &mut phases);
                let BaseResponse { rate, inverse_inertia } = evaluator.response(&phases);
                let rates = rate.lanes();
                let (diagonals, besides) =
                    (inverse_inertia.diagonal.lanes(), inverse_inertia.beside.lanes());
                for (lane, panel) in responses[first..].iter_mut().take(T::COUNT).enumerate() {
                    let inverse_inertia = Sym3 { diagonal: diagonals[lane], beside: besides[lane] };
                    panel[n] = BaseResponse { rate: rates[lane], inverse_inertia };
                }
            }
        }
        responses
    }
}

/// What each coefficient adds to the turn of every panel's end.
struct Additions<'a, F: Family> {
    path: &'a Drifting<'a, F>,
    panels: &'a [Panel<NODES, STEPS>],
    slopes: &'a [PanelSlopes<NODES>],
}

impl<F: Family> LaneWork for Additions<'_, F> {
    type Output = Vec<Matrix3xX<f64>>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Self::Output {
        let Drifting { rollout, robot, family, coefficients, .. } = self.path;
        let mut evaluator = Evaluator::<T, F>::new(robot, *family);
        let mut phases = Vec::with_capacity(family.joints());
        let mut node = Node::new(family.joints());
        let mut all = Vec::with_capacity(rollout.panels);
        for first in (0..rollout.panels).step_by(T::COUNT) {
            let count = T::COUNT.min(rollout.panels - first);
            let mut sums = vec![Vec3::zero(); family.dimension()];
            for n in 0..NODES {
                let place = Rollout::<F>::place(first, n);
                evaluator.phases(&rollout.nodes, place, coefficients, &mut phases);
                let scaled_momentum =
                    gather(count, |lane| self.panels[first + lane].scaled_momenta[n]);
                evaluator.evaluate_drifting(&phases, scaled_momentum, &mut node);
                let turn = gather_matrix(count, |lane| self.slopes[first + lane].by_rate[n]);
                rollout.add_turns(*family, &node, place, turn, &mut sums);
            }
            let sums: Vec<_> = sums.into_iter().map(Vec3::lanes).collect();
            all.extend((0..count).map(|lane| {
                let columns = sums.iter().map(|sum| Vector3::from(sum[lane]));
                Matrix3xX::from_columns(&columns.collect::<Vec<_>>())
            }));
        }
        all
    }
}

/// A vector per lane; zero in lanes that are not used.
#[inline(always)]
fn gather<T: Lanes>(count: usize, of: impl Fn(usize) -> Vec3<f64>) -> Vec3<T> {
    let mut numbers = [[0.0; MOST]; 3];
    for lane in 0..count {
        let Vec3 { x, y, z } = of(lane);
        for (numbers, value) in numbers.iter_mut().zip([x, y, z]) {
            numbers[lane] = value;
        }
    }
    let [x, y, z] = numbers;
    Vec3::new(T::load(&x), T::load(&y), T::load(&z))
}

/// A matrix per lane.
#[inline(always)]
fn gather_matrix<T: Lanes>(count: usize, of: impl Fn(usize) -> Matrix3<f64>) -> Mat3<T> {
    Mat3([0, 1, 2].map(|column| gather(count, |lane| Vec3::of(&of(lane).column(column).into()))))
}
