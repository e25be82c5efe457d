//! Goals of the tool: joints that bring it there, whatever the robot.

use driftless::input::Document;
use driftless::inverse_kinematics::{Orientation, Origin, ToolTarget, miss, solve};
use driftless::optimiser::{Scp, Settings};
use driftless::posture::Posture;
use driftless::reorientation::{FamilyChoice, Planner, Reach, TaskFile};
use driftless::robot::Robot;
use driftless::search::Watch;
use driftless::task::Task;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Numbers from a Weyl sequence, in `[0, 1)`.
struct Draws(f64);
impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = (self.0 + 0.618_033_988_749_894_9).fract();
        self.0
    }

    fn configuration(&mut self, robot: &Robot) -> Vec<f64> {
        let ranges: Vec<[f64; 2]> = robot.joints().map(|joint| joint.range).collect();
        ranges.iter().map(|[lower, upper]| lower + (upper - lower) * self.next()).collect()
    }
}

/// A robot that comes with the program.
fn shipped(name: &str) -> Robot {
    Robot::from_document(&Robot::embedded(name).unwrap()).unwrap()
}

/// Where the tool is in inertial axes from the system's centre of mass, and how it is turned, by [`Posture`], which pictures are
/// drawn with.
fn tool(
    robot: &Robot,
    joints: &[f64],
    base: UnitQuaternion<f64>,
) -> (Vector3<f64>, Rotation3<f64>) {
    let posture = Posture::of(robot, joints, base);
    let place = |local: [f64; 3]| base * Vector3::from(local);
    let [jaw, approach] = [posture.jaw, *posture.axes.last().unwrap()].map(place);
    let turned = Matrix3::from_columns(&[jaw, approach.cross(&jaw), approach]);
    let position = Vector3::from(posture.position) + place(*posture.origins.last().unwrap());
    (position, Rotation3::from_matrix_unchecked(turned))
}

fn task(text: &str) -> Result<Task, String> {
    let document = Document::embedded("task.toml", text);
    let file = TaskFile::read(&document).map_err(|error| format!("{error:?}"))?;
    file.problem(&document).map(|p| (**p.task()).clone()).map_err(|error| format!("{error}"))
}

/// Every goal comes from a configuration within the ranges, so all can be reached.
#[test]
fn reachable_goals_are_reached() {
    let mut draws = Draws(0.1);
    for name in Robot::embedded_names() {
        let robot = shipped(name);
        let efforts = vec![1.0; robot.joint_count()];
        for trial in 0..30 {
            let near = draws.configuration(&robot);
            let (position, turned) =
                tool(&robot, &draws.configuration(&robot), UnitQuaternion::identity());
            let origin = if trial % 2 == 0 { Origin::System } else { Origin::Base };
            let orientation = match trial % 3 {
                0 => Orientation::Full(turned),
                1 => Orientation::Any,
                _ => Orientation::Axis {
                    tool: Vector3::y_axis(),
                    direction: turned * Vector3::y_axis(),
                },
            };
            // From the base's centre of mass the same place is within reach only where that is where the system's is.
            let position = (origin == Origin::System).then_some(position);
            let target = ToolTarget { position, origin, orientation };
            let solutions = solve(&robot, &target, &near, &efforts);
            let solutions = solutions.unwrap_or_else(|miss| panic!("{name} {trial}: {miss:?}"));
            for joints in &solutions {
                let off = miss(&robot, &target, joints);
                assert!(off.position < 1e-9 && off.angle < 1e-9, "{name} {trial}: {off:?}");
                let own = robot.joints().zip(joints);
                let mut ranges =
                    own.map(|(joint, at)| (joint.range[0]..=joint.range[1]).contains(at));
                assert!(ranges.all(|is_within| is_within), "{name} {trial}");
            }
            let way = |joints: &Vec<f64>| {
                joints.iter().zip(&near).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
            };
            assert!(solutions.is_sorted_by(|a, b| way(a) <= way(b)), "{name} {trial}");
        }
    }
}

const START: &str = "base_zyx_deg = [4, -6, 3]";

