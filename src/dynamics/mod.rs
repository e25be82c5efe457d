//! What of a state limits hold down: torques of joints, the tool's speed and the base's rate, with slopes.
//!
//! Nothing pulls from outside, so the base moves as the joints and the total angular momentum make it, and neither its
//! attitude nor its place matters. Derivatives by any time will do: of rates and accelerations by the normalised time `τ`,
//! and of the momentum times the duration `t_f`, speeds come out times `t_f`, torques times `t_f²`.

mod dual;
mod forces;
mod slopes;

pub use forces::{Dynamics, joint_torques};
pub use slopes::{Slopes, tool_velocity, torque_slopes};

use crate::vec3::Vec3;

/// A number that every state has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Magnitude of the base's angular velocity \[rad/s\].
    BaseRate,
    /// Magnitude of the inertial velocity of the tool's origin \[m/s\].
    ToolSpeed,
    /// Torque \[N·m\] or force \[N\], with its sign, of a joint, by its number among those that move.
    Torque(usize),
}

/// What the joints that move do at one time, or at one time per lane; one entry each.
#[derive(Debug, Clone, Copy)]
pub struct State<'a, T> {
    /// Positions \[rad or m\].
    pub positions: &'a [T],
    /// Their first derivatives.
    pub rates: &'a [T],
    /// Their second derivatives.
    pub accelerations: &'a [T],
    /// Total angular momentum about the system's centre of mass, along base axes \[N·m·s\].
    pub angular_momentum: Vec3<T>,
}
