//! Shapes of base and links, from files to base axes and back.

use driftless::input::{Document, InputError};
use driftless::robot::{Body, Joint, Robot, RobotFile, Shape, ShapeSource};
use driftless::task::{Task, TaskTable};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};

const INERTIAL: &str =
    "<inertial><mass value='2'/><inertia ixx='0.1' iyy='0.1' izz='0.1'/></inertial>";
const TURN: &str = "joint = { type = 'continuous' }";
const BODY: &str = "mass = 2, inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }";

fn read(text: &str) -> Result<Robot, InputError> {
    Robot::from_document(&Document::embedded("robot.toml", text))
}

fn assert_near(found: &Vector3<f64>, expected: [f64; 3]) {
    assert!((found - Vector3::from(expected)).norm() < 1e-12, "{found} and {expected:?}");
}

/// All shapes in base axes with all joints at these positions, with the link that has them and the body that this is part of:
/// a link with a joint that moves, or the base.
fn placed(robot: &Robot, positions: &[f64]) -> Vec<(Option<usize>, Option<usize>, Shape)> {
    let mut positions = positions.iter();
    let mut frames: Vec<(Option<usize>, Isometry3<f64>)> = Vec::new();
    let mut shapes = Vec::new();
    let mut add = |link, mover, frame: &Isometry3<f64>, body: &Body| {
        let turn = frame.rotation.to_rotation_matrix();
        let moved = body.shapes.iter().map(|shape| shape.moved(&frame.translation.vector, &turn));
        shapes.extend(moved.map(|shape| (link, mover, shape)));
    };
    add(None, None, &Isometry3::identity(), robot.base());
    for (i, link) in robot.links().iter().enumerate() {
        let parent = link.parent.map_or((None, Isometry3::identity()), |parent| frames[parent]);
        let frame = parent.1 * link.placement.isometry();
        let (mover, frame) = match &link.joint {
            Joint::Fixed => (parent.0, frame),
            Joint::Revolute(axis) => {
                let turn =
                    UnitQuaternion::from_axis_angle(&axis.direction, *positions.next().unwrap());
                (Some(i), frame * turn)
            }
            Joint::Prismatic(axis) => {
                let way = *axis.direction * *positions.next().unwrap();
                (Some(i), frame * Translation3::from(way))
            }
        };
        add(Some(i), mover, &frame, &link.body);
        frames.push((mover, frame));
    }
    shapes
}

