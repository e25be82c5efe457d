//! Robots and motions drawn from bytes, and what they come to: momentum body by body, classical Runge–Kutta in quaternions, peaks by dense
//! samples. Slow, and nothing of it is the crate's.

use std::fmt::Write as _;

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

/// A serial arm on a base, a task and a path of the paper's family with two terms.
#[derive(Debug)]
pub struct Draw {
    base_mass: f64,
    base_inertia: Matrix3<f64>,
    mount: Vector3<f64>,
    joints: Vec<JointDraw>,
    start_zyx: [f64; 3],
    goal_zyx: [f64; 3],
    base_weight: f64,
    pub coefficients: Vec<f64>,
}

#[derive(Debug)]
struct JointDraw {
    /// Offset, d, a and twist \[rad, m, m, rad\].
    dh: [f64; 4],
    /// \[°\].
    range: [f64; 2],
    mass: f64,
    centre: Vector3<f64>,
    inertia: Matrix3<f64>,
    /// \[°\].
    start: f64,
    goal: f64,
    /// \[°/s, °/s², °/s³\].
    limits: [f64; 3],
}

/// What a motion comes to.
#[derive(Debug)]
pub struct Expected {
    /// The base's error \[rad\].
    pub residual: f64,
    /// Shortest duration within the limits \[s\].
    pub duration: f64,
    /// Eq. 25.
    pub cost: f64,
}

/// Steps of the integration, and samples of the path.
const STEPS: usize = 4_000;

/// Numbers from −1 to 1.
struct Numbers<'a>(std::slice::ChunksExact<'a, u8>);

impl Numbers<'_> {
    fn unit(&mut self) -> Option<f64> {
        let bytes = self.0.next()?;
        Some(f64::from(u16::from_le_bytes([bytes[0], bytes[1]])) / 32_767.5 - 1.0)
    }

    fn between(&mut self, low: f64, high: f64) -> Option<f64> {
        Some(low + (high - low) * (self.unit()? + 1.0) / 2.0)
    }

    /// From `low` to `high`, even in the logarithm.
    fn size(&mut self, low: f64, high: f64) -> Option<f64> {
        Some(self.between(low.ln(), high.ln())?.exp())
    }

    fn vector(&mut self, size: f64) -> Option<Vector3<f64>> {
        Some(Vector3::new(self.unit()?, self.unit()?, self.unit()?) * size)
    }

    /// An inertia that a body has: principal moments of point masses, turned.
    fn inertia(&mut self, size: f64) -> Option<Matrix3<f64>> {
        let squares = self.vector(1.0)?.map(|x| 0.05 + x * x);
        let total = squares.sum();
        let turn = Rotation3::new(self.vector(1.5)?);
        let moments = Matrix3::from_diagonal(&squares.map(|square| size * (total - square)));
        Some(turn * moments * turn.inverse())
    }
}

