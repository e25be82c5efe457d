//! The base's rotation while the robot as a whole has angular momentum.
//!
//! With `h = Rᵀ L` the base's rate is `ω = ω_0(θ, θ') + t_f I(θ)⁻¹ h`: it follows the attitude `R`, so steps can no longer be
//! taken apart from each other. Every panel is a collocation: at its nodes the rate is that of the attitude to which Magnus
//! steps over the interpolated rates lead from the panel's start. What takes long, the sweeps, does not follow the attitude
//! and is done once per node; the rest is a fixed-point iteration, which contracts by about the angle by which the momentum turns
//! the base within a panel.

use std::array::from_fn;

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::magnus::{GAUSS, magnus, magnus_slopes, step_moments, step_weights};
use crate::momentum::BaseResponse;
use crate::so3::{self, Quat};
use crate::vec3::{Mat3, Vec3};

/// What turns the base besides the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Total angular momentum about the system's centre of mass, inertial axes \[N·m·s\].
    pub momentum: Vector3<f64>,
    /// The base's attitude at the path's start, base axes into inertial axes.
    pub start: UnitQuaternion<f64>,
    /// How long the path takes \[s\].
    pub duration: f64,
}

impl Drift {
    /// The momentum in normalised time: `t_f L`.
    pub(super) fn scaled_momentum(&self) -> Vec3<f64> {
        Vec3::of(&(self.momentum * self.duration))
    }
}

/// Iterations end when the rates of a panel change by no more than this share, and have not converged where the last one changed
/// them by more than the other.
const SAME: f64 = 1e-14;
const CONVERGED: f64 = 1e-9;

/// Most iterations. Where the momentum turns the base by more than about a radian within a panel, they do not converge.
const ITERATIONS: usize = 60;

/// Of panels with `N` nodes and `S` Magnus steps, what the rates at the nodes add to the moments of each step, and of the part
/// of one that ends at a node.
#[derive(Debug, Clone)]
pub(super) struct Collocation<const N: usize, const S: usize> {
    steps: [[[f64; N]; 3]; S],
    /// In which step each node lies.
    step_of: [usize; N],
    parts: [[[f64; N]; 3]; N],
}

impl<const N: usize, const S: usize> Collocation<N, S> {
    /// With nodes at these places \[panels\], in panels of such a width.
    pub(super) fn new(nodes: &[f64; N], width: f64) -> Self {
        let step = 1.0 / S as f64;
        let between = |from: f64, to: f64| {
            step_weights(nodes, GAUSS.map(|g| from + g * (to - from)), (to - from) * width)
        };
        let step_of = nodes.map(|place| ((place * S as f64) as usize).min(S - 1));
        Self {
            steps: from_fn(|k| between(k as f64 * step, (k + 1) as f64 * step)),
            step_of,
            parts: from_fn(|n| between(step_of[n] as f64 * step, nodes[n])),
        }
    }

    /// The rotations within a panel, from its start, whose rates at the nodes are these.
    fn turns(&self, rates: &[Vec3<f64>; N]) -> Turns<N, S> {
        let turn = |weights: &[[f64; N]; 3]| so3::exp(magnus(step_moments(weights, rates)));
        let mut net = Quat::identity();
        let ends = from_fn(|k| {
            net = net.then(turn(&self.steps[k]));
            net
        });
        let nodes = from_fn(|n| {
            let before = self.step_of[n].checked_sub(1).map_or(Quat::identity(), |k| ends[k]);
            before.then(turn(&self.parts[n]))
        });
        Turns { ends, nodes }
    }

    /// A panel that starts at this attitude, with a scaled momentum along inertial axes. Its rates are NaN where they do not converge.
    pub(super) fn panel(
        &self,
        start: Quat<f64>,
        scaled_momentum: Vec3<f64>,
        responses: [BaseResponse<f64>; N],
    ) -> Panel<N, S> {
        let mut back = [start.inverse().matrix(); N];
        let mut rates: [Vec3<f64>; N] = from_fn(|n| responses[n].with(back[n] * scaled_momentum));
        let mut has_converged = true;
        for _ in 0..ITERATIONS {
            let turns = self.turns(&rates);
            back = turns.nodes.map(|node| start.then(node).inverse().matrix());
            let next: [Vec3<f64>; N] = from_fn(|n| responses[n].with(back[n] * scaled_momentum));
            let square = |v: Vec3<f64>| v.dot(v);
            let change = (0..N).map(|n| square(next[n] - rates[n])).fold(0.0, f64::max);
            let size = next.iter().map(|rate| square(*rate)).fold(0.0, f64::max);
            rates = next;
            has_converged = change <= CONVERGED * CONVERGED * size;
            if change <= SAME * SAME * size {
                break;
            }
        }
        if !has_converged {
            rates = [Vec3::new(f64::NAN, f64::NAN, f64::NAN); N];
        }
        let scaled_momenta = back.map(|back| back * scaled_momentum);
        Panel { turns: self.turns(&rates), rates, responses, back, scaled_momenta }
    }