/// One of each kind on a chain whose first joint is locked at a quarter turn. Its link's frame is at `[1, 0, 0]`, x where y is;
/// the second joint is 0.5 m above, with y up and z where the base's x is: `Rz(90°) Rx(90°)`.
#[test]
fn shapes_stand_in_the_frames_of_their_tables() {
    let text = "name = 'r'
        locked = { one = 90 }
        [base]
        mass = 100
        inertia = { xx = 10, yy = 10, zz = 10 }
        mount = [1, 0, 0]
        shapes = [{ box = { size = [2, 1, 0.5], centre = [0, 0.1, 0], zyx_deg = [90, 0, 0] } }, { sphere = { radius = 0.25 } }]
        [[joint]]
        name = 'one'
        dh = { d = 0.5, a = 0, alpha_deg = 90 }
        range_deg = [-180, 180]
        mass = 2
        centre_of_mass = [0, 0, 0]
        inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }
        shapes = [{ capsule = { from = [0.3, 0, 0], to = [0, 0, 0.5], radius = 0.08 } }]
        [[joint]]
        name = 'two'
        dh = { d = 0.5, a = 0, alpha_deg = 0 }
        range_deg = [-180, 180]
        mass = 2
        centre_of_mass = [0, 0, 0]
        inertia = { xx = 0.1, yy = 0.1, zz = 0.1 }
        shapes = [
            { sphere = { centre = [0.2, 0.3, 0.1], radius = 0.1 } },
            { cylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = 0.1 } },
            { cylinder = { from = [0, 0, 0], to = [0, 0, 0.1], radius = 0.1 } },
        ]";
    let robot = read(text).unwrap();
    let shapes = placed(&robot, &[0.0]);
    let links: Vec<_> = shapes.iter().map(|(link, mover, _)| (*link, *mover)).collect();
    let (first, second) = ((Some(0), None), (Some(1), Some(1)));
    assert_eq!(links, [(None, None), (None, None), first, second, second, second]);
    let capsule = |index: usize| match &shapes[index].2 {
        Shape::Capsule { ends, radius } => (*ends, *radius),
        other @ Shape::Cuboid { .. } => panic!("{other:?}"),
    };
    let edges = |index: usize| match &shapes[index].2 {
        Shape::Cuboid { centre, half, rotation } => (*centre, (rotation * half).abs()),
        other @ Shape::Capsule { .. } => panic!("{other:?}"),
    };
    assert_near(&edges(0).0, [0.0, 0.1, 0.0]);
    assert_near(&edges(0).1, [0.5, 1.0, 0.25]);
    assert_eq!(capsule(1), ([Vector3::zeros(); 2], 0.25));
    assert_near(&capsule(2).0[0], [1.0, 0.3, 0.0]);
    assert_near(&capsule(2).0[1], [1.0, 0.0, 0.5]);
    assert_near(&capsule(3).0[0], [1.1, 0.2, 0.8]);
    assert_near(&capsule(4).0[1], [2.0, 0.0, 0.5]);
    assert_near(&edges(5).0, [1.05, 0.0, 0.5]);
    assert_near(&edges(5).1, [0.05, 0.1, 0.1]);
    // The file that is written of it is the same robot.
    let file = RobotFile::read(&Document::embedded("robot.toml", text)).unwrap();
    assert_eq!(read(&toml::to_string(&file).unwrap()).unwrap(), robot);
    assert_eq!(robot.with_shapes(), (robot, ShapeSource::Stated));
}

#[test]
fn mistakes_in_shapes_are_told_where_they_are() {
    let rod = |keys: &str| format!("shapes = [{{ capsule = {{ {keys} }} }}]");
    let ends = "from = [0, 0, 0], to = [0, 0, 1]";
    let cases = [
        ("shapes = [{ sphere = { radius = 0 } }]".to_owned(), "found 0, expected a finite number above zero"),
        ("shapes = [{ sphere = { radius = nan } }]".to_owned(), "found NaN, expected a finite number above zero"),
        (rod(&format!("{ends}, radius = -0.1")), "found -0.1, expected a finite number above zero"),
        (rod(ends), "missing field `radius`"),
        (rod("from = [0, 0], to = [0, 0, 1], radius = 1"), "invalid length 2"),
        (rod("from = [0, 0, inf], to = [0, 0, 1], radius = 1"), "found inf, expected a finite number"),
        (rod(&format!("{ends}, raduis = 1")), "unknown field `raduis`, expected one of `from`, `to`, `radius`; did you mean `radius`?"),
        ("shapes = [{ ball = { radius = 1 } }]".to_owned(), "unknown field `ball`"),
        ("shapes = [{ sphere = { radius = 1 }, box = { size = [1, 1, 1] } }]".to_owned(), "found both `sphere` and `box`, expected one of them"),
        ("shapes = [{}]".to_owned(), "missing field `sphere`, `capsule`, `cylinder` or `box`"),
        ("shapes = [{ box = { size = [1, 0, 1] } }]".to_owned(), "found 0, expected a finite number above zero"),
        ("shapes = [{ box = { size = 1 } }]".to_owned(), "invalid type: integer `1`"),
        ("shapes = [{ cylinder = { from = [0, 0, 1], to = [0, 0, 1], radius = 1 } }]".to_owned(), "the cylinder has no length"),
        ("shapes = [{ capsule = { from = [0, 0, 0], to = [1e308, 1e308, 1e308], radius = 1e308 } }]".to_owned(), ""),
    ];
    for (shapes, expected) in cases {
        let base =
            format!("[base]\nmass = 100\ninertia = {{ xx = 10, yy = 10, zz = 10 }}\n{shapes}\n");
        let link = format!("[[link]]\nname = 'a'\n{}\n{TURN}\n", BODY.replace(", i", "\ni"));
        for text in [
            format!("name = 'r'\n{base}{link}"),
            format!("name = 'r'\n{}{link}{shapes}\n", base.replace(&shapes, "")),
        ] {
            match read(&text) {
                Ok(_) => assert_eq!(expected, "", "{text}"),
                Err(error) => {
                    let error = error.to_string();
                    assert!(
                        error.contains(expected),
                        "{shapes}\n expected {expected}\n found {error}"
                    );
                    let line =
                        text.lines().position(|line| line.starts_with("shapes")).unwrap() + 1;
                    let place = format!("robot.toml:{line}:");
                    let place = place.strip_prefix("robot.toml:").unwrap();
                    assert!(error.starts_with(&format!("robot.toml: {place}")), "{error}");
                }
            }
        }
    }
    let pairs = |ignore: &str| {
        read(&format!(
            "name = 'r'\nbase = {{ mass = 100, inertia = {{ xx = 10, yy = 10, zz = 10 }} }}\ncollision = {{ ignore = {ignore} }}\n\
             link = [{{ name = 'upper', {BODY}, {TURN} }}, {{ name = 'lower', parent = 'upper', {BODY}, {TURN} }}]\n"
        ))
    };
    assert_eq!(
        pairs("[['upper', 'lower'], ['base', 'lower']]").unwrap().ignored_pairs(),
        [[Some(0), Some(1)], [None, Some(1)]]
    );
    for (ignore, expected) in [
        ("[['upper', 'lowr']]", "no link `lowr`; did you mean `lower`?"),
        ("[['upper', 'x']]", "no link `x`; the base is called `base`"),
        ("[['upper', 'upper']]", "found `upper` twice in a pair"),
        ("[['upper']]", "invalid length 1"),
    ] {
        let error = pairs(ignore).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("robot.toml: 3:"), "{error}");
    }
}

