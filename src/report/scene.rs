//! A motion as the page shows it: where everything is while the robot floats.

use nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;

use super::Satellite;
use crate::analysis::{Run, best_run};
use crate::experiment::Plan;
use crate::kinematics::{Outward, tool};
use crate::problem::{Motion, Reorientation};
use crate::robot::{Joint, Robot};

/// Most instances whose best motion is shown.
pub const MOST_SCENES: usize = 24;

/// Intervals between the frames of a motion.
const INTERVALS: usize = 120;

/// The best motion of an instance.
#[derive(Debug, Clone, Serialize)]
pub struct Scene {
    /// The instance's label; empty where there is but one.
    pub label: String,
    /// Who found it.
    pub optimiser: String,
    /// With which seed.
    pub seed: u64,
    /// Its certified cost.
    pub cost: f64,
    /// How long it takes \[s\].
    pub duration: f64,
    /// What the base looks like.
    pub satellite: Satellite,
    /// The joints, from the base outward.
    pub joints: Vec<JointScene>,
    /// Equally spaced in time, from start to end.
    pub frames: Vec<Frame>,
    /// The goal.
    pub goal: Frame,
}

/// A joint over time, in degrees.
#[derive(Debug, Clone, Serialize)]
pub struct JointScene {
    /// Its name.
    pub name: String,
    /// Smallest and largest angle \[°\].
    pub range: [f64; 2],
    /// Limits on rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\].
    pub limits: [f64; 3],
    /// Angle \[°\], rate \[°/s\], acceleration \[°/s²\] and jerk \[°/s³\] in every frame.
    pub states: Vec<[f64; 4]>,
}

/// Where everything is at one time. Inertial axes have their origin at the system's centre of mass, which
/// nothing moves as long as no force acts from outside.
#[derive(Debug, Clone, Serialize)]
pub struct Frame {
    /// The base's centre of mass, inertial axes \[m\].
    pub position: [f64; 3],
    /// Turns base axes into inertial axes: scalar, then vector.
    pub attitude: [f64; 4],
    /// The joints and, last, the tool, base axes \[m\].
    pub origins: Vec<[f64; 3]>,
    /// The joints' axes and, last, the tool's third, base axes.
    pub axes: Vec<[f64; 3]>,
    /// The tool's first axis, base axes.
    pub jaw: [f64; 3],
}

impl Frame {
    /// For joint angles \[rad\] and the base's attitude, base axes into inertial axes.
    ///
    /// # Panics
    ///
    /// Panics when there are more or fewer angles than joints.
    pub fn of(robot: &Robot, angles: &[f64], attitude: UnitQuaternion<f64>) -> Self {
        let (mut origins, mut axes) = (Vec::new(), Vec::new());
        let mut moment = Vector3::zeros();
        for link in Outward::new(robot, angles) {
            origins.push(Vector3::from(link.proximal.position).into());
            axes.push(Vector3::from(link.axis).into());
            moment += Vector3::from(link.centre_of_mass) * link.joint.link.mass;
        }
        let tool = tool(robot, angles);
        let [jaw, _, approach] = tool.rotation.0.map(|axis| Vector3::from(axis).into());
        origins.push(Vector3::from(tool.position).into());
        axes.push(approach);
        let [x, y, z, w] = attitude.coords.into();
        let position = attitude * -moment / robot.total_mass();
        Self { position: position.into(), attitude: [w, x, y, z], origins, axes, jaw }
    }
}

impl Scene {
    /// A run's best motion, unless it has none.
    pub fn of(plan: &Plan, run: &Run) -> Option<Self> {
        let instance = &plan.instances[run.instance];
        let problem = instance.reorientation()?;
        let task = problem.task();
        let motion = Motion::sample(problem, &run.coefficients, run.duration, INTERVALS);
        Some(Self {
            label: instance.label.clone(),
            optimiser: plan.optimisers[run.optimiser].label.clone(),
            seed: run.seed,
            cost: run.cost,
            duration: run.duration,
            satellite: Satellite::of(&task.robot),
            frames: frames(&task.robot, &motion),
            joints: joints(problem, &motion),
            goal: Frame::of(&task.robot, &task.goal.joints, task.goal.base),
        })
    }
}

/// The best motions of the first instances that have any.
pub fn scenes(plan: &Plan, runs: &[Run]) -> Vec<Scene> {
    let best = |i| best_run(runs.iter().filter(move |run| run.instance == i));
    let best = (0..plan.instances.len()).filter_map(best);
    best.filter_map(|run| Scene::of(plan, run)).take(MOST_SCENES).collect()
}

fn frames(robot: &Robot, motion: &Motion) -> Vec<Frame> {
    let frame = |(i, attitude): (usize, &UnitQuaternion<f64>)| {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        Frame::of(robot, &angles, *attitude)
    };
    motion.base.iter().enumerate().map(frame).collect()
}