/// In inertial axes, from where the base is at the start, and in base axes.
#[test]
fn tasks_end_with_the_tool_where_it_is_to_be() {
    for robot in ["xiao2023", "panda", "ur5e", "canadarm2"] {
        let own = task(&format!("[task]\nrobot = \"{robot}\"")).unwrap();
        let (origin, base) = (own.start.base, own.goal.base);
        let start = Vector3::from(Posture::of(&own.robot, &own.start.joints, origin).position);
        let (position, turned) = tool(&own.robot, &own.goal.joints, base);
        let (roll, pitch, yaw) = turned.euler_angles();
        let zyx = [yaw, pitch, roll].map(f64::to_degrees);
        let place = <[f64; 3]>::from(position - start);
        let keys = format!("tool = {{ position_m = {place:?}, zyx_deg = {zyx:?} }}");
        let found = task(&format!("[task]\nrobot = \"{robot}\"\n[task.goal]\n{keys}")).unwrap();
        let goal = found.tool.as_ref().unwrap();
        assert_eq!(goal.branches[0], found.goal.joints);
        for joints in &goal.branches {
            let (there, as_turned) = tool(&found.robot, joints, base);
            assert!((there - position).norm() < 1e-9, "{robot}: {there} {position}");
            assert!((as_turned.matrix() - turned.matrix()).norm() < 1e-8, "{robot}");
        }
        // The configuration that the goal was made from is among them where it is the only one far and wide: seven joints have a
        // continuum, and that of the paper's task is next to a singular one, where two solutions meet.
        if robot == "ur5e" {
            let is_own = |joints: &Vec<f64>| {
                joints.iter().zip(&own.goal.joints).all(|(a, b)| (a - b).abs() < 1e-6)
            };
            assert!(goal.branches.iter().any(is_own), "{robot}: {:?}", goal.branches);
        }

        let in_base = base.inverse()
            * (position - Vector3::from(Posture::of(&own.robot, &own.goal.joints, base).position));
        let place = <[f64; 3]>::from(in_base);
        let keys = format!("tool = {{ frame = \"base\", position_m = {place:?} }}\n{START}");
        let found = task(&format!("[task]\nrobot = \"{robot}\"\n[task.goal]\n{keys}")).unwrap();
        let posture = Posture::of(&found.robot, &found.goal.joints, found.goal.base);
        let there = Vector3::from(*posture.origins.last().unwrap());
        assert!((there - in_base).norm() < 1e-9, "{robot}");
    }
}

#[test]
fn an_axis_alone_can_be_a_goal() {
    let keys = "tool = { axis = [0, 0, -2], tool_axis = [1, 0, 0] }";
    let found = task(&format!("[task]\nrobot = \"ur5e\"\n[task.goal]\n{keys}\n{START}")).unwrap();
    let (_, turned) = tool(&found.robot, &found.goal.joints, found.goal.base);
    assert!((turned * Vector3::x() + Vector3::z()).norm() < 1e-9);
}

#[test]
fn mistakes_are_told() {
    let told = |start: &str, goal: &str| {
        let text =
            format!("[task]\nrobot = \"ur5e\"\n[task.start]\n{start}\n[task.goal]\n{goal}\n");
        task(&text).unwrap_err()
    };
    let of = |tool: &str| told("", &format!("tool = {{ {tool} }}"));
    let expect = |found: String, expected: &str| {
        assert!(found.contains(expected), "{found}\nexpected: {expected}");
    };
    expect(of(""), "found neither `position_m` nor `zyx_deg` nor `axis`");
    expect(of("axis = [0, 0, 0]"), "`axis` is zero");
    expect(of("tool_axis = [0, 0, 1], position_m = [1, 0, 0]"), "found `tool_axis` without `axis`");
    expect(of("axis = [0, 0, 1], zyx_deg = [0, 0, 0]"), "found both `zyx_deg` and `axis`");
    expect(of("position_m = [9, 0, 0]"), "the tool cannot be brought there");
    expect(
        of("position_m = [0.6, 0.1, 0.9], branch = 900"),
        "found `branch = 900`, expected one of 1 to",
    );
    expect(of("position_m = [0.6, 0.1, 0.9], branch = 0"), "expected");
    expect(told("tool = { position_m = [1, 0, 0] }", ""), "which is for goals alone");
    let both = "joints_deg = [0, 0, 0, 0, 0, 0]\ntool = { position_m = [1, 0, 0] }";
    expect(told("", both), "found both `tool` and the joints' positions");
}

