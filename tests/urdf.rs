//! URDF files as people write them, good and bad.

use std::fmt::Write as _;

use driftless::input::{Document, InputError};
use driftless::kinematics::tool;
use driftless::momentum::base_twist;
use driftless::robot::{JointKind, Robot, RobotFile};
use driftless::task::{Task, TaskTable};
use nalgebra::Vector3;

const BODY: &str = "<inertial><origin xyz='0 0 0.1'/><mass value='2'/><inertia ixx='0.1' iyy='0.1' izz='0.05' ixy='0' ixz='0' \
                    iyz='0'/></inertial>";
const BASE: &str = "<inertial><mass value='100'/><inertia ixx='10' iyy='10' izz='10'/></inertial>";

/// A satellite with an arm of two joints, one that turns and one that slides.
fn satellite() -> String {
    format!(
        "<?xml version='1.0'?>
<!-- a comment -->
<robot name='satellite'>
  <material name='grey'/>
  <link name='body'>{BASE}<visual><geometry><mesh filename='package://nowhere.dae'/></geometry></visual></link>
  <link name='upper'>{BODY}</link>
  <link name='slider'>{BODY}</link>
  <link name='hand'/>
  <joint name='shoulder' type='revolute'>
    <parent link='body'/><child link='upper'/>
    <origin xyz='0.5 0 0' rpy='0 1.5707963267948966 0'/>
    <axis xyz='0 0 2'/>
    <limit lower='-1' upper='2' velocity='0.5' effort='10'/>
  </joint>
  <joint name='slide' type='prismatic'>
    <parent link='upper'/><child link='slider'/>
    <origin xyz='0 0 0.5'/>
    <axis xyz='0 0 1'/>
    <limit lower='0' upper='0.4' velocity='0.1' effort='5'/>
  </joint>
  <joint name='grip' type='fixed'>
    <parent link='slider'/><child link='hand'/>
    <origin xyz='0 0 0.2'/>
  </joint>
  <transmission name='t'/>
</robot>
"
    )
}

fn read(text: &str) -> Result<Robot, InputError> {
    Robot::from_document(&Document::embedded("robot.urdf", text))
}

#[test]
fn a_satellite_is_read() {
    let robot = read(&satellite()).unwrap();
    assert_eq!(robot.name(), "satellite");
    assert_eq!((robot.base().mass, robot.total_mass()), (100.0, 104.0));
    let joints: Vec<_> = robot.joints().collect();
    assert_eq!(joints.iter().map(|joint| joint.name).collect::<Vec<_>>(), ["shoulder", "slide"]);
    assert_eq!(joints[0].kind, JointKind::Revolute);
    assert_eq!((joints[1].kind, joints[1].range), (JointKind::Prismatic, [0.0, 0.4]));
    assert!((joints[0].rate.unwrap() - 0.5).abs() < 1e-15);
    assert!((joints[0].range[1] - 2.0).abs() < 1e-15);
    // A quarter turn about y brings the arm's z to the base's x.
    let hand = tool(&robot, &[0.0, 0.3]);
    assert!((Vector3::from(hand.position) - Vector3::new(1.5, 0.0, 0.0)).norm() < 1e-12);
}

/// Axes of any length, elements of extensions in other namespaces, and deep ones that nobody reads.
#[test]
fn what_is_odd_but_right_is_read() {
    let robot = read(&satellite()).unwrap();
    let long = satellite().replace("<axis xyz='0 0 2'/>", "<axis xyz='0 0 1e200'/>");
    assert_eq!(read(&long).unwrap(), robot);
    let extension = "<d:link xmlns:d='urn:d' name='ghost'><d:inertial/></d:link></robot>";
    assert_eq!(read(&satellite().replace("</robot>", extension)).unwrap(), robot);
    let origin = "<d:origin xmlns:d='urn:d' xyz='9 9 9'/><axis xyz='0 0 2'/>";
    assert_eq!(read(&satellite().replace("<axis xyz='0 0 2'/>", origin)).unwrap(), robot);
    let deep = format!("<gazebo>{}{}</gazebo></robot>", "<x>".repeat(150), "</x>".repeat(150));
    assert_eq!(read(&satellite().replace("</robot>", &deep)).unwrap(), robot);
    let spaced = satellite().replace("<robot ", "<robot xmlns='http://www.ros.org' ");
    assert_eq!(read(&spaced).unwrap(), robot);
}