fn joints(problem: &Reorientation, motion: &Motion) -> Vec<JointScene> {
    let task = problem.task();
    let joint = |(i, joint): (usize, &Joint)| JointScene {
        name: joint.name.clone(),
        range: joint.range.map(f64::to_degrees),
        limits: task.limits.0[i].map(f64::to_degrees),
        states: motion.joints[i].derivatives.iter().map(|s| s.map(f64::to_degrees)).collect(),
    };
    task.robot.joints.iter().enumerate().map(joint).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3};

    use super::*;
    use crate::momentum::base_twist;
    use crate::problem::TaskFile;

    fn paper() -> Reorientation {
        let document = TaskFile::paper();
        TaskFile::read(&document).unwrap().build(&document).unwrap().0
    }

    /// The paper's arm with so many joints: some of its own, or some of them again.
    fn arm(count: usize) -> Robot {
        let mut robot = Robot::clone(&paper().task().robot);
        robot.joints = robot.joints.iter().cycle().take(count).cloned().collect();
        robot
    }

    fn motion(intervals: usize) -> (Robot, Motion) {
        let problem = paper();
        let dimension = problem.family().dimension();
        let coefficients: Vec<f64> = (0..dimension).map(|i| (1.7 * i as f64).sin()).collect();
        let motion = Motion::sample(&problem, &coefficients, 8.0, intervals);
        (Robot::clone(&problem.task().robot), motion)
    }

    /// Masses times places, each link's taken on its own from the sweep with the base held still.
    #[test]
    fn the_centre_of_mass_is_the_origin_throughout() {
        let (robot, motion) = motion(INTERVALS);
        for (i, frame) in frames(&robot, &motion).iter().enumerate() {
            let position = Vector3::from(frame.position);
            let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
            let links = Outward::new(&robot, &angles).map(|link| {
                let centre = position + motion.base[i] * Vector3::from(link.centre_of_mass);
                centre * link.joint.link.mass
            });
            let moment = position * robot.base.mass + links.sum::<Vector3<f64>>();
            assert!(moment.norm() < 1e-12, "frame {i}: {moment}");
        }
    }

    /// The base moves as zero momentum has it: its velocity, by differences, is that of `base_twist`.
    #[test]
    fn the_base_drifts_as_the_momentum_says() {
        let (robot, motion) = motion(1200);
        let frames = frames(&robot, &motion);
        let step = motion.time[1];
        let place = |i: usize| Vector3::from(frames[i].position);
        let mut fastest: f64 = 0.0;
        for i in (60..1140).step_by(60) {
            let near = (place(i + 1) - place(i - 1)) / (2.0 * step);
            let far = (place(i + 2) - place(i - 2)) / (4.0 * step);
            let velocity = (near * 4.0 - far) / 3.0;
            let state = |order: usize| -> Vec<f64> {
                motion.joints.iter().map(|j| j.derivatives[i][order]).collect()
            };
            let twist = base_twist(&robot, &state(0), &state(1));
            let expected = motion.base[i] * Vector3::from(twist.linear);
            assert!((velocity - expected).norm() < 1e-8, "{velocity} {expected}");
            fastest = fastest.max(expected.norm());
        }
        assert!(fastest > 1e-3);
    }

    /// The joints of arms with one to nine of them, against products of Denavit–Hartenberg steps.
    #[test]
    fn joints_are_where_the_rows_put_them() {
        for count in 1..10 {
            let robot = arm(count);
            let frame = Frame::of(&robot, &vec![0.0; count], UnitQuaternion::identity());
            let mut pose = Isometry3::from_parts(
                Translation3::from(robot.mount),
                UnitQuaternion::from_rotation_matrix(&robot.mount_rotation),
            );
            for (i, joint) in robot.joints.iter().enumerate() {
                let axis = pose * Vector3::z();
                assert!((Vector3::from(frame.axes[i]) - axis).norm() < 1e-14);
                assert!((Vector3::from(frame.origins[i]) - pose.translation.vector).norm() < 1e-14);
                let [offset, twist] = [joint.dh.offset, joint.dh.twist].map(|(s, c)| s.atan2(c));
                let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * offset)
                    * UnitQuaternion::from_scaled_axis(Vector3::x() * twist);
                pose *= Isometry3::from_parts(Translation3::from(joint.dh.step), turn);
            }
            let tip = Vector3::from(frame.origins[count]);
            assert!((tip - pose.translation.vector).norm() < 1e-14);
            let known = Vector3::from(tool(&robot, &vec![0.0; count]).position);
            assert!((tip - known).norm() < 1e-15);
        }
    }
}
