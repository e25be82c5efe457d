//! Where a floating robot is: no force acts from outside, so its centre of mass stays.

use driftless::kinematics::{Outward, tool};
use driftless::momentum::base_twist;
use driftless::posture::Posture;
use driftless::reorientation::{Motion, Reorientation, TaskFile};
use driftless::robot::{Placement, Robot, Tool};
use nalgebra::{Translation3, UnitQuaternion, Vector3};

fn paper() -> Reorientation {
    let document = TaskFile::paper();
    TaskFile::read(&document).unwrap().build(&document).unwrap().0
}

/// The paper's arm with so many joints: some of its own, or some of them again.
fn arm(count: usize) -> Robot {
    let robot = Robot::clone(&paper().task().robot);
    // Where each row of the table leads: to the next link, or to the tool.
    let steps: Vec<&Placement> = robot.links()[1..]
        .iter()
        .map(|link| &link.placement)
        .chain([&robot.tool().placement])
        .collect();
    let row = |i: usize| steps[i % steps.len()].clone();
    let links = (0..count).map(|i| {
        let mut link = robot.links()[i % steps.len()].clone();
        link.parent = i.checked_sub(1);
        link.placement = link.parent.map_or_else(|| robot.mount().clone(), row);
        link
    });
    let tool = Tool { link: Some(count - 1), placement: row(count - 1) };
    Robot::new("arm".to_owned(), robot.base().clone(), links.collect(), tool).unwrap()
}

fn motion(intervals: usize) -> (Robot, Motion) {
    let problem = paper();
    let dimension = problem.family().dimension();
    let coefficients: Vec<f64> = (0..dimension).map(|i| (1.7 * i as f64).sin()).collect();
    let motion = Motion::sample(&problem, &coefficients, 8.0, intervals);
    (Robot::clone(&problem.task().robot), motion)
}

fn postures(robot: &Robot, motion: &Motion) -> Vec<Posture> {
    let posture = |(i, attitude): (usize, &UnitQuaternion<f64>)| {
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        Posture::of(robot, &angles, *attitude)
    };
    motion.base.iter().enumerate().map(posture).collect()
}

/// Masses times places, each link's taken on its own from the sweep with the base held still.
#[test]
fn the_centre_of_mass_is_the_origin_throughout() {
    let (robot, motion) = motion(120);
    for (i, posture) in postures(&robot, &motion).iter().enumerate() {
        let position = Vector3::from(posture.position);
        let angles: Vec<f64> = motion.joints.iter().map(|j| j.derivatives[i][0]).collect();
        let links = Outward::<_>::new(&robot, &angles).map(|link| {
            let centre = position + motion.base[i] * Vector3::from(link.centre_of_mass);
            centre * link.link.body.mass
        });
        let moment = position * robot.base().mass + links.sum::<Vector3<f64>>();
        assert!(moment.norm() < 1e-12, "posture {i}: {moment}");
    }
}

/// The base moves as zero momentum has it: its velocity, by differences, is that of `base_twist`.
#[test]
fn the_base_drifts_as_the_momentum_says() {
    let (robot, motion) = motion(1200);
    let postures = postures(&robot, &motion);
    let step = motion.time[1];
    let place = |i: usize| Vector3::from(postures[i].position);
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
        let posture = Posture::of(&robot, &vec![0.0; count], UnitQuaternion::identity());
        let mut pose = robot.mount().isometry();
        // The table of `robot/shipped/xiao2023.toml`.
        let rows = [
            [0.0, 0.115, 0.0, 90.0],
            [90.0, -0.115, 0.0, 90.0],
            [0.0, 0.775, 0.0, -90.0],
            [-90.0, 0.24, 0.875, 0.0],
            [0.0, -0.115, 0.0, 90.0],
            [0.0, 0.115, 0.0, 0.0],
        ];
        for i in 0..count {
            let axis = pose * Vector3::z();
            assert!((Vector3::from(posture.axes[i]) - axis).norm() < 1e-14);
            assert!((Vector3::from(posture.origins[i]) - pose.translation.vector).norm() < 1e-14);
            let [offset, d, a, twist] = rows[i % rows.len()];
            let about = |axis: Vector3<f64>, degrees: f64| {
                UnitQuaternion::from_scaled_axis(axis * degrees.to_radians())
            };
            pose *= about(Vector3::z(), offset);
            pose *= Translation3::new(a, 0.0, d);
            pose *= about(Vector3::x(), twist);
        }
        let tip = Vector3::from(posture.origins[count]);
        assert!((tip - pose.translation.vector).norm() < 1e-14);
        let known = Vector3::from(tool(&robot, &vec![0.0; count]).position);
        assert!((tip - known).norm() < 1e-15);
    }
}