/// The base moves so that the centre of mass stays: `104 v = −2 · 0.1` along x for a slide of 0.1 m/s of 2 kg.
#[test]
fn a_slide_pushes_the_base_back() {
    let twist = base_twist(&read(&satellite()).unwrap(), &[0.0, 0.2], &[0.0, 0.1]);
    assert!((twist.linear.x + 0.2 / 104.0).abs() < 1e-15, "{twist:?}");
    assert!(Vector3::from(twist.angular).norm() < 1e-15);
}

/// A root whose centre of mass is elsewhere: base axes begin there.
#[test]
fn base_axes_begin_at_the_centre_of_mass() {
    let text =
        satellite().replace("<mass value='100'/>", "<origin xyz='0.2 0.1 0'/><mass value='100'/>");
    let hand = tool(&read(&text).unwrap(), &[0.0, 0.3]);
    assert!((Vector3::from(hand.position) - Vector3::new(1.3, -0.1, 0.0)).norm() < 1e-12);
}

/// What is fixed to the root is part of the base: 100 kg at the origin and 2 kg at 0.9 m below have their centre at −0.9·2/102.
#[test]
fn fixed_links_are_part_of_the_base() {
    let panel = format!(
        "<link name='panel'>{BODY}</link><joint name='p' type='fixed'><parent link='body'/><child link='panel'/><origin xyz='0 0 -1'/></joint></robot>"
    );
    let robot = read(&satellite().replace("</robot>", &panel)).unwrap();
    assert_eq!(robot.base().mass, 102.0);
    let centre = -0.9 * 2.0 / 102.0;
    let hand = tool(&robot, &[0.0, 0.3]);
    assert!((Vector3::from(hand.position) - Vector3::new(1.5, 0.0, -centre)).norm() < 1e-12);
    // Steiner: both bodies about the common centre.
    let expected = 10.0 + 100.0 * centre.powi(2) + 0.1 + 2.0 * (0.9 + centre).powi(2);
    assert!((robot.base().inertia[(0, 0)] - expected).abs() < 1e-12);
}

/// A world without mass in which the satellite floats is left out.
#[test]
fn a_floating_joint_of_the_root_is_the_free_base() {
    let world = "<link name='world'/><joint name='free' type='floating'><parent link='world'/><child link='body'/></joint></robot>";
    let robot = read(&satellite().replace("</robot>", world)).unwrap();
    assert_eq!(robot, read(&satellite()).unwrap());
}

#[test]
fn continuous_joints_have_a_turn_either_way() {
    let text = satellite().replace("type='revolute'", "type='continuous'");
    let robot = read(&text).unwrap();
    let range = robot.joints().next().unwrap().range;
    assert_eq!(range, [-std::f64::consts::TAU, std::f64::consts::TAU]);
}

fn arm() -> String {
    satellite().replace(BASE, "")
}

fn task(folder: &tempfile::TempDir, robot: &str, task: &str) -> Result<Task, InputError> {
    std::fs::write(folder.path().join("robot.urdf"), robot).unwrap();
    let path = folder.path().join("task.toml");
    std::fs::write(&path, task).unwrap();
    let document = Document::read(&path)?;
    document.parse::<TaskTable>()?.build(&document)
}

const REST: &str = "
start = { joints = [10, 0.1], base_zyx_deg = [1, 0, 0] }
goal = { joints = { slide = 0.3, shoulder = 20 }, base_zyx_deg = [0, 0, 0] }
limits = { acceleration = [70, 0.2], jerk = [80, 0.3] }
";

#[test]
fn tasks_state_degrees_and_metres() {
    let folder = tempfile::tempdir().unwrap();
    let task = task(&folder, &satellite(), &format!("robot = 'robot.urdf'{REST}")).unwrap();
    assert_eq!(task.start.joints, [10.0_f64.to_radians(), 0.1]);
    assert_eq!(task.goal.joints, [20.0_f64.to_radians(), 0.3]);
    // Rates are the file's own.
    assert!((task.limits.0[0][0] - 0.5).abs() < 1e-15);
    assert_eq!(task.limits.0[1], [0.1, 0.2, 0.3]);
}

