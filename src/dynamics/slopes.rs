//! First derivatives of a quantity, by numbers that carry them.

use super::dual::Dual;
use super::{Dynamics, Quantity, State};
use crate::lanes::{LaneWork, Lanes, MOST, Width};
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::vec3::Vec3;

/// A quantity at one state, and its derivatives by what each joint that moves does.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// The quantity itself.
    pub value: f64,
    /// By positions.
    pub by_position: Vec<f64>,
    /// By rates.
    pub by_rate: Vec<f64>,
    /// By accelerations; zeros but for torques.
    pub by_acceleration: Vec<f64>,
}

impl Slopes {
    /// Works them out, to rounding. Where a speed is zero, and not smooth, all of its slopes are.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions, rates or accelerations than joints that move, or no such joint.
    pub fn of(robot: &Robot, quantity: Quantity, state: State<'_, f64>) -> Self {
        Width::widest().run(Work { robot, quantity, state })
    }
}

/// Lanes hold one state, each with a direction of its own.
struct Work<'a> {
    robot: &'a Robot,
    quantity: Quantity,
    state: State<'a, f64>,
}

impl LaneWork for Work<'_> {
    type Output = Slopes;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Slopes {
        let Self { robot, quantity, state } = self;
        let State { positions, rates, accelerations, angular_momentum } = state;
        let angular_momentum = angular_momentum.map(Dual::of);
        let count = robot.joint_count();
        let lifted = |numbers: &[f64]| -> Vec<_> { numbers.iter().map(|n| Dual::of(*n)).collect() };
        let mut moving = [lifted(positions), lifted(rates)].concat();
        let still = lifted(accelerations);
        let mut dynamics = Dynamics::<Dual<T>>::new(robot);
        let mut value = 0.0;
        let mut slopes = Vec::with_capacity(2 * count + MOST);
        for first in (0..2 * count).step_by(T::COUNT) {
            for (i, number) in moving.iter_mut().enumerate() {
                let mut direction = [0.0; MOST];
                if (first..first + T::COUNT).contains(&i) {
                    direction[i - first] = 1.0;
                }
                number.slope = T::load(&direction);
            }
            let (positions, rates) = moving.split_at(count);
            let state = State { positions, rates, accelerations: &still, angular_momentum };
            let found = dynamics.value(robot, quantity, state);
            value = found.value.numbers()[0];
            slopes.extend(&found.slope.numbers()[..T::COUNT]);
        }
        slopes.truncate(2 * count);
        let by_rate = slopes.split_off(count);
        let by_acceleration = match quantity {
            Quantity::Torque(joint) => inertia_of(robot, positions, joint),
            Quantity::BaseRate | Quantity::ToolSpeed => vec![0.0; count],
        };
        Slopes { value, by_position: slopes, by_rate, by_acceleration }
    }
}

/// A row of the inertia that the joints feel, which is symmetric: all torques for unit acceleration of one joint at rest.
fn inertia_of(robot: &Robot, positions: &[f64], joint: usize) -> Vec<f64> {
    let rest = vec![0.0; positions.len()];
    let mut accelerations = rest.clone();
    accelerations[joint] = 1.0;
    super::joint_torques(robot, positions, &rest, &accelerations)
}

/// Derivatives of a joint's torque by all positions, rates and accelerations.
///
/// # Panics
///
/// As [`Slopes::of`].
pub fn torque_slopes(
    robot: &Robot,
    positions: &[f64],
    rates: &[f64],
    accelerations: &[f64],
    joint: usize,
) -> [Vec<f64>; 3] {
    let angular_momentum = Vec3::zero();
    let state = State { positions, rates, accelerations, angular_momentum };
    let slopes = Slopes::of(robot, Quantity::Torque(joint), state);
    [slopes.by_position, slopes.by_rate, slopes.by_acceleration]
}

/// Inertial velocity of the tool's origin \[m/s\], along base axes.
///
/// # Panics
///
/// Panics when there are more or fewer positions or rates than joints that move.
pub fn tool_velocity(robot: &Robot, positions: &[f64], rates: &[f64]) -> Vec3<f64> {
    let mut dynamics = Dynamics::new(robot);
    let angular_momentum = Vec3::zero();
    let state = State { positions, rates, accelerations: &[], angular_momentum };
    dynamics.value(robot, Quantity::ToolSpeed, state);
    dynamics.tool_velocity
}
