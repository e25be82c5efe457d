//! Tasks of several motions, and the tool on straight lines.

use std::f64::consts::PI;

use driftless::input::Document;
use driftless::optimiser::Settings;
use driftless::posture::Posture;
use driftless::reorientation::{
    FamilyChoice, FamilyName, LegMotion, PlannedMission, Planner, TaskFile,
};
use driftless::robot::Robot;
use driftless::search::Watch;
use driftless::straight::{Straight, StraightError};
use nalgebra::{UnitQuaternion, Vector3};

/// A robot that comes with the program.
fn shipped(name: &str) -> Robot {
    Robot::from_document(&Robot::embedded(name).unwrap()).unwrap()
}

/// Where the tool is in inertial axes from the system's centre of mass, and where its third axis points, by [`Posture`], which
/// pictures are drawn with.
fn tool(
    robot: &Robot,
    joints: &[f64],
    base: UnitQuaternion<f64>,
) -> (Vector3<f64>, [Vector3<f64>; 2]) {
    let posture = Posture::of(robot, joints, base);
    let place = |local: [f64; 3]| base * Vector3::from(local);
    let position = Vector3::from(posture.position) + place(*posture.origins.last().unwrap());
    (position, [posture.jaw, *posture.axes.last().unwrap()].map(place))
}

fn planned(text: &str) -> PlannedMission {
    let document = Document::embedded("mission.toml", text);
    // Two terms are searched in a moment.
    let choice = FamilyChoice { family: Some(FamilyName::SinePolynomial), ..Default::default() };
    let scp = Settings::by_name("scp").unwrap();
    let planner = Planner::read(&document, choice, scp).unwrap();
    assert!(planner.is_mission());
    planner.plan_mission(1, 100_000, &Watch::default()).unwrap()
}

fn refused(text: &str) -> String {
    let document = Document::embedded("mission.toml", text);
    let table = TaskFile::read(&document).unwrap().task;
    table.mission(&document).unwrap_err().to_string()
}

/// The tool's way, worked out from the joints and from the base that answers them, is the line; the base comes out as planned.
#[test]
fn lines_are_straight_in_inertial_space() {
    for (robot, start) in [
        ("iiwa", [10.0, 30.0, 10.0, -60.0, 5.0, 60.0, 10.0].as_slice()),
        ("ur5e", &[10.0, -60.0, 80.0, -70.0, -60.0, 20.0]),
        ("panda", &[0.0, -30.0, 10.0, -110.0, 5.0, 95.0, 30.0]),
        ("canadarm2", &[10.0, 20.0, -30.0, 80.0, -50.0, 20.0, 15.0]),
    ] {
        let robot = shipped(robot);
        let joints: Vec<f64> = start.iter().map(|angle| angle * PI / 180.0).collect();
        let base = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
        let straight = Straight {
            direction: Vector3::new(0.3, -0.1, -1.0),
            distance: 0.12,
            keeps_orientation: true,
        };
        let path = straight.path(&robot, &joints, base).unwrap();
        let (from, axes) = tool(&robot, &joints, base);
        let along = (axes[0] * 0.3 - axes[1].cross(&axes[0]) * 0.1 - axes[1]).normalize();
        let [_, end] = path.ends();
        let (to, turned) = tool(&robot, end, path.base[1]);
        assert!((to - from - along * 0.12).norm() < 1e-9, "{}: {}", robot.name(), to - from);
        assert!((turned[0] - axes[0]).norm() + (turned[1] - axes[1]).norm() < 1e-9);

        let back = path.reversed();
        assert_eq!(back.ends(), [path.ends()[1], path.ends()[0]]);
        assert_eq!(back.base, [path.base[1], path.base[0]]);
    }
}

#[test]
fn lines_that_joints_cannot_follow_are_refused() {
    let robot = shipped("ur5e");
    let straight = Straight { direction: -Vector3::z(), distance: 5.0, keeps_orientation: true };
    let joints = [0.2, -1.0, 1.4, -1.2, -1.0, 0.3];
    let error = straight.path(&robot, &joints, UnitQuaternion::identity()).unwrap_err();
    assert!(matches!(error, StraightError::Blocked(at) | StraightError::Range(_, at) if at < 5.0));
    let short = Straight { distance: 1e-30, ..straight };
    let error = short.path(&robot, &joints, UnitQuaternion::identity()).unwrap_err();
    assert_eq!(error.to_string(), "found a line of 1e-30 m, expected 1e-6 m or more");
    // A load so heavy that nothing can be computed.
    let heavy = "[task]\nrobot = 'ur5e'\nstart.retreat_m = 0.05\n\
         [task.payload]\nmass = 1e160\ninertia = { xx = 1e160, yy = 1e160, zz = 1e160 }\n";
    let document = Document::embedded("task.toml", heavy);
    let error = TaskFile::read(&document).unwrap().task.mission(&document).unwrap_err();
    assert!(error.to_string().contains("joints cannot move the tool straight on"), "{error}");
}