#[test]
fn a_base_is_put_under_an_arm() {
    let folder = tempfile::tempdir().unwrap();
    let base =
        "base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 }, mount = [0.1, 0.2, 0.3] }";
    let text = format!("robot = 'robot.urdf'\n{base}{REST}");
    let task = task(&folder, &arm(), &text).unwrap();
    assert_eq!((task.robot.base().mass, task.robot.total_mass()), (300.0, 304.0));
    let hand = tool(&task.robot, &[0.0, 0.3]);
    assert!((Vector3::from(hand.position) - Vector3::new(1.6, 0.2, 0.3)).norm() < 1e-12);
}

#[test]
fn joints_are_locked_where_a_task_says() {
    let folder = tempfile::tempdir().unwrap();
    let text = |locked: &str| {
        format!(
            "robot = 'robot.urdf'\nlocked = {locked}
start = {{ joints_deg = [10], base_zyx_deg = [1, 0, 0] }}
goal = {{ joints_deg = [20], base_zyx_deg = [0, 0, 0] }}
limits = {{ acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }}"
        )
    };
    for (locked, slide) in [("['slide']", 0.0), ("{ slide = 0.25 }", 0.25)] {
        let task = task(&folder, &satellite(), &text(locked)).unwrap();
        assert_eq!(task.robot.joint_count(), 1);
        let whole = read(&satellite()).unwrap();
        let [a, b] = [tool(&task.robot, &[0.7]), tool(&whole, &[0.7, slide])];
        assert!((Vector3::from(a.position) - Vector3::from(b.position)).norm() < 1e-12);
        let [a, b] = [
            base_twist(&task.robot, &[0.7], &[1.0]),
            base_twist(&whole, &[0.7, slide], &[1.0, 0.0]),
        ];
        assert!((Vector3::from(a.angular) - Vector3::from(b.angular)).norm() < 1e-14);
    }
    for (locked, expected) in [
        ("['slied']", "no joint `slied` that moves; did you mean `slide`?"),
        ("{ slide = 0.5 }", "0.5 m is out of the range 0 m to 0.4 m of slide"),
        ("['slide', 'shoulder']", "no joint moves"),
        ("3", "a list of joints, or a table of joints and positions"),
    ] {
        let error = task(&folder, &satellite(), &text(locked)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A joint that the robot's file locks is where the task says, if that locks it, too.
#[test]
fn a_tasks_lock_wins() {
    let folder = tempfile::tempdir().unwrap();
    let file = "name = 'r'\nurdf = 'robot.urdf'\nlocked = { slide = 0.1 }\n";
    std::fs::write(folder.path().join("robot.toml"), file).unwrap();
    let rest = "start = { joints_deg = [10], base_zyx_deg = [1, 0, 0] }
goal = { joints_deg = [20], base_zyx_deg = [0, 0, 0] }
limits = { acceleration_deg_s2 = 70, jerk_deg_s3 = 80 }";
    let whole = read(&satellite()).unwrap();
    for (locked, slide) in [("", 0.1), ("locked = { slide = 0.25 }\n", 0.25)] {
        let text = format!("robot = 'robot.toml'\n{locked}{rest}");
        let task = task(&folder, &satellite(), &text).unwrap();
        let [a, b] = [tool(&task.robot, &[0.7]), tool(&whole, &[0.7, slide])];
        assert!((Vector3::from(a.position) - Vector3::from(b.position)).norm() < 1e-12);
    }
}

/// A payload is a body fixed to the tool, or to a link.
#[test]
fn a_payload_is_carried() {
    let folder = tempfile::tempdir().unwrap();
    let payload = "payload = { mass = 5, inertia = { xx = 1, yy = 2, zz = 3 }, centre_of_mass = [0, 0.1, 0.2] }";
    let carrying =
        task(&folder, &satellite(), &format!("robot = 'robot.urdf'\n{payload}{REST}")).unwrap();
    let hand = "<link name='hand'><inertial><origin xyz='0 0.1 0.2'/><mass value='5'/><inertia ixx='1' iyy='2' izz='3'/></inertial></link>";
    let heavy = read(&satellite().replace("<link name='hand'/>", hand)).unwrap();
    assert_eq!(carrying.robot.total_mass(), 109.0);
    let (at, rates) = ([0.4, 0.2], [0.5, -0.1]);
    let [a, b] = [base_twist(&carrying.robot, &at, &rates), base_twist(&heavy, &at, &rates)];
    assert!((Vector3::from(a.angular) - Vector3::from(b.angular)).norm() < 1e-14);
    let on_link = payload.replace("mass = 5", "mass = 5, link = 'slider'");
    assert!(task(&folder, &satellite(), &format!("robot = 'robot.urdf'\n{on_link}{REST}")).is_ok());
    let error = task(
        &folder,
        &satellite(),
        &format!("robot = 'robot.urdf'\n{}{REST}", on_link.replace("slider", "slidre")),
    );
    assert!(error.unwrap_err().to_string().contains("no link `slidre`; did you mean `slider`?"));
}

/// What another robot's task leaves out is asked for, and never the paper's.
#[test]
fn nothing_is_inherited_unsaid() {
    let folder = tempfile::tempdir().unwrap();
    let error = task(&folder, &satellite(), "robot = 'robot.urdf'\n").unwrap_err().to_string();
    for key in [
        "`start.joints`",
        "`start.base_zyx_deg`",
        "`goal.joints`",
        "`goal.base_zyx_deg`",
        "`limits.acceleration`",
        "`limits.jerk`",
    ] {
        assert!(error.contains(key), "{error}");
    }
    assert!(!error.contains("limits.rate"), "{error}");
    let degrees = REST.replace("joints = [10, 0.1]", "joints_deg = [10, 0.1]");
    let error = task(&folder, &satellite(), &format!("robot = 'robot.urdf'{degrees}"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("`joints_deg` is in degrees, and joint `slide` slides"), "{error}");
    let one = REST.replace("jerk = [80, 0.3]", "jerk = 80");
    let error =
        task(&folder, &satellite(), &format!("robot = 'robot.urdf'{one}")).unwrap_err().to_string();
    assert!(error.contains("one `jerk` for all joints, and joint `slide` slides"), "{error}");
}

/// Two URDFs on one base, told apart by their prefixes.
#[test]
fn arms_are_mounted_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), arm()).unwrap();
    let path = folder.path().join("two.toml");
    let text = "name = 'two'
base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 } }
arm = [
  { urdf = 'arm.urdf', prefix = 'left_', mount = [0, 1, 0] },
  { urdf = 'arm.urdf', prefix = 'right_', mount = [0, -1, 0], mount_zyx_deg = [180, 0, 0] },
]";
    std::fs::write(&path, text).unwrap();
    let robot = Robot::from_document(&Document::read(&path).unwrap()).unwrap();
    let names: Vec<&str> = robot.joints().map(|joint| joint.name).collect();
    assert_eq!(names, ["left_shoulder", "left_slide", "right_shoulder", "right_slide"]);
    assert_eq!(robot.total_mass(), 308.0);
    // Arms at opposite places that turn alike, one turned half a turn about z: both turn about x, against each other.
    let alike = base_twist(&robot, &[0.0; 4], &[1.0, 0.0, -1.0, 0.0]);
    let alone = base_twist(&robot, &[0.0; 4], &[1.0, 0.0, 0.0, 0.0]);
    assert!(Vector3::from(alone.angular).norm() > 1e-4);
    assert!((alike.angular.x - 2.0 * alone.angular.x).abs() < 1e-12, "{alike:?} {alone:?}");
    let twice = text.replace("right_", "left_");
    std::fs::write(&path, twice).unwrap();
    let error = Robot::from_document(&Document::read(&path).unwrap()).unwrap_err().to_string();
    assert!(error.contains("found two links with the name `left_body`"), "{error}");
}

