//! The robots that come with the program against Pinocchio (`reference/robots.json`, made by `reference/make_robots.py`, which reads
//! their files on its own).

use driftless::attitude::increments;
use driftless::input::Document;
use driftless::kinematics::tool;
use driftless::momentum::{Arm, base_twist, generalised_jacobian};
use driftless::robot::{Joint, JointKind, Link, Robot, RobotFile};
use driftless::task::TaskTable;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Reference {
    robots: Vec<Values>,
}

#[derive(Deserialize)]
struct Values {
    name: String,
    joints: Vec<String>,
    states: Vec<State>,
    path: Path,
}

#[derive(Deserialize)]
struct State {
    positions: Vec<f64>,
    rates: Vec<f64>,
    base_twist: [f64; 6],
    tool_position: [f64; 3],
    tool_rotation: [[f64; 3]; 3],
    generalised_jacobian: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct Path {
    from: Vec<f64>,
    to: Vec<f64>,
    attitude: [f64; 4],
}

fn reference() -> Vec<Values> {
    let text = include_str!("reference/robots.json");
    serde_json::from_str::<Reference>(text).unwrap().robots
}

fn shipped(name: &str) -> Robot {
    Robot::from_document(&Robot::embedded(name).unwrap()).unwrap()
}

/// To 1e-11 of the largest of the values, or of one.
fn assert_same(what: &str, ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let scale = theirs.iter().fold(1.0_f64, |most, value| most.max(value.abs()));
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() < 1e-11 * scale, "{what}: {a} and {b}");
    }
}

#[test]
fn all_have_values() {
    let mut known: Vec<String> = reference().into_iter().map(|values| values.name).collect();
    let mut names: Vec<String> = Robot::embedded_names().map(str::to_owned).collect();
    known.sort();
    names.sort();
    assert_eq!(known, names);
}

#[test]
fn kinematics_and_momentum_are_pinocchios() {
    for Values { name, joints, states, .. } in reference() {
        let robot = shipped(&name);
        let names: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
        assert_eq!(names, joints, "{name}");
        let arm = Arm::new(&robot);
        for state in states {
            let State { positions, rates, .. } = &state;
            let twist = base_twist(&robot, positions, rates);
            let (v, w) = (twist.linear, twist.angular);
            assert_same(&name, &[v.x, v.y, v.z, w.x, w.y, w.z], &state.base_twist);
            let rate = arm.base_rate_at(positions, rates);
            assert_same(&name, rate.as_slice(), &state.base_twist[3..]);
            let pose = tool(&robot, positions);
            assert_same(&name, Vector3::from(pose.position).as_slice(), &state.tool_position);
            let columns = pose.rotation.0.map(|axis| -> [f64; 3] { Vector3::from(axis).into() });
            let rotation: Vec<f64> = (0..3).flat_map(|i| columns.map(|axis| axis[i])).collect();
            assert_same(&name, &rotation, state.tool_rotation.as_flattened());
            let jacobian = generalised_jacobian(&robot, positions);
            for (row, theirs) in jacobian.row_iter().zip(&state.generalised_jacobian) {
                let row: Vec<f64> = row.iter().copied().collect();
                assert_same(&name, &row, theirs);
            }
        }
    }
}

/// The base's attitude after a motion from one configuration to another by `10 s³ − 15 s⁴ + 6 s⁵`.
#[test]
fn attitudes_are_pinocchios() {
    for Values { name, path: Path { from, to, attitude }, .. } in reference() {
        let write = |s: f64, positions: &mut [f64], rates: &mut [f64]| {
            let shape = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            let slope = 30.0 * s * s * (1.0 - s).powi(2);
            for i in 0..from.len() {
                positions[i] = from[i] + shape * (to[i] - from[i]);
                rates[i] = slope * (to[i] - from[i]);
            }
        };
        let robot = shipped(&name);
        let steps = increments(&robot, 2000, None, write);
        let end = steps.fold(UnitQuaternion::identity(), |attitude, step| attitude * step);
        let [w, x, y, z] = attitude;
        let theirs = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
        assert!(end.angle_to(&theirs) < 1e-9, "{name}: {:e}", end.angle_to(&theirs));
    }
}