/// No farther than the lengths of all links is reached, and by how much a goal is missed is told: by no more than of random
/// configurations.
#[test]
fn goals_out_of_reach_are_told_with_the_distance() {
    let robot = shipped("ur5e");
    let position = Some(Vector3::new(5.0, 0.0, 0.0));
    let target = ToolTarget { position, origin: Origin::Base, orientation: Orientation::Any };
    let off = solve(&robot, &target, &[0.3; 6], &[1.0; 6]).unwrap_err();
    let mut draws = Draws(0.5);
    let nearest = (0..20_000).map(|_| miss(&robot, &target, &draws.configuration(&robot)).position);
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    let lengths: f64 = robot.links().iter().map(|link| link.placement.translation().norm()).sum();
    assert!(off.position <= nearest && off.position >= 5.0 - lengths, "{} {nearest}", off.position);
}

/// Where the tool is at the end of the motion, and when, by [`Posture`]: there the target has come meanwhile.
#[test]
fn goals_that_move_are_met() {
    let keys = "position_m = [0.5, 0.3, 0.8], zyx_deg = [20, 60, 10], velocity_m_s = [0.01, -0.02, 0.015], \
                angular_velocity_deg_s = [0, 1, -2]";
    let text = |limits: &str| {
        format!(
            "[task]\nrobot = 'ur5e'\ngoal.tool = {{ {keys} }}\n{limits}[trajectory]\nfamily = 'spline'\npieces = 12\n"
        )
    };
    let plan = |limits: &str| {
        let document = Document::embedded("task.toml", &text(limits));
        let settings = Settings::Scp(Scp::default());
        let planner = Planner::read(&document, FamilyChoice::default(), settings).unwrap();
        planner.plan(1, 20_000, &Watch::default()).unwrap()
    };
    for (limits, stated) in [("", None), ("limits.least_duration_s = 25\n", Some(25.0))] {
        let found = plan(limits);
        assert_eq!(found.reach, Reach::Reached, "{limits}");
        let t_f = found.assessment.duration;
        assert!(stated.is_none_or(|stated| t_f == stated), "{t_f}");
        let task = found.problem.task();
        let motion = found.problem.sample(&found.coefficients, t_f, 50);
        let joints: Vec<f64> =
            motion.joints.iter().map(|joint| joint.derivatives.last().unwrap()[0]).collect();
        let (position, turned) = tool(&task.robot, &joints, *motion.base.last().unwrap());
        // Inertial axes begin at the base's centre of mass at the start.
        let origin: Vector3<f64> =
            Posture::of(&task.robot, &task.start.joints, task.start.base).position.into();
        let expected = Vector3::new(0.5 + 0.01 * t_f, 0.3 - 0.02 * t_f, 0.8 + 0.015 * t_f);
        let miss = (position - origin - expected).norm();
        assert!(miss < 1e-6, "{limits}: {miss:e}");
        let about = Vector3::new(0.0, t_f, -2.0 * t_f).map(f64::to_radians);
        let zyx = [20.0_f64, 60.0, 10.0].map(f64::to_radians);
        let start = Rotation3::from_euler_angles(zyx[2], zyx[1], zyx[0]);
        let off = (Rotation3::from_scaled_axis(about) * start).angle_to(&turned);
        assert!(off.to_degrees() < 1e-4, "{limits}: {off:e}");
    }
    for (text, expected) in [
        (text(""), "least_duration_s"),
        ("[task]\ngoal.tool = { position_m = [1, 0, 2], velocity_m_s = [0, 0, 0.1], frame = 'base' }\n\
          limits.least_duration_s = 9\n".to_owned(), "in inertial axes"),
    ] {
        let error = task(&text).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
    let via = "[[task.via]]\ntool = { position_m = [0.6, 0.2, 0.9], velocity_m_s = [0, 0, 0.1] }\n";
    let document = Document::embedded("task.toml", &format!("[task]\nrobot = 'ur5e'\n{via}"));
    let settings = Settings::Scp(Scp::default());
    let error = Planner::read(&document, FamilyChoice::default(), settings).unwrap_err();
    assert!(error.to_string().contains("task of one motion"), "{error}");
}