/// Every mistake: what is replaced, by what, and what the error says.
#[test]
#[expect(clippy::too_many_lines, reason = "a list")]
fn mistakes_are_named() {
    let many: String = (0..100_000).fold(String::new(), |mut text, i| {
        let _ = write!(text, "<link name='l{i}'/><joint name='j{i}' type='fixed'><parent link='{}'/><child link='l{i}'/></joint>", if i == 0 { "hand".to_owned() } else { format!("l{}", i - 1) });
        text
    });
    let deep = "<a>".repeat(200_000);
    let bomb = "<!DOCTYPE lolz [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]>\n<robot name='satellite'>";
    let loop_of_two = "<link name='x'/><link name='y'/><joint name='xy' type='fixed'><parent link='x'/><child link='y'/></joint><joint name='yx' type='fixed'><parent link='y'/><child link='x'/></joint></robot>";
    let cases: &[(&str, &str, &str)] = &[
        ("<robot name='satellite'>", "<sdf>", "this is not valid XML"),
        ("<robot name='satellite'>", "<robot>", "`<robot>` has no `name`"),
        ("<robot name='satellite'>", bomb, "found a document type"),
        ("</robot>", "", "this is not valid XML"),
        ("</robot>", "</robot><robot/>", "this is not valid XML"),
        ("</robot>", &deep, "found elements nested more than 200 deep"),
        ("</robot>", &format!("{many}</robot>"), "found 100004 links, expected at most 1000"),
        ("</robot>", loop_of_two, "link `x` is part of a loop of joints that no root carries"),
        (
            "</robot>",
            "<link name='alone'/></robot>",
            "found two links that no joint carries, `body` and `alone`",
        ),
        ("</robot>", "<link name='hand'/></robot>", "found two links with the name `hand`"),
        (
            "</robot>",
            "<joint name='j' type='fixed'><parent link='hand'/><child link='upper'/></joint></robot>",
            "link `upper` is carried by two joints, `shoulder` and `j`",
        ),
        (
            "</robot>",
            "<joint name='j' type='fixed'><parent link='hand'/><child link='body'/></joint></robot>",
            "found no root",
        ),
        ("</robot>", "<link/></robot>", "`<link>` has no `name`"),
        ("</robot>", "<joint type='fixed'/></robot>", "`<joint>` has no `name`"),
        ("</robot>", "<xacro:macro name='m'/></robot>", "found xacro"),
        ("xyz='0.5 0 0'", "xyz='${x} 0 0'", "found xacro"),
        ("xyz='0.5 0 0'", "xyz='$(arg x) 0 0'", "found xacro"),
        ("xyz='0.5 0 0'", "xyz='0.5 0'", "found 2 numbers as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz='0.5 0 0 0'", "found 4 numbers as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz=''", "found nothing as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz='0.5 nan 0'", "found `nan` as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz='0.5 0 inf'", "found `inf` as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz='0,5 0 0'", "found `0,5` as `xyz`, expected 3 numbers"),
        ("xyz='0.5 0 0'", "xyz='1e999 0 0'", "found `1e999` as `xyz`"),
        ("rpy='0 1.5707963267948966 0'", "rpy='up'", "found `up` as `rpy`, expected 3 numbers"),
        ("<axis xyz='0 0 2'/>", "<axis xyz='0 0 0'/>", "the axis has no direction"),
        ("<axis xyz='0 0 2'/>", "<axis/>", "`<axis>` has no `xyz`"),
        ("<axis xyz='0 0 2'/>", "<axis xyz='0 0 1e-200'/>", "the axis has no direction"),
        ("<axis xyz='0 0 2'/>", "<axis xyz='0 0 2' xyz='0 1 0'/>", "is already defined"),
        (
            "ixx='10' iyy='10' izz='10'",
            "ixx='0' iyy='0' izz='0'",
            "the inertia of link `body`, the base, with what is fixed to it, is not positive definite",
        ),
        (
            "<axis xyz='0 0 2'/>",
            "<axis xyz='1 0 0'/><axis xyz='0 1 0'/>",
            "found a second `<axis>` in a `<joint>`",
        ),
        (
            "lower='-1' upper='2'",
            "lower='2' upper='-1'",
            "found a range from 2 to -1, expected `lower` below `upper`",
        ),
        ("lower='-1' upper='2'", "lower='1' upper='1'", "found a range from 1 to 1"),
        ("lower='-1' upper='2'", "", "a revolute joint has no `<limit>` with `lower` and `upper`"),
        ("lower='-1' upper='2'", "lower='a' upper='2'", "found `a` as `lower`, expected a number"),
        (
            "<limit lower='0' upper='0.4' velocity='0.1' effort='5'/>",
            "",
            "a prismatic joint has no `<limit>`",
        ),
        ("velocity='0.5'", "velocity='-0.5'", "found -0.5 as `velocity`, expected zero or above"),
        ("type='revolute'", "type='hinge'", "found a joint of type `hinge`"),
        ("type='revolute'", "type='revolut'", "did you mean `revolute`?"),
        ("type='revolute'", "type='planar'", "found a joint of type `planar`"),
        ("type='revolute'", "type='floating'", "only the root floats"),
        ("type='revolute'", "", "`<joint>` has no `type`"),
        (
            "<parent link='body'/>",
            "<parent link='bdoy'/>",
            "joint `shoulder` joins link `bdoy`, which does not exist; did you mean `body`?",
        ),
        ("<parent link='body'/>", "<parent/>", "`<parent>` has no `link`"),
        ("<parent link='body'/>", "", "`<joint>` has no `<parent>`"),
        ("<child link='upper'/>", "<child link='arm'/>", "joins link `arm`, which does not exist"),
        (
            "<child link='upper'/>",
            "<child link='body'/>",
            "link `body` is part of a loop of joints",
        ),
        (
            "<limit lower='-1'",
            "<mimic joint='slider'/><limit lower='-1'",
            "joint `shoulder` follows joint `slider`: the robot has no joint `slider` that moves",
        ),
        (
            "<limit lower='-1'",
            "<mimic joint='shoulder'/><limit lower='-1'",
            "joint `shoulder` follows itself",
        ),
        (
            "<limit lower='-1'",
            "<mimic joint='slide' multiplier='0'/><limit lower='-1'",
            "found 0 as `multiplier`, expected a number other than zero",
        ),
        (
            "<limit lower='-1'",
            "<mimic joint='slide' multiplier='1' offset='x'/><limit lower='-1'",
            "found `x` as `offset`, expected a number",
        ),
        ("<limit lower='-1'", "<mimic/><limit lower='-1'", "`<mimic>` has no `joint`"),
        (
            "<limit lower='-1'",
            "<mimic joint='slide' offset='5'/><limit lower='-1'",
            "joint `shoulder` follows joint `slide`, and no motion keeps both within their ranges",
        ),
        (
            "<mass value='100'/>",
            "<mass value='-100'/>",
            "found a mass of -100, expected zero or above",
        ),
        (
            "<mass value='100'/>",
            "<mass value='heavy'/>",
            "found `heavy` as `value`, expected a number",
        ),
        ("<mass value='100'/>", "<mass/>", "`<mass>` has no `value`"),
        ("<mass value='100'/>", "", "`<inertial>` has no `<mass>`"),
        (
            "<mass value='100'/>",
            "<mass value='0'/>",
            "link `body`, the root of the robot, has no mass",
        ),
        ("<inertia ixx='10' iyy='10' izz='10'/>", "", "`<inertial>` has no `<inertia>`"),
        ("ixx='10' iyy='10'", "ixx='10'", "`<inertia>` has no `iyy`"),
        ("ixx='10'", "ixx='-10'", "the inertia of link `body` has a negative principal moment"),
        (
            "ixx='10'",
            "ixx='10' ixy='50'",
            "the inertia of link `body` has a negative principal moment",
        ),
        (
            BASE,
            "",
            "link `body`, the root of the robot, has no mass and cannot be the floating base",
        ),
        ("name='shoulder'", "name='slide'", "found two joints with the name `slide`"),
        ("name='shoulder'", "name=' '", "found a name without a letter"),
    ];
    assert!(cases.len() > 50);
    for (from, to, expected) in cases {
        let text = satellite();
        assert!(text.contains(from), "{from}");
        let error = read(&text.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(expected), "{to:.60}\n expected {expected}\n found    {error}");
        assert!(error.starts_with("robot.urdf:"), "{error}");
        assert!(error.len() < 1000, "{error}");
    }
}

