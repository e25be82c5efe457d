//! Torques and speeds against Pinocchio (`reference/dynamics.json`, made by `reference/make_dynamics.py`, for the robots that come with
//! the program and for trees of `reference/trees.json`), slopes against differences, and what both must hold to.

use crate::drawn::{self, Tree};
use driftless::dynamics::{
    Dynamics, Quantity, Slopes, State, joint_torques, tool_velocity, torque_slopes,
};
use driftless::kinematics::Outward;
use driftless::lanes::{LaneWork, Lanes, MOST, Width};
use driftless::momentum::{RateSlopes, Twist, base_twist, total_momentum};
use driftless::robot::{Joint, Robot};
use driftless::vec3::Vec3;
use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    robots: Vec<Shipped>,
    trees: Vec<Drawn>,
}

#[derive(Deserialize)]
struct Shipped {
    name: String,
    states: Vec<Values>,
}

#[derive(Deserialize)]
struct Drawn {
    number: usize,
    states: Vec<Values>,
}

#[derive(Deserialize)]
struct Values {
    positions: Vec<f64>,
    rates: Vec<f64>,
    accelerations: Vec<f64>,
    base_twist: [f64; 6],
    base_acceleration: [f64; 6],
    torques: Vec<f64>,
    tool_velocity: [f64; 3],
    /// By positions, rates and accelerations; a row per joint.
    torque_by: Option<[Vec<Vec<f64>>; 3]>,
}

impl Values {
    fn state(&self) -> State<'_, f64> {
        let Self { positions, rates, accelerations, .. } = self;
        State { positions, rates, accelerations, angular_momentum: Vec3::zero() }
    }
}

/// Every robot and tree, its name, and its states.
fn reference() -> Vec<(String, Robot, Vec<Values>)> {
    let text = include_str!("reference/dynamics.json");
    let Reference { robots, trees } = serde_json::from_str(text).unwrap();
    let robots = robots.into_iter().map(|Shipped { name, states }| {
        let robot = Robot::from_document(&Robot::embedded(&name).unwrap()).unwrap();
        (name, robot, states)
    });
    let drawn: Vec<Tree> = drawn::trees();
    let trees = trees
        .into_iter()
        .map(|Drawn { number, states }| (format!("tree {number}"), drawn[number].robot(), states));
    robots.chain(trees).collect()
}

fn quantities(robot: &Robot) -> Vec<Quantity> {
    let torques = (0..robot.joint_count()).map(Quantity::Torque);
    [Quantity::BaseRate, Quantity::ToolSpeed].into_iter().chain(torques).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// To a part of the largest of the values, or of one.
fn assert_near(what: &str, ours: &[f64], theirs: &[f64], part: f64) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let size = theirs.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() < part * size, "{what}: {a} {b}, of {size}");
    }
}

#[test]
fn all_robots_have_values_and_trees_of_all_sorts() {
    let robots: Vec<Robot> = reference().into_iter().map(|(_, robot, _)| robot).collect();
    for name in Robot::embedded_names() {
        assert!(robots.iter().any(|robot| robot.name() == name), "{name}");
    }
    let slides = |robot: &&Robot| robot.sliding_joint().is_some();
    let fixed = |robot: &&Robot| robot.links().iter().any(|link| link.joint == Joint::Fixed);
    let branches = |robot: &&Robot| {
        robot.links().iter().enumerate().any(|(i, link)| link.parent != i.checked_sub(1))
    };
    for sort in [slides, fixed, branches] {
        assert!(robots.iter().filter(sort).count() > 5);
    }
}

#[test]
fn torques_and_speeds_are_pinocchios() {
    for (name, robot, states) in reference() {
        let mut dynamics = Dynamics::new(&robot);
        for values in states {
            let State { positions, rates, accelerations, .. } = values.state();
            dynamics.evaluate(&robot, values.state());
            let near = |what: &str, ours: &[f64], theirs: &[f64]| {
                assert_near(&format!("{what} of {name}"), ours, theirs, 1e-11);
            };
            let flat = |v: Vec3<f64>, w: Vec3<f64>| [v.x, v.y, v.z, w.x, w.y, w.z];
            let (base, acceleration) = (dynamics.base, dynamics.base_acceleration);
            near("twist", &flat(base.linear, base.angular), &values.base_twist);
            let change = flat(acceleration.linear, acceleration.angular);
            near("base acceleration", &change, &values.base_acceleration);
            near("torques", &dynamics.torques, &values.torques);
            let torques = joint_torques(&robot, positions, rates, accelerations);
            assert_eq!(torques, dynamics.torques);
            let velocity = Vector3::from(tool_velocity(&robot, positions, rates));
            near("tool", velocity.as_slice(), &values.tool_velocity);
            let speeds = [Quantity::BaseRate, Quantity::ToolSpeed].map(|q| dynamics.get(q));
            let theirs = [norm(&values.base_twist[3..]), norm(&values.tool_velocity)];
            near("speeds", &speeds, &theirs);
            for quantity in quantities(&robot) {
                let alone = dynamics.value(&robot, quantity, values.state());
                near("one quantity", &[alone], &[dynamics.get(quantity)]);
            }
        }
    }
}