impl Draw {
    /// None where the bytes do not suffice.
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let (count, rest) = bytes.split_first()?;
        let mut numbers = Numbers(rest.chunks_exact(2));
        let n = &mut numbers;
        let base_mass = n.size(20.0, 5_000.0)?;
        let base_inertia = n.inertia(0.3 * base_mass)?;
        let mount = n.vector(1.0)?;
        let angles = |n: &mut Numbers<'_>, size: f64| {
            Some([size * n.unit()?, size * n.unit()?, size * n.unit()?])
        };
        let (start_zyx, goal_zyx) = (angles(n, 60.0)?, angles(n, 60.0)?);
        let base_weight = n.between(0.1, 0.95)?;
        let mut joints = Vec::new();
        let mut coefficients = Vec::new();
        for _ in 0..1 + count % 7 {
            let middle = n.between(-90.0, 90.0)?;
            let half = n.between(30.0, 200.0)?;
            let mass = n.size(0.5, 60.0)?;
            joints.push(JointDraw {
                dh: [n.between(-3.2, 3.2)?, n.unit()?, n.unit()?, n.between(-3.2, 3.2)?],
                range: [middle - half, middle + half],
                mass,
                centre: n.vector(0.5)?,
                inertia: n.inertia(0.1 * mass)?,
                start: middle + 0.95 * half * n.unit()?,
                goal: middle + 0.95 * half * n.unit()?,
                limits: [n.size(1.0, 200.0)?, n.size(1.0, 400.0)?, n.size(1.0, 900.0)?],
            });
            coefficients.extend([2.0 * n.unit()?, n.unit()?]);
        }
        Some(Self {
            base_mass,
            base_inertia,
            mount,
            joints,
            start_zyx,
            goal_zyx,
            base_weight,
            coefficients,
        })
    }

    /// The robot as a file.
    pub fn robot_text(&self) -> String {
        let inertia = |m: &Matrix3<f64>| {
            format!(
                "{{ xx = {:?}, yy = {:?}, zz = {:?}, xy = {:?}, xz = {:?}, yz = {:?} }}",
                m[(0, 0)],
                m[(1, 1)],
                m[(2, 2)],
                m[(0, 1)],
                m[(0, 2)],
                m[(1, 2)]
            )
        };
        let mut text = format!(
            "name = 'drawn'\n[base]\nmass = {:?}\nmount = {:?}\ninertia = {}\n",
            self.base_mass,
            self.mount.as_slice(),
            inertia(&self.base_inertia)
        );
        for joint in &self.joints {
            let [offset, d, a, twist] = joint.dh;
            let _ = writeln!(
                text,
                "[[joint]]\ndh = {{ offset_deg = {:?}, d = {d:?}, a = {a:?}, alpha_deg = {:?} }}\nrange_deg = {:?}\n\
                 mass = {:?}\ncentre_of_mass = {:?}\ninertia = {}",
                offset.to_degrees(),
                twist.to_degrees(),
                joint.range,
                joint.mass,
                joint.centre.as_slice(),
                inertia(&joint.inertia)
            );
        }
        text
    }

    /// The task as a file beside `robot.toml`.
    pub fn task_text(&self) -> String {
        let list = |value: &dyn Fn(&JointDraw) -> f64| -> Vec<f64> {
            self.joints.iter().map(value).collect()
        };
        format!(
            "[task]\nrobot = 'robot.toml'\n[task.start]\njoints_deg = {:?}\nbase_zyx_deg = {:?}\n\
             [task.goal]\njoints_deg = {:?}\nbase_zyx_deg = {:?}\n[task.limits]\nrate_deg_s = {:?}\n\
             acceleration_deg_s2 = {:?}\njerk_deg_s3 = {:?}\n[task.weights]\nbase = {:?}\n[trajectory]\nterms = 2\n",
            list(&|joint| joint.start),
            self.start_zyx,
            list(&|joint| joint.goal),
            self.goal_zyx,
            list(&|joint| joint.limits[0]),
            list(&|joint| joint.limits[1]),
            list(&|joint| joint.limits[2]),
            self.base_weight
        )
    }

    /// What the motion comes to.
    pub fn integrate(&self) -> Expected {
        let phases: Vec<Phase> = self
            .joints
            .iter()
            .zip(self.coefficients.chunks_exact(2))
            .map(|(joint, c)| Phase::new(joint, c))
            .collect();
        let rate = |tau: f64| {
            let states: Vec<[f64; 4]> = phases.iter().map(|phase| phase.at(tau)).collect();
            self.base_rate(&states)
        };
        let h = 1.0 / STEPS as f64;
        let mut q = zyx(self.start_zyx).into_inner();
        let slope = |q: Quaternion<f64>, w: Vector3<f64>| q * Quaternion::from_imag(w) * 0.5;
        let mut first = rate(0.0);
        for i in 0..STEPS {
            let middle = rate((i as f64 + 0.5) * h);
            let last = rate((i as f64 + 1.0) * h);
            let k1 = slope(q, first);
            let k2 = slope(q + k1 * (0.5 * h), middle);
            let k3 = slope(q + k2 * (0.5 * h), middle);
            let k4 = slope(q + k3 * h, last);
            q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
            first = last;
        }
        let residual = zyx(self.goal_zyx).angle_to(&UnitQuaternion::from_quaternion(q));
        let mut duration = 0.0_f64;
        for (phase, joint) in phases.iter().zip(&self.joints) {
            for k in 0..3 {
                let peak = highest(|tau| phase.at(tau)[k + 1].abs());
                duration =
                    duration.max((peak / joint.limits[k].to_radians()).powf(1.0 / (k + 1) as f64));
            }
        }
        let error = (residual / 2.0).sin() / 0.5_f64.to_radians().sin();
        let cost = self.base_weight * error + (1.0 - self.base_weight) * duration;
        Expected { residual, duration, cost }
    }

    /// The base's angular velocity in its own axes: with the base held, bodies have some momentum; the base's motion
    /// makes it zero.
    fn base_rate(&self, states: &[[f64; 4]]) -> Vector3<f64> {
        let (mut turn, mut place) = (Rotation3::identity(), self.mount);
        let mut axes: Vec<(Vector3<f64>, Vector3<f64>, f64)> = Vec::new();
        let mut bodies = vec![(
            self.base_mass,
            self.base_inertia,
            Vector3::zeros(),
            Vector3::zeros(),
            Vector3::zeros(),
        )];
        for (joint, state) in self.joints.iter().zip(states) {
            axes.push((turn * Vector3::z(), place, state[1]));
            turn *= Rotation3::from_axis_angle(&Vector3::z_axis(), state[0]);
            let centre = place + turn * joint.centre;
            let (mut velocity, mut omega) = (Vector3::zeros(), Vector3::zeros());
            for (axis, at, rate) in &axes {
                omega += axis * *rate;
                velocity += axis.cross(&(centre - at)) * *rate;
            }
            bodies.push((
                joint.mass,
                turn * joint.inertia * turn.inverse(),
                centre,
                velocity,
                omega,
            ));
            let [offset, d, a, twist] = joint.dh;
            turn *= Rotation3::from_axis_angle(&Vector3::z_axis(), offset);
            place += turn * Vector3::new(a, 0.0, d);
            turn *= Rotation3::from_axis_angle(&Vector3::x_axis(), twist);
        }
        let mass: f64 = bodies.iter().map(|body| body.0).sum();
        let centre = bodies.iter().map(|body| body.2 * body.0).sum::<Vector3<f64>>() / mass;
        let drift = bodies.iter().map(|body| body.3 * body.0).sum::<Vector3<f64>>() / mass;
        let (mut inertia, mut momentum) = (Matrix3::zeros(), Vector3::zeros());
        for (mass, own, at, velocity, omega) in bodies {
            let arm: Vector3<f64> = at - centre;
            let cross = arm.cross_matrix();
            inertia += own - cross * cross * mass;
            momentum += own * omega + arm.cross(&(velocity - drift)) * mass;
        }
        inertia.lu().solve(&-momentum).expect("bodies have inertia")
    }
}