/// Joints whose bodies weigh nothing, one after another, as files have them for a shoulder of several axes; a joint that moves
/// nothing at all has no effect and cannot be planned for.
#[test]
fn massless_links() {
    let between = satellite().replacen(
        &format!("<link name='upper'>{BODY}</link>"),
        "<link name='upper'/>",
        1,
    );
    let robot = read(&between).unwrap();
    assert!(robot.warning().unwrap().contains("upper"), "{:?}", robot.warning());
    let last = satellite().replacen(
        &format!("<link name='slider'>{BODY}</link>"),
        "<link name='slider'/>",
        1,
    );
    let error = read(&last).unwrap_err().to_string();
    assert!(error.contains("joint `slide` moves nothing that has mass"), "{error}");
}

/// A leader without mass, as files have it for a hand, moves what follows it.
#[test]
fn leaders_may_be_without_mass() {
    let hand = satellite().replacen(
        "<joint name='grip' type='fixed'>",
        "<joint name='grip' type='revolute'><limit lower='-1' upper='1'/>",
        1,
    );
    let error = read(&hand).unwrap_err().to_string();
    assert!(error.contains("joint `grip` moves nothing that has mass"), "{error}");
    let led = hand.replacen("<limit lower='-1'", "<mimic joint='grip'/><limit lower='-1'", 1);
    let robot = read(&led).unwrap();
    assert_eq!(robot.leading().collect::<Vec<_>>(), [1, 2]);
}