const MISSION: &str = r#"
[task]
robot = "ur5e"
[task.start]
retreat_m = 0.05
[[task.via]]
tool = { position_m = [0.6, 0.3, 0.7], zyx_deg = [20, 60, 10], approach_m = 0.1, retreat_m = 0.08 }
base_zyx_deg = [1, 2, 3]
[[task.via]]
joints_deg = [30, -70, 80, -80, -60, 20]
[[task.via]]
base_zyx_deg = [2, 2, 2]
[task.goal]
"#;

/// Legs begin where the ones before have ended, at rest, and the tool comes to its place along the line.
#[test]
fn motions_follow_each_other() {
    let found = planned(MISSION);
    let names: Vec<&str> = found.legs.iter().map(|leg| leg.name.as_str()).collect();
    let expected = [
        "retreat from start",
        "via 1",
        "approach of via 1",
        "retreat from via 1",
        "via 2",
        "via 3",
        "goal",
    ];
    assert_eq!(names, expected);
    assert!(found.is_reached());
    let robot = &found.ends.robot;
    let origin = Posture::of(robot, &found.ends.start.joints, found.ends.start.base).position;
    let end = |leg: usize| {
        let motion = found.legs[leg].motion.sample(100);
        let joints = motion.joints.iter().map(|joint| joint.derivatives[100][0]);
        (joints.collect::<Vec<f64>>(), motion.base[100])
    };
    let (joints, base) = end(2);
    let (place, axes) = tool(robot, &joints, base);
    let wanted = Vector3::new(0.6, 0.3, 0.7) + Vector3::from(origin);
    assert!((place - wanted).norm() < 1e-6, "{}", place - wanted);
    let zyx = |[yaw, pitch, roll]: [f64; 3]| {
        let [yaw, pitch, roll] = [yaw, pitch, roll].map(f64::to_radians);
        UnitQuaternion::from_euler_angles(roll, pitch, yaw)
    };
    let turned = zyx([20.0, 60.0, 10.0]);
    assert!((turned * Vector3::x() - axes[0]).norm() < 1e-6);
    let (before, base) = end(1);
    let (place, _) = tool(robot, &before, base);
    assert!((place - wanted + axes[1] * 0.1).norm() < 1e-6);
    for (leg, base) in [(2, [1.0, 2.0, 3.0]), (4, [0.0; 3]), (5, [2.0; 3]), (6, [0.0; 3])] {
        assert!(end(leg).1.angle_to(&zyx(base)) < 2e-5, "{leg}");
    }
    assert!(end(5).0.iter().zip(&end(4).0).all(|(a, b)| (a - b).abs() < 1e-9));

    let whole = found.sample(LegMotion::intervals);
    let last = whole.time.last().unwrap();
    assert!((last - found.duration()).abs() < 1e-9);
    assert!(whole.time.is_sorted_by(|a, b| a < b));
    let counts: usize = found.legs.iter().map(|leg| leg.motion.intervals()).sum();
    assert_eq!(whole.time.len(), counts + 1);
    assert!(whole.base.windows(2).all(|pair| pair[0].angle_to(&pair[1]) < 0.1));
    for joint in &whole.joints {
        let ends = [joint.derivatives.first(), joint.derivatives.last()];
        assert!(ends.iter().all(|at| at.unwrap()[1].abs() < 1e-9));
    }
}

/// What is caught at rest moves the system's centre of mass; inertial axes stay where they are.
#[test]
fn a_target_is_caught_and_brought_to_its_place() {
    let text = r#"
[task]
robot = "ur5e"
[[task.via]]
joints_deg = [20, -80, 80, -80, -60, 20]
capture = { mass = 40, centre_of_mass = [0, 0, 0.2] }
[[task.via]]
tool = { position_m = [0.5, 0.3, 0.8] }
[[task.via]]
tool = { position_m = [0.5, 0.2, 0.8] }
release = true
[task.goal]
base_zyx_deg = [1, 0, 0]
"#;
    let found = planned(text);
    assert!(found.is_reached());
    let tasks: Vec<_> = found.legs.iter().map(|leg| leg.motion.task()).collect();
    let own = found.ends.robot.total_mass();
    let masses: Vec<f64> = tasks.iter().map(|task| task.robot.total_mass() - own).collect();
    assert_eq!(masses, [0.0, 40.0, 40.0, 0.0]);
    // The base's centre of mass, from where it is at the start, moves with each robot as that one's system does.
    let mut position = Vector3::zeros();
    for (leg, wanted) in
        [None, Some([0.5, 0.3, 0.8]), Some([0.5, 0.2, 0.8]), None].iter().enumerate()
    {
        let motion = found.legs[leg].motion.sample(200);
        let joints: Vec<f64> =
            motion.joints.iter().map(|joint| joint.derivatives[200][0]).collect();
        let task = tasks[leg];
        let [from, to] = [
            Posture::of(&task.robot, &task.start.joints, task.start.base),
            Posture::of(&task.robot, &joints, motion.base[200]),
        ];
        position += Vector3::from(to.position) - Vector3::from(from.position);
        if let Some(wanted) = wanted {
            let tool = position + motion.base[200] * Vector3::from(*to.origins.last().unwrap());
            assert!((tool - Vector3::from(*wanted)).norm() < 1e-6, "{leg}: {tool}");
        }
    }
}

