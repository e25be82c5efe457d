//! The base's rotation along the paths of one family, in lanes.

use std::array::from_fn;

use nalgebra::UnitQuaternion;

use super::drift::Collocation;
use super::magnus::{GAUSS, magnus, step_moments, step_weights};
use crate::lanes::{Lanes, MOST};
use crate::momentum::{Arm, JointState};
use crate::so3::{self, Quat};
use crate::trajectory::Family;
use crate::vec3::Vec3;

/// Nodes of a panel, at which the base's rate is evaluated.
pub(super) const NODES: usize = 6;

/// Magnus steps of a panel.
pub(super) const STEPS: usize = 3;

/// Gauss–Legendre nodes on `[0, 1]` (Abramowitz and Stegun 1964, table 25.4), the first half; the other
/// mirrors it.
const NODE_PLACES: [f64; NODES / 2] =
    [0.033_765_242_898_423_99, 0.169_395_306_766_867_73, 0.380_690_406_958_401_56];

/// Composes the base's rotation along the paths of one family.
///
/// The path is cut into equal panels, and a lane holds one of them. In a panel the base's rate is
/// evaluated at six Gauss–Legendre nodes, which is all that costs; its interpolating polynomial gives the
/// moments of three sixth-order Magnus steps. Six nodes a panel of three steps are as good as nine, three
/// for every step.
#[derive(Debug, Clone)]
pub struct Rollout<F: Family> {
    pub(super) panels: usize,
    /// For every [`MOST`] panels and each node as many times, those of the panels. A panel beyond the
    /// last stands still at the path's start.
    pub(super) nodes: F::Nodes,
    /// `moments[s][k][n]`: what the rate at node `n` adds to the moment `a_k` of step `s`.
    pub(super) moments: [[[f64; NODES]; 3]; STEPS],
    /// The same for robots that have momentum.
    pub(super) collocation: Collocation<NODES, STEPS>,
}

impl<F: Family> Rollout<F> {
    /// With so many Magnus steps, rounded up to whole panels.
    pub fn new(family: &F, steps: usize) -> Self {
        Self::of_panels(family, family.panels(steps.div_ceil(STEPS)))
    }

    /// With so many panels, whether or not paths are smooth in each. Where they are not, a few digits are right.
    pub fn of_panels(family: &F, panels: usize) -> Self {
        let places = nodes();
        let times = (0..panels).step_by(MOST).flat_map(|first| {
            places.into_iter().flat_map(move |place| {
                (first..first + MOST).map(move |panel| {
                    if panel < panels { (panel as f64 + place) / panels as f64 } else { 0.0 }
                })
            })
        });
        let width = 1.0 / (panels * STEPS) as f64;
        Self {
            panels,
            nodes: family.nodes(times),
            moments: moments(&places, width),
            collocation: Collocation::new(&places, 1.0 / panels as f64),
        }
    }

    /// One panel, over the part of the paths between two times.
    pub(super) fn between(family: &F, [from, to]: [f64; 2]) -> Self {
        let places = nodes();
        // The other lanes stand still at the path's start.
        let times = places.into_iter().flat_map(|place| {
            let mut lanes = [0.0; MOST];
            lanes[0] = from + place * (to - from);
            lanes
        });
        let width = (to - from) / STEPS as f64;
        Self {
            panels: 1,
            nodes: family.nodes(times),
            moments: moments(&places, width),
            collocation: Collocation::new(&places, to - from),
        }
    }

    /// Magnus steps that it makes.
    pub fn steps(&self) -> usize {
        STEPS * self.panels
    }

    /// Where in the grid the panels from `first` on have their times of a node.
    #[inline(always)]
    pub(super) fn place(first: usize, node: usize) -> usize {
        (first / MOST * NODES + node) * MOST + first % MOST
    }