/// Half a file, or nothing at all.
#[test]
fn cut_files() {
    let text = satellite();
    for length in (0..text.len()).step_by(7) {
        let document = Document::embedded("cut.urdf", &text[..length]);
        assert!(RobotFile::read(&document).is_err(), "read {length} bytes");
    }
}

/// Every mistake of a robot file: its text after `name`, what stands under `base`, and what the error says.
#[test]
fn robot_files_have_their_own_mistakes() {
    const BASE: &str = "base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 } }";
    const ROOM: &str = "mass = 2, inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), arm()).unwrap();
    let turn = "joint = { type = 'revolute', range_deg = [-90, 90] }";
    let link = |keys: &str| format!("{BASE}\nlink = [{{ name = 'a', {ROOM}, {keys} }}]");
    let joint = |keys: &str| link(&format!("joint = {{ {keys} }}"));
    let two = format!("link = [{{ name = 'a', {ROOM} }}, {{ name = 'b', {ROOM}, {turn} }}]");
    let cases = [
        (BASE.to_owned(), "missing field `joint`, `link`, `urdf` or `arm`"),
        (format!("{BASE}\nurdf = 'arm.urdf'\nlink = []"), "found both `link` and `urdf`"),
        (format!("{BASE}\nlink = []"), "found no link, expected at least one"),
        (format!("{BASE}\nurdf = 'leg.urdf'"), "no URDF file at "),
        (format!("{BASE}\nurdf = 'arm.urdf'"), "missing field `mount`"),
        ("urdf = 'arm.urdf'".to_owned(), "link `body`, the root of the robot, has no mass"),
        (
            "arm = [{ urdf = 'arm.urdf', mount = [0, 0, 0] }]".to_owned(),
            "missing field `base`, which arms are mounted on",
        ),
        (
            format!(
                "{}, mount = [0, 0, 1] }}\narm = [{{ urdf = 'arm.urdf', mount = [0, 0, 0] }}]",
                BASE.strip_suffix(" }").unwrap()
            ),
            "found a mount of the base, and each arm has one of its own",
        ),
        (
            format!("{BASE}\nlink = [{{ name = 'a', mass = 2, {turn} }}]"),
            "link `a` has a mass and no inertia",
        ),
        (
            link(&format!("parent = 'b', {turn}")),
            "link `a` has the parent `b`, expected `base` or an earlier link",
        ),
        (link(&format!("{turn}\n}}, {{ name = 'a', {ROOM}")), "found two links with the name `a`"),
        (link("weight = 3"), "unknown field `weight`"),
        (link("zyx_deg = [0, 0]"), "invalid length 2"),
        (joint("type = 'hinge'"), "unknown variant `hinge`"),
        (
            joint("type = 'revolute'"),
            "joint of link `a`: missing field `range_deg` of a revolute joint",
        ),
        (
            joint("type = 'revolute', range_m = [0, 1]"),
            "joint of link `a`: a revolute joint has no `range_m`",
        ),
        (joint("type = 'prismatic', range_deg = [0, 1]"), "a prismatic joint has no `range_deg`"),
        (
            joint("type = 'prismatic', range_m = [0, 1], rate_deg_s = 1"),
            "a prismatic joint has no `rate_deg_s`",
        ),
        (joint("type = 'continuous', range_deg = [0, 1]"), "a continuous joint has no `range_deg`"),
        (joint("type = 'continuous', axis = [0, 0, 0]"), "the axis has no direction"),
        (joint("type = 'prismatic', range_m = [1, 0]"), "empty range 1 to 0"),
        (joint("type = 'continuous', torque_n_m = -3"), "expected a finite number above zero"),
        (
            format!("{two}\ntool = {{ link = 'b' }}"),
            "found two links without a parent, `a` and `b`, and no `[base]` that carries them",
        ),
        (
            two.replace("'b',", "'b', parent = 'a',").replacen(
                "'a',",
                "'a', position = [0, 0, 1],",
                1,
            ),
            "link `a` has a place, and no base to have it on",
        ),
        (
            link(&format!("{turn}\n}}]\ntool = {{ link = 'hand' }}\nlocked = ["))
                .replace(" }]", "]"),
            "no link `hand`",
        ),
        (format!("locked = ['b']\n{}", link(turn)), "robot `r` has no joint `b` that moves"),
        (format!("locked = ['a']\n{}", link(turn)), "no joint moves"),
    ];
    for (text, expected) in cases {
        let path = folder.path().join("robot.toml");
        std::fs::write(&path, format!("name = 'r'\n{text}\n")).unwrap();
        let error = Robot::from_document(&Document::read(&path).unwrap()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}\n expected {expected}\n found    {error}");
    }
}