/// Every quantity at several states at once.
struct InLanes<'a>(&'a Robot, &'a [Values]);

impl LaneWork for InLanes<'_> {
    type Output = Vec<Vec<f64>>;

    #[inline(always)]
    fn run<T: Lanes>(self) -> Vec<Vec<f64>> {
        let Self(robot, states) = self;
        let mut dynamics = Dynamics::<T>::new(robot);
        let mut all = Vec::new();
        for states in states.chunks(T::COUNT) {
            let gather = |of: fn(&Values) -> &[f64]| -> Vec<T> {
                let lanes = (0..robot.joint_count()).map(|joint| {
                    let mut numbers = [0.0; MOST];
                    for (number, state) in numbers.iter_mut().zip(states) {
                        *number = of(state)[joint];
                    }
                    T::load(&numbers)
                });
                lanes.collect()
            };
            let positions = gather(|state| &state.positions);
            let rates = gather(|state| &state.rates);
            let accelerations = gather(|state| &state.accelerations);
            let (positions, rates, accelerations) = (&positions, &rates, &accelerations);
            dynamics.evaluate(
                robot,
                State { positions, rates, accelerations, angular_momentum: Vec3::zero() },
            );
            for lane in 0..states.len() {
                let value = |quantity| dynamics.get(quantity).numbers()[lane];
                all.push(quantities(robot).into_iter().map(value).collect());
            }
        }
        all
    }
}

#[test]
fn lanes_hold_states_of_their_own() {
    for (name, robot, states) in reference() {
        let one = Width::Scalar.run(InLanes(&robot, &states));
        for width in Width::available() {
            let found = width.run(InLanes(&robot, &states));
            for (ours, theirs) in found.iter().zip(&one) {
                assert_near(&name, ours, theirs, 1e-12);
            }
        }
    }
}

/// A quantity's derivative by one number of a state.
fn difference(
    robot: &Robot,
    quantity: Quantity,
    values: &Values,
    which: usize,
    joint: usize,
) -> f64 {
    let at = |step: f64| {
        let Values { positions, rates, accelerations, .. } = values;
        let mut state = [positions.clone(), rates.clone(), accelerations.clone()];
        state[which][joint] += step;
        let [positions, rates, accelerations] = &state;
        [Dynamics::new(robot).value(
            robot,
            quantity,
            State { positions, rates, accelerations, angular_momentum: Vec3::zero() },
        )]
    };
    derivative(at)[0]
}

#[test]
fn slopes_are_differences() {
    for (name, robot, states) in reference() {
        let values = &states[0];
        let mut dynamics = Dynamics::new(&robot);
        dynamics.evaluate(&robot, values.state());
        let quantities = quantities(&robot);
        let (speeds, torques) = quantities.split_at(2);
        for quantities in [speeds, torques] {
            let ours = quantities.iter().map(|q| Slopes::of(&robot, *q, values.state()).value);
            let theirs: Vec<f64> = quantities.iter().map(|q| dynamics.get(*q)).collect();
            assert_near(&name, &ours.collect::<Vec<_>>(), &theirs, 1e-12);
        }
        for quantity in quantities {
            let slopes = Slopes::of(&robot, quantity, values.state());
            let all = [&slopes.by_position, &slopes.by_rate, &slopes.by_acceleration];
            for (which, ours) in all.into_iter().enumerate() {
                let by = |joint| difference(&robot, quantity, values, which, joint);
                let theirs: Vec<f64> = (0..robot.joint_count()).map(by).collect();
                assert_near(&format!("{quantity:?} of {name} by {which}"), ours, &theirs, 1e-9);
            }
            if let Quantity::Torque(joint) = quantity {
                let State { positions, rates, accelerations, .. } = values.state();
                let [p, r, a] = torque_slopes(&robot, positions, rates, accelerations, joint);
                assert_eq!([&p, &r, &a], all);
            }
        }
    }
}