    /// The rotation of the base over the whole path, from its attitude at the start, in base axes.
    ///
    /// The rotations of panels are multiplied in an order that does not depend on the number of lanes.
    #[inline(always)]
    pub fn net_rotation<T: Lanes>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        joints: &mut Vec<JointState>,
    ) -> UnitQuaternion<f64> {
        let net = if arm.is_plain() {
            self.compose::<T, true>(arm, family, coefficients, joints)
        } else {
            self.compose::<T, false>(arm, family, coefficients, joints)
        };
        let mount = arm.mount();
        mount * UnitQuaternion::from(net) * mount.inverse()
    }

    /// The rotations of the base from its attitude at the start to the end of every step, in base axes.
    #[inline(always)]
    pub fn rotations<T: Lanes>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        joints: &mut Vec<JointState>,
        rotations: &mut Vec<UnitQuaternion<f64>>,
    ) {
        if arm.is_plain() {
            self.follow::<T, true>(arm, family, coefficients, joints, rotations);
        } else {
            self.follow::<T, false>(arm, family, coefficients, joints, rotations);
        }
    }

    #[inline(always)]
    fn follow<T: Lanes, const PLAIN: bool>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        joints: &mut Vec<JointState>,
        rotations: &mut Vec<UnitQuaternion<f64>>,
    ) {
        joints.resize(NODES * family.joints(), JointState::default());
        rotations.clear();
        let (mut net, mount, back) = (Quat::identity(), arm.mount(), arm.mount().inverse());
        for first in (0..self.panels).step_by(T::COUNT) {
            let rates = self.rates::<T, PLAIN>(arm, family, coefficients, first, joints);
            let mut steps = [[Quat::identity(); MOST]; STEPS];
            for (step, moments) in steps.iter_mut().zip(&self.moments) {
                so3::exp(magnus(step_moments(moments, &rates))).spread(step);
            }
            for panel in 0..T::COUNT.min(self.panels - first) {
                for step in &steps {
                    net = net.then(step[panel]);
                    rotations.push(mount * UnitQuaternion::from(net) * back);
                }
            }
        }
    }

    /// The rotation along the mount's axes.
    #[inline(always)]
    fn compose<T: Lanes, const PLAIN: bool>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        joints: &mut Vec<JointState>,
    ) -> Quat<f64> {
        joints.resize(NODES * family.joints(), JointState::default());
        let mut net = Quat::identity();
        for group in (0..self.panels).step_by(MOST) {
            let mut panels = [Quat::identity(); MOST];
            for part in (0..MOST).step_by(T::COUNT).take_while(|part| group + part < self.panels) {
                let rates = self.rates::<T, PLAIN>(arm, family, coefficients, group + part, joints);
                let mut panel = Quat::identity();
                for step in &self.moments {
                    panel = panel.then(so3::exp(magnus(step_moments(step, &rates))));
                }
                panel.spread(&mut panels[part..]);
            }
            net = net.then(product(panels));
        }
        net
    }

    /// The base's rate at every node of the panels from `first` on.
    #[inline(always)]
    fn rates<T: Lanes, const PLAIN: bool>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        first: usize,
        joints: &mut [JointState],
    ) -> [Vec3<T>; NODES] {
        self.drive::<T>(arm, family, coefficients, first, joints);
        let mut rates = [Vec3::zero(); NODES];
        for (rate, joints) in rates.iter_mut().zip(joints.chunks_exact(family.joints())) {
            *rate = arm.base_rate::<T, PLAIN>(joints);
        }
        rates
    }

    /// Every joint's state at every node of the panels from `first` on.
    ///
    /// Apart from the sweep, since a sine takes long but not much of the processor: many are under way
    /// at once where nothing waits for the one before.
    #[inline(always)]
    fn drive<T: Lanes>(
        &self,
        arm: &Arm,
        family: &F,
        coefficients: &[f64],
        first: usize,
        joints: &mut [JointState],
    ) {
        for (pair, states) in joints.chunks_exact_mut(2 * family.joints()).enumerate() {
            let (near, far) = states.split_at_mut(family.joints());
            let places = [2 * pair, 2 * pair + 1].map(|node| Self::place(first, node));
            for (place, link) in arm.links().iter().enumerate() {
                let joint = link.joint();
                let own = &coefficients[family.coefficients_of(joint)];
                let phases = family.phase_pair::<T>(&self.nodes, places, joint, own);
                let at = family.at_phase(joint, phases);
                let [a, b, c] = link.state(at.angle, at.rate);
                near[place].store([a.0, b.0, c.0]);
                far[place].store([a.1, b.1, c.1]);
            }
        }
    }
}

/// All nodes of a panel, in order, in its widths.
pub(super) fn nodes() -> [f64; NODES] {
    from_fn(|n| if n < NODES / 2 { NODE_PLACES[n] } else { 1.0 - NODE_PLACES[NODES - 1 - n] })
}

/// The moments of each step, which has this width, from the rates at a panel's nodes.
///
/// Three Gauss nodes of a step determine its moments; there the interpolating polynomial is evaluated
/// in Lagrange's form.
fn moments(nodes: &[f64; NODES], width: f64) -> [[[f64; NODES]; 3]; STEPS] {
    from_fn(|step| {
        step_weights(nodes, GAUSS.map(|gauss| (step as f64 + gauss) / STEPS as f64), width)
    })
}

/// The product of all, by pairs.
#[inline(always)]
fn product(mut q: [Quat<f64>; MOST]) -> Quat<f64> {
    let mut count = MOST;
    while count > 1 {
        count /= 2;
        for i in 0..count {
            q[i] = q[2 * i].then(q[2 * i + 1]);
        }
    }
    q[0]
}