/// A base is given once, and mistakes in the task's own tables are told of the task.
#[test]
fn tasks_have_their_own_mistakes() {
    let folder = tempfile::tempdir().unwrap();
    let base = "base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 }, mount = [0, 0, 0] }";
    for (keys, expected) in [
        (base.replace(", mount = [0, 0, 0]", ""), "missing field `mount`"),
        (base.replace("xx = 70", "xx = -70"), "the inertia is not positive definite"),
        (format!("{base}\npayload = {{ mass = 0 }}"), "expected a finite number above zero"),
        (
            format!("{base}\npayload = {{ mass = 1, inertia = {{ xx = -1, yy = 1, zz = 1 }} }}"),
            "the inertia of the payload has a negative principal moment",
        ),
    ] {
        let error = task(&folder, &arm(), &format!("robot = 'robot.urdf'\n{keys}{REST}"));
        let error = error.unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("task.toml:"), "{error}");
    }
    let twice = format!("robot = 'xiao2023'\n{base}\n");
    let error = task(&folder, &arm(), &twice).unwrap_err().to_string();
    assert!(
        error.contains("found a base for robot `xiao2023`, which has one of its own"),
        "{error}"
    );
}

/// What a robot's own task states for a joint goes with the joint when that is locked.
#[test]
fn shipped_tasks_do_without_locked_joints() {
    let folder = tempfile::tempdir().unwrap();
    let whole = task(&folder, "", "robot = 'panda'").unwrap();
    let part = task(&folder, "", "robot = 'panda'\nlocked = { panda_joint3 = 10 }").unwrap();
    let without = |values: &[f64]| [&values[..2], &values[3..]].concat();
    assert_eq!(part.start.joints, without(&whole.start.joints));
    assert_eq!(part.goal.joints, without(&whole.goal.joints));
    assert_eq!(part.limits.0[2], whole.limits.0[3]);
}