/// A satellite whose centre of mass is 1 m along x, with a panel that is fixed to it, and one arm.
fn urdf() -> String {
    let solid = |origin: &str, geometry: &str| {
        format!("<collision><origin {origin}/><geometry>{geometry}</geometry></collision>")
    };
    let quarter = std::f64::consts::FRAC_PI_2;
    format!(
        "<robot name='r'>
        <link name='bus'><inertial><origin xyz='1 0 0'/><mass value='100'/><inertia ixx='10' iyy='10' izz='10'/></inertial>
        {}{}</link>
        <link name='panel'>{}</link>
        <link name='arm'>{INERTIAL}{}{}{}{}{}</link>
        <link name='hand'><collision><geometry><mesh filename='hand.stl'/></geometry></collision></link>
        <joint name='boom' type='fixed'><parent link='bus'/><child link='panel'/><origin xyz='0 2 0'/></joint>
        <joint name='turn' type='continuous'><parent link='bus'/><child link='arm'/><origin xyz='2 0 0'/><axis xyz='0 0 1'/></joint>
        <joint name='grip' type='fixed'><parent link='arm'/><child link='hand'/><origin xyz='1 0 0'/></joint>
        </robot>",
        solid(&format!("xyz='1 0 0' rpy='0 0 {quarter}'"), "<box size='2 1 0.5'/>"),
        solid("xyz='0 0 0'", "<sphere radius='0'/>"),
        solid("xyz='0 1 0'", "<box size='1 2 0.1'/>"),
        solid(&format!("xyz='0.5 0 0' rpy='0 {quarter} 0'"), "<cylinder radius='0.1' length='0.8'/>"),
        solid("xyz='0.1 0 0'", "<sphere radius='0.1'/>"),
        solid("xyz='0.9 0 0'", "<sphere radius='0.1'/>"),
        solid("xyz='0 0 0.2'", "<cylinder radius='0.1' length='0.1'/>"),
        solid("xyz='0.5 0 0.3'", "<sphere radius='0.2'/>"),
    )
}

