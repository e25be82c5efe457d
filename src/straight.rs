//! The tool on a straight line in inertial space, with or without its orientation kept, while the base floats.
//!
//! The generalised Jacobian of Umetani and Yoshida (DOI 10.1109/70.34766) gives the joints' rates, and with them the base's: both
//! follow from the line, whatever the speed along it.

use nalgebra::{DVector, UnitQuaternion, Vector3};

use crate::momentum::{base_twist, generalised_jacobian};
use crate::robot::Robot;
use crate::so3;
use crate::trajectory::{Limits, Points};
use crate::vec3::Vec3;

/// A straight line for the tool.
#[derive(Debug, Clone)]
pub struct Straight {
    /// Its direction, in the tool's axes at the start.
    pub direction: Vector3<f64>,
    /// How far the tool goes \[m\].
    pub distance: f64,
    /// Whether the tool keeps its orientation, which takes three joints more.
    pub keeps_orientation: bool,
}

/// How joints and base move along a straight line, at equally spaced times of a motion from rest to rest.
#[derive(Debug, Clone)]
pub struct StraightPath {
    distance: f64,
    /// Positions of the joints \[rad or m\], and their first two derivatives by the way of the tool \[m\].
    places: Vec<[DVector<f64>; 3]>,
    /// The base's attitude at either end.
    pub base: [UnitQuaternion<f64>; 2],
}

/// Why the tool cannot go along a line.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StraightError {
    /// No rates of the joints move it on.
    #[error("the joints cannot move the tool straight on after {0:.4} m")]
    Blocked(f64),
    /// A joint leaves its range.
    #[error("joint `{0}` leaves its range after {1:.4} m")]
    Range(String, f64),
    /// The line is too short to be told from none.
    #[error("found a line of {0:e} m, expected {SHORTEST:e} m or more")]
    Short(f64),
    /// Momentum turns the base meanwhile.
    #[error("found a robot that has angular momentum, expected none on a straight line")]
    Drift,
}

/// The shortest line \[m\].
const SHORTEST: f64 = 1e-6;

/// Steps of a motion along the line.
const STEPS: usize = 256;

/// Largest residual of the tool's unit velocity.
const FOLLOWS: f64 = 1e-9;

/// Singular values of the Jacobian below this are zero.
const SINGULAR: f64 = 1e-6;

/// Joints that go further for a metre of the tool's way \[rad or m\] are too near to a singular configuration to follow it.
const MOST_RATE: f64 = 100.0;

/// The longest step of the joints \[rad or m\].
const STEP: f64 = 0.02;

/// Joints and base on the way.
#[derive(Clone)]
struct State {
    joints: DVector<f64>,
    base: UnitQuaternion<f64>,
}

struct Line<'a> {
    robot: &'a Robot,
    /// In inertial axes.
    direction: Vector3<f64>,
    rows: usize,
}

impl Straight {
    /// From where joints \[rad or m\] and base are.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer positions than joints that move.
    pub fn path(
        &self,
        robot: &Robot,
        joints: &[f64],
        base: UnitQuaternion<f64>,
    ) -> Result<StraightPath, StraightError> {
        if self.distance < SHORTEST {
            return Err(StraightError::Short(self.distance));
        }
        let tool = crate::kinematics::tool(robot, joints);
        let along = Vector3::from(tool.rotation * Vec3::of(&self.direction));
        let rows = if self.keeps_orientation { 6 } else { 3 };
        let line = Line { robot, direction: base * along.normalize(), rows };
        // Step of the central difference for the second derivative.
        let apart = self.distance / STEPS as f64;
        let way = |i: usize| self.distance * phase(i as f64 / STEPS as f64)[0];
        let mut state = State { joints: DVector::from_column_slice(joints), base };
        let mut places = Vec::with_capacity(STEPS + 1);
        for i in 0..=STEPS {
            let at = way(i);
            let blocked = || StraightError::Blocked(at);
            for (joint, position) in robot.joints().zip(&state.joints) {
                if !(joint.range[0]..=joint.range[1]).contains(position) {
                    return Err(StraightError::Range(joint.name.to_owned(), at));
                }
            }
            let slope = line.rates(&state).ok_or_else(blocked)?;
            // The second derivative by a central difference of the fourth order along the line.
            let [far, near] = [apart, apart / 2.0].map(|h| {
                let at = |h| line.rates(&line.moved(&state, h)?);
                Some((at(h)? - at(-h)?) / (2.0 * h))
            });
            let bend = (near.ok_or_else(blocked)? * 4.0 - far.ok_or_else(blocked)?) / 3.0;
            places.push([state.joints.clone(), slope, bend]);
            if i < STEPS {
                state = line.moved(&state, way(i + 1) - at).ok_or_else(blocked)?;
            }
        }
        Ok(StraightPath { distance: self.distance, places, base: [base, state.base] })
    }
}