/// A load changes what is uncertain, and joints that follow others still do.
#[test]
fn loads_and_uncertainty_go_together() {
    let text = r#"
[task]
robot = "ur5e"
robust = { samples = 2 }
follow = { wrist_3_joint = "wrist_2_joint" }
[[task.via]]
joints_deg = [10, -80, 80, -80, -60]
capture = { mass = 10 }
[task.start]
joints_deg = [0, -90, 90, -90, -90]
base_zyx_deg = [0, 0, 0]
[task.goal]
joints_deg = [20, -80, 80, -80, -60]
base_zyx_deg = [0, 0, 0]
[task.uncertainty]
mass = 0.05
samples = 3
"#;
    let found = planned(text);
    assert_eq!(found.legs.len(), 2);
    let masses =
        |leg: usize| found.legs[leg].motion.task().uncertainty.as_ref().unwrap().masses.len();
    assert_eq!(masses(1), masses(0) + 1);
    for leg in &found.legs {
        let LegMotion::Planned(planned) = &leg.motion else { panic!("{}", leg.name) };
        let robustness = planned.robustness().unwrap();
        assert!(robustness.residuals.iter().all(|residual| residual.is_finite()));
        assert_eq!(leg.motion.task().robot.leading_count(), 5);
    }
}

/// A turn of the base in three equal parts, the joints back at their start after each.
#[test]
fn a_turn_can_be_divided() {
    let text = "[task]\nrobot = \"ur5e\"\ncycles = 3\n[task.start]\nbase_zyx_deg = [9, 0, 0]\n";
    let found = planned(text);
    assert!(found.is_reached());
    assert_eq!(found.legs.len(), 3);
    for (leg, left) in found.legs.iter().zip([6.0, 3.0, 0.0]) {
        let motion = leg.motion.sample(10);
        let (roll, pitch, yaw) = motion.base[10].euler_angles();
        let off = [roll, pitch, yaw - f64::to_radians(left)].map(f64::abs);
        assert!(off.iter().all(|off| *off < 2e-5), "{off:?}");
    }
}

#[test]
fn mistakes_are_told() {
    let expect = |text: &str, expected: &str| {
        let found = refused(&format!("[task]\nrobot = \"ur5e\"\n{text}"));
        assert!(found.contains(expected), "{found}\nexpected: {expected}");
    };
    expect("cycles = 2\n[[task.via]]\nbase_zyx_deg = [1, 2, 3]", "found both `cycles` and `via`");
    let tool = "tool = { position_m = [0.6, 0.2, 0.9]";
    expect(&format!("[task.goal]\n{tool}, retreat_m = 0.1 }}"), "found `retreat_m` at the goal");
    expect("[task.goal]\nretreat_m = 0.1", "which is for the start");
    expect(&format!("[task.goal]\n{tool}, approach_m = 3 }}"), "`approach_m`: ");
    expect(
        "[[task.via]]\ntool = { position_m = [9, 0, 0] }",
        "via 1: the tool cannot be brought there",
    );
    expect(
        &format!("[[task.via]]\n{tool} }}\njoints_deg = [0, 0, 0, 0, 0, 0]"),
        "found both `tool`",
    );
    expect("[[task.via]]\njoints_deg = [0, 0, 0]", "found 3 values, expected 6");
    expect(
        "[[task.via]]\ncapture = { mass = 1 }\nrelease = true",
        "found both `capture` and `release`",
    );

    expect(
        "[[task.via]]\nrelease = true",
        "via 1: found `release`, and the tool has caught nothing",
    );
    let twice = "[[task.via]]\ncapture = { mass = 1 }\n[[task.via]]\ncapture = { mass = 1 }";
    expect(twice, "via 2: the tool carries something already");
    expect("[task.start]\nretreat_m = 9\n[[task.via]]\nbase_zyx_deg = [1, 2, 3]", "`retreat_m`: ");

    let document =
        Document::embedded("mission.toml", "[task]\n[[task.via]]\nbase_zyx_deg = [1, 2, 3]");
    let table = TaskFile::read(&document).unwrap();
    let single = table.problem(&document).unwrap_err().to_string();
    assert!(single.contains("a task of several motions is for `plan` and `replay`"), "{single}");
}