fn read_urdf(text: &str) -> Result<Robot, InputError> {
    Robot::from_document(&Document::embedded("robot.urdf", text))
}

#[test]
fn collision_elements_are_shapes() {
    let robot = read_urdf(&urdf()).unwrap();
    let counts: Vec<_> = robot.links().iter().map(|link| link.body.shapes.len()).collect();
    // The cylinder with a sphere at either end is one capsule; what has no extent is nothing.
    assert_eq!((robot.base().shapes.len(), &counts[..]), (1, &[1, 3, 0][..]));
    let shapes = placed(&robot, &[0.0]);
    let Shape::Cuboid { centre, half, rotation } = &shapes[0].2 else { panic!() };
    assert_near(centre, [0.0, 0.0, 0.0]);
    assert_near(&(rotation * half).abs(), [0.5, 1.0, 0.25]);
    let Shape::Cuboid { centre, .. } = &shapes[1].2 else { panic!() };
    assert_near(centre, [-1.0, 3.0, 0.0]);
    assert_eq!(shapes[1].1, None);
    let Shape::Capsule { ends, radius } = &shapes[2].2 else { panic!() };
    assert_near(&ends[0], [1.1, 0.0, 0.0]);
    assert_near(&ends[1], [1.9, 0.0, 0.0]);
    assert_eq!(*radius, 0.1);
    let file = RobotFile::read(&Document::embedded("robot.urdf", &urdf())).unwrap();
    assert_eq!(file.links_with_meshes_alone(), (1, 4));
    let written = read(&toml::to_string(&file).unwrap()).unwrap();
    assert_eq!(written, robot);
    // Without shapes they are derived: the arm's with the hand, which is its tool, 1 m out, as a cylinder of 2 · 0.1 / 2 = 0.1 m².
    let text = urdf();
    let bare: String = text
        .split("<collision>")
        .enumerate()
        .map(|(i, part)| if i == 0 { part } else { part.split_once("</collision>").unwrap().1 })
        .collect();
    let (derived, source) = read_urdf(&bare).unwrap().with_shapes();
    assert_eq!((source, derived.shape_count()), (ShapeSource::Derived, 2));
    let shapes = placed(&derived, &[0.0]);
    let Shape::Capsule { ends, radius } = &shapes[1].2 else { panic!() };
    // A quarter of its length is less.
    assert_eq!(*radius, 0.25);
    assert_near(&ends[0], [1.25, 0.0, 0.0]);
    assert_near(&ends[1], [1.75, 0.0, 0.0]);
    for (from, to, expected) in [
        ("radius='0.2'", "radius='-0.2'", "found -0.2 as `radius`, expected zero or above"),
        ("radius='0.2'", "radius='wide'", "found `wide` as `radius`, expected a number"),
        ("size='2 1 0.5'", "size='2 1'", "found 2 numbers as `size`, expected 3 numbers"),
        ("<box size='1 2 0.1'/>", "<box/>", "`<box>` has no `size`"),
    ] {
        let error = read_urdf(&urdf().replace(from, to)).unwrap_err().to_string();
        assert!(error.contains(expected) && !error.contains("urdf: robot"), "{error}");
    }
}

/// All numbers of shapes in base axes, those of places from the middle of the base's first box.
fn numbers(robot: &Robot) -> Vec<f64> {
    let shapes = placed(robot, &vec![0.0; robot.joint_count()]);
    let Shape::Cuboid { centre: middle, .. } = shapes[0].2 else { panic!() };
    let numbers = shapes.iter().flat_map(|(_, _, shape)| match shape {
        Shape::Capsule { ends: [from, to], radius } => {
            // Either end may be the first.
            let ends =
                if (from.x, from.y, from.z) < (to.x, to.y, to.z) { [from, to] } else { [to, from] };
            let ends = ends.map(|end| end - middle);
            [ends[0].as_slice(), ends[1].as_slice(), &[*radius]].concat()
        }
        Shape::Cuboid { centre, half, rotation } => {
            [(centre - middle).as_slice(), half.as_slice(), rotation.matrix().as_slice()].concat()
        }
    });
    numbers.collect()
}