/// The largest value from 0 to 1: of many, and of as many again about the largest.
fn highest(value: impl Fn(f64) -> f64) -> f64 {
    let (mut place, mut width) = (0.5, 0.5);
    for _ in 0..2 {
        let taus = (0..=STEPS)
            .map(|i| (place + width * (2.0 * i as f64 / STEPS as f64 - 1.0)).clamp(0.0, 1.0));
        place = taus.max_by(|a, b| value(*a).total_cmp(&value(*b))).unwrap_or(place);
        width /= STEPS as f64 / 2.0;
    }
    value(place)
}

fn zyx([yaw, pitch, roll]: [f64; 3]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll.to_radians(), pitch.to_radians(), yaw.to_radians())
}

/// A joint's phase as a polynomial in `τ`, and its range.
struct Phase {
    powers: [f64; 8],
    half: f64,
    middle: f64,
}

impl Phase {
    fn new(joint: &JointDraw, coefficients: &[f64]) -> Self {
        let [low, high] = joint.range.map(f64::to_radians);
        let (half, middle) = ((high - low) / 2.0, (high + low) / 2.0);
        let phase = |angle: f64| ((angle.to_radians() - middle) / half).asin();
        let (start, goal) = (phase(joint.start), phase(joint.goal));
        let mut powers = [start, 0.0, 0.0, 10.0, -15.0, 6.0, 0.0, 0.0];
        powers[3..6].iter_mut().for_each(|power| *power *= goal - start);
        // 64 τ³ (1 − τ)³ (c₀ + √15 c₁ (2τ − 1)): of the weight (1 − x²)⁶, x² has the mean 1/15.
        let window = [0.0, 0.0, 0.0, 64.0, -192.0, 192.0, -64.0];
        let slope = 15.0_f64.sqrt() * coefficients[1];
        let linear = [coefficients[0] - slope, 2.0 * slope];
        for (i, w) in window.into_iter().enumerate() {
            for (j, l) in linear.into_iter().enumerate() {
                powers[i + j] += w * l;
            }
        }
        Self { powers, half, middle }
    }

    /// Angle and three derivatives by `τ`.
    fn at(&self, tau: f64) -> [f64; 4] {
        let mut powers = self.powers;
        let mut s = [0.0; 4];
        for derivative in &mut s {
            *derivative = powers.iter().rev().fold(0.0, |sum, power| sum * tau + power);
            for k in 1..8 {
                powers[k - 1] = k as f64 * powers[k];
            }
            powers[7] = 0.0;
        }
        let [s, s1, s2, s3] = s;
        let (sin, cos) = s.sin_cos();
        [
            self.middle + self.half * sin,
            self.half * cos * s1,
            self.half * (cos * s2 - sin * s1 * s1),
            self.half * (cos * (s3 - s1.powi(3)) - 3.0 * sin * s1 * s2),
        ]
    }
}