/// As URDF and back, every robot is the same to rounding.
#[test]
fn robots_go_through_urdf() {
    for Values { name, states, .. } in reference() {
        let robot = shipped(&name);
        let urdf = Document::embedded("through.urdf", &robot.to_urdf());
        let file = RobotFile::read(&urdf).unwrap();
        let through = file.build(&urdf).unwrap();
        assert_eq!(through.joint_count(), robot.joint_count());
        for (a, b) in robot.joints().zip(through.joints()) {
            assert_eq!((a.name, a.kind), (b.name, b.kind));
            assert_same(&name, &a.range, &b.range);
            assert_eq!(a.rate.is_some(), b.rate.is_some(), "{name}");
            assert_same(&name, &[a.rate.unwrap_or(0.0)], &[b.rate.unwrap_or(0.0)]);
        }
        // A URDF's base is the root with all that is fixed to it, and base axes begin at the centre of mass of these together.
        let centre = |state: &State| {
            let place = tool(&through, &state.positions).position;
            Vector3::from(state.tool_position) - Vector3::from(place)
        };
        let shift = centre(&states[0]);
        let is_fixed = |link: &Link| link.parent.is_none() && matches!(link.joint, Joint::Fixed);
        let has_fixed = robot.links().iter().any(|link| is_fixed(link) && link.body.mass > 0.0);
        assert_eq!(shift.norm() > 1e-9, has_fixed, "{name}");
        for state in &states {
            assert!((centre(state) - shift).norm() < 1e-11, "{name}");
            let twist = base_twist(&through, &state.positions, &state.rates);
            let theirs = state.base_twist;
            let angular = Vector3::new(theirs[3], theirs[4], theirs[5]);
            let linear = Vector3::new(theirs[0], theirs[1], theirs[2]) + angular.cross(&shift);
            assert_same(&name, Vector3::from(twist.angular).as_slice(), angular.as_slice());
            assert_same(&name, Vector3::from(twist.linear).as_slice(), linear.as_slice());
        }
        // A robot file that was made of it is read to the same bits.
        let again = Document::embedded("again.toml", &toml::to_string(&file).unwrap());
        assert_eq!(Robot::from_document(&again).unwrap(), through, "{name}");
    }
}

/// A task that names a robot and nothing else is that robot's own, value by value as its file has it.
#[test]
fn robots_come_with_tasks() {
    for name in Robot::embedded_names() {
        let document = Document::embedded("task.toml", &format!("robot = '{name}'"));
        let table: TaskTable = document.parse().unwrap();
        let task = table.build(&document).unwrap();
        assert_eq!(task.robot.name(), name);
        assert!(task.already_there().is_none());
        let path = format!("{}/src/task/shipped/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
        let own = &file["task"];
        let numbers = |value: &toml::Value| -> Vec<f64> {
            let number = |value: &toml::Value| {
                value.as_float().or(value.as_integer().map(|whole| whole as f64)).unwrap()
            };
            match value.as_array() {
                Some(list) => list.iter().map(number).collect(),
                None => vec![number(value); task.robot.joint_count()],
            }
        };
        let degrees = |values: &[f64]| values.iter().map(|v| v.to_degrees()).collect::<Vec<_>>();
        for (posture, key) in [(&task.start, "start"), (&task.goal, "goal")] {
            assert_same(name, &degrees(&posture.joints), &numbers(&own[key]["joints_deg"]));
            let [yaw, pitch, roll] = numbers(&own[key]["base_zyx_deg"])[..] else {
                panic!("{name}")
            };
            let base = UnitQuaternion::from_euler_angles(
                roll.to_radians(),
                pitch.to_radians(),
                yaw.to_radians(),
            );
            assert!(posture.base.angle_to(&base) < 1e-7, "{name}");
        }
        for (order, key) in ["rate_deg_s", "acceleration_deg_s2", "jerk_deg_s3"].iter().enumerate()
        {
            let limits: Vec<f64> = task.limits.0.iter().map(|limits| limits[order]).collect();
            assert_same(name, &degrees(&limits), &numbers(&own["limits"][key]));
        }
        for (joint, limits) in task.robot.joints().zip(&task.limits.0) {
            // No task asks for more than the maker allows.
            assert_eq!(joint.kind, JointKind::Revolute);
            assert!(joint.rate.is_none_or(|rate| limits[0] <= rate * (1.0 + 1e-9)), "{name}");
        }
    }
}