#[test]
fn shapes_of_shipped_robots_go_through_files() {
    for name in Robot::embedded_names() {
        let document = Robot::embedded(name).unwrap();
        let file = RobotFile::read(&document).unwrap();
        let robot = file.build(&document).unwrap();
        assert_eq!(read(&toml::to_string(&file).unwrap()).unwrap(), robot, "{name}");
        let (shaped, source) = robot.with_shapes();
        let expected = if name == "xiao2023" { ShapeSource::Derived } else { ShapeSource::Stated };
        assert_eq!(source, expected, "{name}");
        let through = read_urdf(&shaped.to_urdf()).unwrap();
        let (before, after) = (numbers(&shaped), numbers(&through));
        assert_eq!(before.len(), after.len(), "{name}");
        for (a, b) in before.iter().zip(after) {
            assert!((a - b).abs() < 1e-9, "{name}: {a} and {b}");
        }
    }
}

#[test]
fn arms_have_their_shapes_with_prefixes() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.urdf"), urdf()).unwrap();
    let path = folder.path().join("two.toml");
    let text = "name = 'two'
        base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 }, shapes = [{ sphere = { radius = 0.5 } }] }
        arm = [
            { urdf = 'arm.urdf', prefix = 'left_', mount = [0, 1, 0] },
            { urdf = 'arm.urdf', prefix = 'right_', mount = [0, -1, 0], mount_zyx_deg = [180, 0, 0] },
        ]
        collision = { ignore = [['left_arm', 'right_arm'], ['base', 'right_panel']] }";
    std::fs::write(&path, text).unwrap();
    let document = Document::read(&path).unwrap();
    let file = RobotFile::read(&document).unwrap();
    let robot = file.build(&document).unwrap();
    let place = |name: &str| robot.links().iter().position(|link| link.name == name);
    let pairs = [[place("left_arm"), place("right_arm")], [None, place("right_panel")]];
    assert_eq!(robot.ignored_pairs(), pairs);
    assert_eq!(robot.shape_count(), 1 + 2 * 5);
    // Half a turn about z: the panel's middle, `[0, 3, 0]` from the mount, is at `[0, −1 − 3, 0]`.
    let shapes = placed(&robot, &[0.0; 2]);
    let panel = shapes.iter().find(|(link, ..)| *link == place("right_panel")).unwrap();
    let Shape::Cuboid { centre, .. } = panel.2 else { panic!() };
    assert_near(&centre, [0.0, -4.0, 0.0]);
    assert_eq!(read(&toml::to_string(&file).unwrap()).unwrap(), robot);
}

