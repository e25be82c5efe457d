//! What is said of goals that a motion misses.

use std::sync::Arc;

use driftless::input::Document;
use driftless::reorientation::{Accuracy, Block, Reach, Reorientation, TaskFile};
use driftless::robot::Robot;
use driftless::task::Task;
use nalgebra::UnitQuaternion;

/// A link of half a metre, its joint parallel to the next.
const JOINT: &str = "[[joint]]\ndh = { d = 0, a = 0.5, alpha_deg = 0 }\nrange_deg = [-180, 180]\nmass = 5\n\
    centre_of_mass = [-0.25, 0, 0]\ninertia = { xx = 0.1, yy = 0.2, zz = 0.2 }\n";

/// The paper's start and goal for the first joints of an arm whose axes are all parallel to the base's z axis, on a base
/// of so many times the inertia, which ends turned by yaw, pitch and roll \[rad\].
fn planar(joints: usize, times: f64, [yaw, pitch, roll]: [f64; 3]) -> Task {
    let base = format!(
        "name = 'planar'\n[base]\nmass = {}\nmount = [0.5, 0, 0]\ninertia = {{ xx = {i}, yy = {i}, zz = {i} }}\n",
        100.0 * times,
        i = 10.0 * times,
    );
    let text = base + &JOINT.repeat(joints);
    let robot = Robot::from_document(&Document::embedded("planar", &text)).unwrap();
    let document = TaskFile::paper();
    let (paper, _) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    let mut task = (**paper.task()).clone();
    task.robot = Arc::new(robot);
    task.limits.0.truncate(joints);
    task.start.joints.truncate(joints);
    task.goal.joints.truncate(joints);
    task.start.base = UnitQuaternion::identity();
    task.goal.base = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    task
}

/// The longest motion that was looked for \[s\].
const LONGEST: f64 = 30.0;

/// What is said of the straight motion, and how long that takes \[s\].
fn of_straight(task: &Task) -> (Reach, f64) {
    let problem = Reorientation::new(Arc::new(task.clone()), 2, Accuracy::FINE);
    let coefficients = vec![0.0; 2 * task.robot.joint_count()];
    let motion = problem.assess(&coefficients, None);
    (Reach::of(task, &motion, LONGEST), motion.duration)
}

#[test]
fn a_planar_arm_turns_the_base_about_one_axis() {
    assert_eq!(of_straight(&planar(3, 1.0, [0.3, 0.0, 0.0])).0, Reach::NotFound);
    assert_eq!(of_straight(&planar(3, 1.0, [0.3, 0.1, 0.0])).0, Reach::Blocked(Block::OneAxis));
    assert_eq!(of_straight(&planar(3, 1.0, [0.0, 0.0, 1e-3])).0, Reach::Blocked(Block::OneAxis));
    assert_eq!(of_straight(&planar(1, 1.0, [0.3, 0.0, 0.0])).0, Reach::Blocked(Block::Holonomic));
}

/// The same without a turn of the base, for these joints on a base whose arm is mounted at its centre of mass.
fn with_joints(joints: &[&str]) -> Task {
    let text = "name = 'own'\n[base]\nmass = 100\nmount = [0, 0, 0]\ninertia = { xx = 10, yy = 10, zz = 10 }\n".to_owned()
        + &joints.concat();
    let mut task = planar(joints.len(), 1.0, [0.0, 0.0, 0.0]);
    task.robot = Arc::new(Robot::from_document(&Document::embedded("own", &text)).unwrap());
    task
}

/// A wheel about its axis, through its centre of mass, and how the next joint's axis is turned against it.
fn wheel(alpha_deg: f64) -> String {
    format!(
        "[[joint]]\ndh = {{ d = 0, a = 0, alpha_deg = {alpha_deg} }}\nrange_deg = [-180, 180]\nmass = 5\n\
         centre_of_mass = [0, 0, 0]\ninertia = {{ xx = 0.1, yy = 0.1, zz = 0.1 }}\n"
    )
}

/// Two wheels on one axis through the base's centre of mass turn it by fixed shares of their own turns, whatever their paths;
/// three on different axes do not.
#[test]
fn wheels_on_one_axis_are_holonomic() {
    let [same, across] = [wheel(0.0), wheel(90.0)];
    let turned = |mut task: Task| {
        task.goal.base = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3);
        of_straight(&task).0
    };
    assert_eq!(turned(with_joints(&[&same, &same])), Reach::Blocked(Block::Holonomic));
    assert_eq!(turned(with_joints(&[&across, &across, &same])), Reach::NotFound);
}

/// Whether a joint turns the base about another axis does not depend on how fast it may move.
#[test]
fn slow_joints_count() {
    let turned = JOINT.replace("alpha_deg = 0", "alpha_deg = 90");
    let mut task = with_joints(&[JOINT, &turned, &wheel(0.0)]);
    task.goal.base = UnitQuaternion::from_euler_angles(0.1, 0.0, 0.0);
    for times in [1.0, 1e-3, 1e-6] {
        let mut slow = task.clone();
        slow.limits.0[2] = slow.limits.0[2].map(|limit| times * limit);
        assert_eq!(of_straight(&slow).0, Reach::NotFound, "{times}");
    }
}

/// A tolerance as wide as the error takes the goal as reached, and one that takes in the tilt leaves the turn to be found.
#[test]
fn tolerances_widen_the_goal() {
    let wide = |task: Task, goal_tolerance: f64| of_straight(&Task { goal_tolerance, ..task }).0;
    assert_eq!(wide(planar(3, 1.0, [0.3, 0.1, 0.0]), 3.0), Reach::Reached);
    assert_eq!(wide(planar(3, 1.0, [0.9, 1e-3, 0.0]), 2e-3), Reach::NotFound);
}

/// A motion in half the time that its limits allow does not count, wherever it ends.
#[test]
fn limits_are_kept_where_a_goal_is_reached() {
    let task = Task { goal_tolerance: 3.0, ..planar(3, 1.0, [0.3, 0.0, 0.0]) };
    let problem = Reorientation::new(Arc::new(task.clone()), 2, Accuracy::FINE);
    let [shortest, half] = [1.0, 0.5].map(|share| {
        let free = problem.assess(&[0.0; 6], None);
        let motion = problem.assess(&[0.0; 6], Some(share * free.duration));
        Reach::of(&task, &motion, LONGEST)
    });
    assert_eq!((shortest, half), (Reach::Reached, Reach::NotFound));
}

/// A base of a million times the inertia turns a million times as slowly. Momentum bounds the rate: all links lie within
/// 2 m of the base's centre of mass, so they have about it an inertia of at most 15 kg (2 m)² + 0.6 kg m², and turn by 180°/s
/// at most, 60°/s from each joint.
#[test]
fn a_heavy_base_takes_long() {
    let task = planar(3, 1e6, [0.3, 0.0, 0.0]);
    let (reach, duration) = of_straight(&task);
    assert!(duration < LONGEST, "{duration} s");
    let Reach::TooSlow(least) = reach else { panic!("{reach:?} after {duration} s") };
    let momentum = (15.0 * 2.0 * 2.0 + 0.6) * f64::to_radians(180.0);
    assert!(least > 0.3 / (momentum / 1e7), "{least} s");
    let (Reach::TooSlow(twice), _) = of_straight(&planar(3, 2e6, [0.3, 0.0, 0.0])) else {
        panic!("a heavier base turns more slowly")
    };
    assert_eq!(of_straight(&planar(3, 1.0, [3.0, 0.0, 0.0])).0, Reach::NotFound);
    assert!((twice / least - 2.0).abs() < 1e-4, "{twice} s and {least} s");
}