    /// How the end of a panel follows its start and its rates.
    pub(super) fn slopes(&self, panel: &Panel<N, S>) -> PanelSlopes<N> {
        let Panel { rates, responses, scaled_momenta, turns, .. } = panel;
        let by_rate = |weights: &[[f64; N]; 3]| -> [Matrix3<f64>; N] {
            let moments = step_moments(weights, rates);
            let jacobian = so3::right_jacobian(magnus(moments));
            let by_moment = magnus_slopes(moments).map(|slope| Matrix3::from(jacobian * slope));
            from_fn(|n| (0..3).map(|k| by_moment[k] * weights[k][n]).sum())
        };
        let of_steps: [[Matrix3<f64>; N]; S] = from_fn(|k| by_rate(&self.steps[k]));
        let matrix = |turn: Quat<f64>| Matrix3::from(turn.matrix());
        let ends = turns.ends.map(matrix);
        let at_nodes = turns.nodes.map(matrix);
        // How a place, after so many steps, is turned by what turns the ends of these.
        let through = |place: &Matrix3<f64>, steps: usize, n: usize| -> Matrix3<f64> {
            let back = place.transpose();
            (0..steps).map(|k| back * ends[k] * of_steps[k][n]).sum()
        };
        // A turn of a node changes the momentum along its axes, and that its rate.
        let by_turn: [Matrix3<f64>; N] = from_fn(|n| {
            let cross = Mat3::cross(scaled_momenta[n]);
            Matrix3::from(Mat3(cross.0.map(|column| responses[n].inverse_inertia * column)))
        });
        let mut own = vec![[Matrix3::zeros(); N]; N];
        for (n, row) in own.iter_mut().enumerate() {
            let part = by_rate(&self.parts[n]);
            for (m, entry) in row.iter_mut().enumerate() {
                *entry = part[m] + through(&at_nodes[n], self.step_of[n], m);
            }
        }
        let last = ends[S - 1];
        let of_end: [Matrix3<f64>; N] = from_fn(|n| through(&last, S, n));
        let by_rate = solve(&of_end, &by_turn, &own);
        let from_start = (0..N).map(|n| by_rate[n] * by_turn[n] * at_nodes[n].transpose());
        PanelSlopes { by_start: last.transpose() + from_start.sum::<Matrix3<f64>>(), by_rate }
    }
}

/// Most unknowns of a panel: three of each of six nodes.
const MOST_UNKNOWNS: usize = 18;

/// `X (1 − B K) = E` by blocks of three, `B` on the diagonal.
fn solve<const N: usize>(
    of_end: &[Matrix3<f64>; N],
    by_turn: &[Matrix3<f64>; N],
    own: &[[Matrix3<f64>; N]],
) -> [Matrix3<f64>; N] {
    let mut matrix = SMatrix::<f64, MOST_UNKNOWNS, MOST_UNKNOWNS>::identity();
    let mut right = SMatrix::<f64, MOST_UNKNOWNS, 3>::zeros();
    for n in 0..N {
        for (m, own) in own[n].iter().enumerate() {
            let block = (by_turn[n] * own).transpose();
            let mut place = matrix.fixed_view_mut::<3, 3>(3 * m, 3 * n);
            place -= block;
        }
        right.fixed_view_mut::<3, 3>(3 * n, 0).copy_from(&of_end[n].transpose());
    }
    // Singular only where a panel is far too wide for the momentum: then nothing is known.
    let found = matrix.lu().solve(&right).unwrap_or_else(|| SMatrix::repeat(f64::NAN));
    from_fn(|n| found.fixed_view::<3, 3>(3 * n, 0).transpose())
}

/// Rotations within a panel, from its start.
struct Turns<const N: usize, const S: usize> {
    /// To the end of every step.
    ends: [Quat<f64>; S],
    nodes: [Quat<f64>; N],
}

/// A panel that has been followed.
pub(super) struct Panel<const N: usize, const S: usize> {
    turns: Turns<N, S>,
    rates: [Vec3<f64>; N],
    responses: [BaseResponse<f64>; N],
    /// Turns inertial axes into base axes at every node.
    back: [Mat3<f64>; N],
    /// The scaled momentum along base axes at every node.
    pub(super) scaled_momenta: [Vec3<f64>; N],
}

impl<const N: usize, const S: usize> Panel<N, S> {
    /// From the panel's start to its end.
    pub(super) fn rotation(&self) -> Quat<f64> {
        self.turns.ends[S - 1]
    }

    /// What more scaled momentum, along inertial axes, adds to the rate at a node.
    pub(super) fn answer(&self, node: usize, scaled_momentum: Vec3<f64>) -> Vec3<f64> {
        self.responses[node].inverse_inertia * (self.back[node] * scaled_momentum)
    }
}

/// How the end of a panel turns, in base axes there.
pub(super) struct PanelSlopes<const N: usize> {
    /// By a turn of the start, in base axes there.
    pub(super) by_start: Matrix3<f64>,
    /// By what is added to the rate at each node, whatever the attitude there.
    pub(super) by_rate: [Matrix3<f64>; N],
}