#[test]
fn slopes_of_torques_are_pinocchios() {
    let mut seen = 0;
    for (name, robot, states) in reference() {
        for values in &states {
            let Some(theirs) = &values.torque_by else { continue };
            let State { positions, rates, accelerations, .. } = values.state();
            let joints = 0..robot.joint_count();
            let ours: Vec<[Vec<f64>; 3]> = joints
                .map(|joint| torque_slopes(&robot, positions, rates, accelerations, joint))
                .collect();
            for which in 0..3 {
                let flat: Vec<f64> = ours.iter().flat_map(|own| own[which].clone()).collect();
                assert_near(&name, &flat, &theirs[which].concat(), 1e-11);
            }
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

/// `RateSlopes` are in closed form, and right to 50 digits (`trees.rs`).
#[test]
fn slopes_of_the_base_rate_are_those_in_closed_form() {
    for (name, robot, states) in reference() {
        let state = states[0].state();
        let mut closed = RateSlopes::new(&robot);
        closed.evaluate(&robot, state.positions, state.rates);
        let slopes = Slopes::of(&robot, Quantity::BaseRate, state);
        for (ours, by) in
            [(&slopes.by_position, &closed.by_position), (&slopes.by_rate, &closed.by_rate)]
        {
            let along = |v: &Vec3<f64>| closed.angular.dot(*v) / slopes.value;
            assert_near(&name, ours, &by.iter().map(along).collect::<Vec<_>>(), 1e-12);
        }
    }
}

/// At rest no speed is smooth; torques are.
#[test]
fn slopes_at_rest_are_finite() {
    for (name, robot, states) in reference() {
        let rest = vec![0.0; robot.joint_count()];
        for quantity in quantities(&robot) {
            let state = State { rates: &rest, ..states[0].state() };
            let Slopes { value, by_position, by_rate, by_acceleration } =
                Slopes::of(&robot, quantity, state);
            let all = [by_position, by_rate, by_acceleration].concat();
            assert!(all.iter().all(|slope| slope.is_finite()), "{quantity:?} of {name}");
            if !matches!(quantity, Quantity::Torque(_)) {
                assert_eq!(value, 0.0);
                assert!(all.iter().all(|slope| *slope == 0.0), "{quantity:?} of {name}");
            }
        }
    }
}

/// Momentum, term by term as in eq. 5, stays zero where the base's twist changes by its acceleration; as it is zero, its
/// derivative is the same along axes that turn.
#[test]
fn nothing_pushes_the_base() {
    for (name, robot, states) in reference() {
        let mut dynamics = Dynamics::new(&robot);
        for values in &states {
            dynamics.evaluate(&robot, values.state());
            let (twist, change) = (dynamics.base, dynamics.base_acceleration);
            let at = |t: f64| {
                let (there, rates) = moved(values, t);
                let base = Twist {
                    linear: twist.linear + change.linear * t,
                    angular: twist.angular + change.angular * t,
                };
                let (linear, angular) = total_momentum(&robot, &there, &rates, &base);
                [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]
            };
            let size = norm(&values.torques).max(robot.total_mass());
            for push in derivative(at) {
                assert!(push.abs() < 1e-10 * size, "{name}: {push:e} of {size}");
            }
        }
    }
}

/// Positions and rates a time after a state, with constant accelerations.
fn moved(values: &Values, t: f64) -> (Vec<f64>, Vec<f64>) {
    let Values { positions, rates, accelerations, .. } = values;
    let joints = positions.iter().zip(rates).zip(accelerations);
    joints.map(|((q, v), a)| (q + t * (v + 0.5 * t * a), v + t * a)).unzip()
}

/// By central differences of fourth order, at zero.
fn derivative<const N: usize>(of: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let h = 1e-3;
    let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(of);
    std::array::from_fn(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h))
}

/// Kinetic energy, body by body: `Σ ½ m v² + ½ ω·I ω`.
fn energy(robot: &Robot, positions: &[f64], rates: &[f64]) -> f64 {
    let base = base_twist(robot, positions, rates);
    let [linear, angular] = [base.linear, base.angular].map(Vector3::from);
    let body = robot.base();
    let mut sum = body.mass * linear.norm_squared() + angular.dot(&(body.inertia * angular));
    let links: Vec<_> = Outward::<f64>::new(robot, positions).collect();
    let mut own = vec![0.0; links.len()];
    for (joint, rate) in robot.joints().zip(rates) {
        own[joint.link] = *rate;
    }
    for (i, link) in links.iter().enumerate() {
        let centre = Vector3::from(link.centre_of_mass);
        let (mut v, mut w) = (linear + angular.cross(&centre), angular);
        for inner in robot.chain_to(i) {
            let axis = Vector3::from(links[inner].axis) * own[inner];
            match links[inner].link.joint {
                Joint::Revolute(_) => {
                    v += axis.cross(&(centre - Vector3::from(links[inner].frame.position)));
                    w += axis;
                }
                Joint::Prismatic(_) => v += axis,
                Joint::Fixed => {}
            }
        }
        let spin = Matrix3::from(link.frame.rotation).transpose() * w;
        let body = &link.link.body;
        sum += body.mass * v.norm_squared() + spin.dot(&(body.inertia * spin));
    }
    0.5 * sum
}

/// What joints put in is what the system's kinetic energy gains.
#[test]
fn power_is_the_energys_derivative() {
    for (name, robot, states) in reference() {
        for values in &states {
            let State { positions, rates, accelerations, .. } = values.state();
            let [gain] = derivative(|t| {
                let (there, rates) = moved(values, t);
                [energy(&robot, &there, &rates)]
            });
            let torques = joint_torques(&robot, positions, rates, accelerations);
            let power: f64 = torques.iter().zip(rates).map(|(torque, rate)| torque * rate).sum();
            let size = torques.iter().zip(rates).map(|(t, r)| (t * r).abs()).sum::<f64>();
            assert!((power - gain).abs() < 1e-9 * (1.0 + size), "{name}: {power} {gain}");
        }
    }
}