impl Line<'_> {
    /// The joints' rates for unit speed of the tool, the smallest ones; none where none move it so.
    fn rates(&self, state: &State) -> Option<DVector<f64>> {
        let robot = self.robot;
        let all = generalised_jacobian(robot, state.joints.as_slice());
        let jacobian = robot.by_leading(all.rows(0, self.rows).as_view());
        let mut twist = DVector::zeros(self.rows);
        twist.rows_mut(0, 3).copy_from(&(state.base.inverse() * self.direction));
        // The iterations of a decomposition would not end.
        if !jacobian.iter().chain(&twist).all(|number| number.is_finite()) {
            return None;
        }
        let rates = jacobian.clone().svd(true, true).solve(&twist, SINGULAR).ok()?;
        if (&jacobian * &rates - twist).norm() > FOLLOWS || rates.norm() > MOST_RATE {
            return None;
        }
        let mut listed = vec![0.0; robot.joint_count()];
        robot.leading().zip(&rates).for_each(|(joint, rate)| listed[joint] = *rate);
        robot.drive_followers(&mut listed);
        Some(DVector::from_vec(listed))
    }

    /// After so much more of the way \[m\].
    fn moved(&self, state: &State, way: f64) -> Option<State> {
        let mut state = state.clone();
        let mut left = way;
        while left != 0.0 {
            let most = STEP / self.rates(&state)?.norm().max(f64::MIN_POSITIVE);
            let step = left.clamp(-most, most);
            state = self.stepped(&state, step)?;
            left -= step;
        }
        Some(state)
    }

    /// The same in one step of the classical Runge-Kutta method; the base's turn as a rotation vector.
    fn stepped(&self, state: &State, step: f64) -> Option<State> {
        let at = |by: &(DVector<f64>, Vec3<f64>)| State {
            joints: &state.joints + &by.0,
            base: state.base * UnitQuaternion::from(so3::exp(by.1)),
        };
        // The derivative of the rotation vector, to the third order in it.
        let slope = |turned: Vec3<f64>, state: &State| {
            let rates = self.rates(state)?;
            let spin = base_twist(self.robot, state.joints.as_slice(), rates.as_slice()).angular;
            let cross = turned.cross(spin);
            Some((rates, spin + cross * 0.5 + turned.cross(cross) * (1.0 / 12.0)))
        };
        let zero = Vec3::of(&Vector3::zeros());
        let a = slope(zero, state)?;
        let by = |s: &(DVector<f64>, Vec3<f64>), h: f64| (&s.0 * h, s.1 * h);
        let half = by(&a, step / 2.0);
        let b = slope(half.1, &at(&half))?;
        let half = by(&b, step / 2.0);
        let c = slope(half.1, &at(&half))?;
        let whole = by(&c, step);
        let d = slope(whole.1, &at(&whole))?;
        let joints = (a.0 + (b.0 + c.0) * 2.0 + d.0) * (step / 6.0);
        let turn = (a.1 + (b.1 + c.1) * 2.0 + d.1) * (step / 6.0);
        Some(at(&(joints, turn)))
    }
}

impl StraightPath {
    /// The joints at either end \[rad or m\].
    pub fn ends(&self) -> [&[f64]; 2] {
        [0, STEPS].map(|place| self.places[place][0].as_slice())
    }

    /// How far the tool goes \[m\].
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The same line the other way.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let turned = |[at, slope, bend]: &[DVector<f64>; 3]| [at.clone(), -slope, bend.clone()];
        let [from, to] = self.base;
        Self {
            distance: self.distance,
            places: self.places.iter().rev().map(turned).collect(),
            base: [to, from],
        }
    }

    /// The motion along the line from rest to rest in the shortest time within the limits: the tool's way is a polynomial of
    /// seventh degree in time, with rate, acceleration and jerk of nothing at both ends.
    pub fn timed(&self, limits: &Limits) -> Points {
        let unit = self.points(1.0);
        let duration = unit.played().peaks().shortest_duration(limits);
        self.points(duration)
    }

    /// The same in a given time \[s\].
    pub fn points(&self, duration: f64) -> Points {
        let joints = self.places[0][0].len();
        let mut values = [Vec::new(), Vec::new(), Vec::new()];
        let mut times = Vec::new();
        for (i, [at, slope, bend]) in self.places.iter().enumerate() {
            let tau = i as f64 / STEPS as f64;
            let [_, rate, acceleration] = phase(tau).map(|value| value * self.distance);
            let (rate, acceleration) = (rate / duration, acceleration / duration.powi(2));
            times.push(tau * duration);
            values[0].extend(at.iter());
            values[1].extend((slope * rate).iter());
            values[2].extend((bend * rate.powi(2) + slope * acceleration).iter());
        }
        Points::new(times, joints, values)
    }
}

/// The share of the way that has passed at a share of the time, and its first two derivatives.
fn phase(tau: f64) -> [f64; 3] {
    let left = 1.0 - tau;
    [
        tau.powi(4) * (35.0 + tau * (-84.0 + tau * (70.0 - 20.0 * tau))),
        140.0 * (tau * left).powi(3),
        420.0 * (tau * left).powi(2) * (1.0 - 2.0 * tau),
    ]
}