/// What a task adds has shapes, too, and pairs stay with a robot whose joints are locked and that carries something.
#[test]
fn tasks_add_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let task = |keys: &str| -> Task {
        let path = folder.path().join("task.toml");
        std::fs::write(&path, keys).unwrap();
        let document = Document::read(&path).unwrap();
        document.parse::<TaskTable>().unwrap().build(&document).unwrap()
    };
    let loaded = task(
        "robot = 'iiwa'\nlocked = ['iiwa_joint_3']\npayload = { mass = 5, shapes = [{ box = { centre = [0, 0, 0.1], size = [0.2, 0.2, 0.2] } }] }",
    );
    let plain = task("robot = 'iiwa'");
    let (robot, own) = (&loaded.robot, &plain.robot);
    assert_eq!(robot.ignored_pairs(), own.ignored_pairs());
    assert!(!own.ignored_pairs().is_empty());
    assert_eq!(robot.shape_count(), own.shape_count() + 1);
    // The tool is 0.045 m beyond the last link, with its axes.
    let payload = placed(robot, &[0.0; 6]).pop().unwrap().2;
    let flange = placed(own, &[0.0; 7]).pop().unwrap().2;
    let (Shape::Cuboid { centre, .. }, Shape::Capsule { ends, .. }) = (payload, flange) else {
        panic!()
    };
    assert_near(&(centre - ends[0]), [0.0, 0.0, 0.1 + 0.045 - 0.001]);
    let urdf = urdf()
        .replace("<mass value='100'/>", "<mass value='0'/>")
        .replace("ixx='10' iyy='10' izz='10'", "ixx='0' iyy='0' izz='0'");
    std::fs::write(folder.path().join("arm.urdf"), urdf).unwrap();
    let based = task(
        "robot = 'arm.urdf'
        base = { mass = 300, inertia = { xx = 70, yy = 70, zz = 70 }, mount = [0, 0, 1], shapes = [{ sphere = { radius = 0.5 } }] }
        start = { joints_deg = [0], base_zyx_deg = [1, 0, 0] }
        goal = { joints_deg = [9], base_zyx_deg = [0, 0, 0] }
        limits = { rate_deg_s = 10, acceleration_deg_s2 = 10, jerk_deg_s3 = 10 }",
    );
    let shapes = placed(&based.robot, &[0.0]);
    assert_eq!(shapes[0].2, Shape::sphere(Vector3::zeros(), 0.5));
    let Shape::Cuboid { centre, .. } = shapes[1].2 else { panic!() };
    assert_near(&centre, [1.0, 0.0, 1.0]);
}

/// Points, and how near to one of them all of a solid is \[m\]: of a box the ball around it.
fn inner(shape: &Shape) -> (Vec<Vector3<f64>>, f64) {
    match shape {
        Shape::Capsule { ends: [from, to], radius } => {
            let along = |i: i32| from + (to - from) * (f64::from(i) / 400.0);
            ((0..=400).map(along).collect(), *radius)
        }
        Shape::Cuboid { centre, half, .. } => (vec![*centre], half.norm()),
    }
}

/// The distance of two solids \[m\], from many points of their segments.
fn distance(first: &Shape, second: &Shape) -> f64 {
    let (points, radius) = inner(second);
    let to = |point: &Vector3<f64>| match first {
        Shape::Capsule { ends: [from, to], radius } => {
            let way = to - from;
            let share = (point - from).dot(&way) / way.norm_squared().max(1e-300);
            (point - from - way * share.clamp(0.0, 1.0)).norm() - radius
        }
        Shape::Cuboid { centre, half, rotation } => {
            let local: Vector3<f64> = Rotation3::inverse(rotation) * (point - centre);
            (local.abs() - half).map(|beyond| beyond.max(0.0)).norm()
        }
    };
    points.iter().map(to).fold(f64::INFINITY, f64::min) - radius
}

/// At start and goal of the shipped tasks no two bodies touch that no joint joins.
#[test]
fn shipped_tasks_start_and_end_free() {
    for name in Robot::embedded_names() {
        let document = Document::embedded("task.toml", &format!("robot = '{name}'"));
        let task = document.parse::<TaskTable>().unwrap().build(&document).unwrap();
        let (robot, _) = task.robot.with_shapes();
        for posture in [&task.start, &task.goal] {
            let shapes = placed(&robot, &posture.joints);
            let parent = |mover: Option<usize>| {
                let mut inner = robot.links()[mover?].parent;
                while let Some(link) = inner {
                    if robot.links()[link].joint.axis().is_some() {
                        break;
                    }
                    inner = robot.links()[link].parent;
                }
                Some(inner)
            };
            for (i, (link, mover, second)) in shapes.iter().enumerate() {
                for (other, body, first) in &shapes[..i] {
                    let is_joined = mover == body || parent(*mover) == Some(*body);
                    let pairs = robot.ignored_pairs();
                    let may_touch =
                        [[*link, *other], [*other, *link]].iter().any(|p| pairs.contains(p));
                    if is_joined || may_touch {
                        continue;
                    }
                    let distance = distance(first, second);
                    assert!(
                        distance > 0.01,
                        "{name}: {other:?} and {link:?} are {distance} m apart"
                    );
                }
            }
        }
    }
}
