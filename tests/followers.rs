//! Joints that follow others: beside the same robot with their paths written out by hand, an integration of its own, and differences.

use std::fs;
use std::sync::Arc;

use driftless::input::{Document, InputError};
use driftless::momentum::base_twist;
use driftless::reorientation::{
    Accuracy, Boxes, Formulated, Formulation, Motion, Reorientation, TaskFile, TaskProblem,
};
use driftless::robot::{Robot, RobotFile};
use driftless::search::{Composite, Multipliers, PieceId, Problem, Rng};
use driftless::task::Task;
use driftless::trajectory::{Family, Spline};
use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};

/// Three joints that turn and the two fingers of a gripper.
const ROBOT: &str = "name = 'gripper'
[base]
mass = 80
inertia = { xx = 9, yy = 8, zz = 7, xy = 0.3 }
mount = [0.2, 0.1, 0.4]
[[link]]
name = 'upper'
joint = { name = 'shoulder', type = 'revolute', axis = [0, 1, 0], range_deg = [-150, 120] }
mass = 6
centre_of_mass = [0.05, 0, 0.3]
inertia = { xx = 0.2, yy = 0.2, zz = 0.05 }
[[link]]
name = 'lower'
parent = 'upper'
position = [0, 0, 0.6]
zyx_deg = [20, 0, 10]
joint = { name = 'elbow', type = 'revolute', axis = [1, 0, 0], range_deg = ELBOW }
mass = 5
centre_of_mass = [0, 0.1, 0.3]
inertia = { xx = 0.2, yy = 0.2, zz = 0.05 }
[[link]]
name = 'hand'
parent = 'lower'
position = [0, 0, 0.5]
joint = { name = 'wrist', type = 'revolute', axis = [0, 1, 1], range_deg = WRIST }
mass = 4
centre_of_mass = [0.1, 0, 0.1]
inertia = { xx = 0.1, yy = 0.1, zz = 0.05 }
[[link]]
name = 'left_finger'
parent = 'hand'
position = [0, 0, 0.2]
joint = { name = 'left', type = 'prismatic', axis = [0, 1, 0], range_m = LEFT }
mass = 2
inertia = { xx = 0.01, yy = 0.01, zz = 0.01 }
[[link]]
name = 'right_finger'
parent = 'hand'
position = [0.3, 0, 0.2]
joint = { name = 'right', type = 'prismatic', axis = [0.5, -1, 0], range_m = RIGHT }
mass = 3
inertia = { xx = 0.01, yy = 0.01, zz = 0.01 }
";

/// The wrist turns back by half of what the elbow does, and the right finger goes a little further than the left one.
const FOLLOW: &str = "follow = { wrist = { joint = 'elbow', multiplier = -0.5, offset_deg = 20 }, \
    right = { joint = 'left', multiplier = 1.25, offset_m = 0.01 } }";

/// Followers' ranges make those of their leaders narrower: elbow −160° to 100° by the wrist's −30° to 100°, the left finger 0 to 0.2 m by
/// the right one's end at 0.26 m.
const RANGES: [[&str; 4]; 2] = [
    ["[-170, 130]", "[-30, 100]", "[0, 0.4]", "[-0.1, 0.26]"],
    ["[-160, 100]", "[-30, 100]", "[0, 0.2]", "[0.01, 0.26]"],
];

fn robot(follow: &str, ranges: [&str; 4]) -> String {
    let names = ["ELBOW", "WRIST", "LEFT", "RIGHT"].into_iter().zip(ranges);
    let text = names.fold(ROBOT.to_owned(), |text, (name, range)| text.replace(name, range));
    format!("{follow}\n{text}")
}

const TASK: &str = "[task]
robot = 'robot.toml'
start = { joints = START, base_zyx_deg = [3, -2, 1] }
goal = { joints = GOAL, base_zyx_deg = [0, 0, 0] }
limits = { rate = RATE, acceleration = [60, 70, 80, 0.3, 0.2], jerk = [90, 80, 70, 0.4, 0.3] MORE }
";

/// A file in a folder with the robot.
fn file(robot: &str, task: &str) -> (tempfile::TempDir, Document) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("robot.toml"), robot).unwrap();
    fs::write(folder.path().join("task.toml"), task).unwrap();
    let document = Document::read(&folder.path().join("task.toml")).unwrap();
    (folder, document)
}

fn task_of(robot: &str, task: &str) -> Result<Task, InputError> {
    let (_folder, document) = file(robot, task);
    TaskFile::read(&document)?.task.build(&document)
}

/// The task with followers, and the same with all joints on their own.
fn tasks(more: &str) -> [Arc<Task>; 2] {
    let task = TASK.replace("MORE", more);
    // 20° − ½ · 30°, 0.01 m + 1¼ · 0.04 m; 20° + ½ · 40°, 0.01 m + 1¼ · 0.16 m.
    let own = task.replace("START", "[10, 30, 5, 0.04, 0.06]");
    let own = own.replace("GOAL", "[-20, -40, 40, 0.16, 0.21]");
    let own = own.replace("RATE", "[50, 60, 30, 0.2, 0.25]");
    // The missing rates are those of the leaders, ½ and 1¼ times.
    let left_out = task.replace("START", "{ shoulder = 10, elbow = 30, left = 0.04 }");
    let left_out = left_out.replace("GOAL", "[-20, -40, 0.16]");
    let left_out = left_out.replace("RATE", "{ shoulder = 50, elbow = 60, left = 0.2 }");
    [
        Arc::new(task_of(&robot(FOLLOW, RANGES[0]), &left_out).unwrap()),
        Arc::new(task_of(&robot("", RANGES[1]), &own).unwrap()),
    ]
}

const ACCURACY: Accuracy = Accuracy { attitude_steps: 96, peak_intervals: 191 };

fn sines(terms: usize) -> [Reorientation; 2] {
    tasks("").map(|task| Reorientation::new(task, terms, ACCURACY))
}

fn splines(degree: usize) -> [Reorientation<Spline>; 2] {
    tasks("").map(|task| {
        let family = task.splines(12, degree);
        Reorientation::over(task, family, ACCURACY)
    })
}

fn drawn(count: usize, size: f64, rng: &mut Rng) -> Vec<f64> {
    (0..count).map(|_| rng.uniform(-size, size)).collect()
}

#[test]
fn what_is_left_out_follows() {
    let [task, own] = tasks("");
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(near(&task.start.joints, &own.start.joints), "{:?}", task.start);
    assert!(near(&task.goal.joints, &own.goal.joints), "{:?}", task.goal);
    for (limits, own) in task.limits.0.iter().zip(&own.limits.0) {
        assert!(near(limits, own), "{limits:?} {own:?}");
    }
    for (joint, own) in task.robot.joints().zip(own.robot.joints()) {
        assert!(near(&joint.range, &own.range), "{joint:?} {own:?}");
    }
    assert_eq!(task.robot.leading().collect::<Vec<_>>(), [0, 1, 3]);
    assert_eq!(task.sine_polynomials(2).dimension(), 6);
}

/// The cost and all that goes into it is that of the same paths of a robot whose joints move on their own.
fn agree<F: Family>([following, own]: &[Reorientation<F>; 2], signs: [f64; 2], size: f64) {
    let free = own.family().coefficients_of(0).len();
    let mut rng = Rng::new(7);
    for duration in [None, Some(4.0)] {
        for _ in 0..5 {
            let x = drawn(3 * free, size, &mut rng);
            let times = |row: usize, by: f64| x[row * free..][..free].iter().map(move |x| by * x);
            let all = [(0, 1.0), (1, 1.0), (1, signs[0]), (2, 1.0), (2, signs[1])];
            let all: Vec<f64> = all.into_iter().flat_map(|(row, by)| times(row, by)).collect();
            let (found, expected) = (following.assess(&x, duration), own.assess(&all, duration));
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-11 * b.abs().max(1.0);
            assert!(near(found.cost, expected.cost), "{} {}", found.cost, expected.cost);
            assert!(near(found.duration, expected.duration));
            assert!(near(found.attitude_error, expected.attitude_error));
            assert!(near(found.range_excess, expected.range_excess));
            for (found, expected) in found.peaks.0.iter().zip(&expected.peaks.0) {
                let mut orders = found.iter().zip(expected);
                assert!(orders.all(|(a, b)| near(a.value, b.value)), "{found:?} {expected:?}");
            }
            let cost = following.evaluate(&x, duration, &mut following.workspace()).cost;
            assert!(near(cost, found.cost), "{cost} {}", found.cost);
        }
    }
}

/// A phase is the same, but where the joint goes the other way in its range.
#[test]
fn sine_polynomials_are_those_written_by_hand() {
    (1..=4).for_each(|terms| agree(&sines(terms), [-1.0, 1.0], 0.4));
}

/// Control points are multiplied.
#[test]
fn splines_are_those_written_by_hand() {
    (3..=5).for_each(|degree| agree(&splines(degree), [-0.5, 1.25], 0.2));
}

/// Where the base ends by the classical Runge–Kutta method, with followers' positions worked out from their leaders'.
fn integrated<F: Family>(problem: &Reorientation<F>, x: &[f64]) -> UnitQuaternion<f64> {
    const STEPS: usize = 4000;
    let task = problem.task();
    // Every half step.
    let motion = Motion::sample(problem, x, 1.0, 2 * STEPS);
    let omega = |at: usize| {
        let [shoulder, elbow, _, left, _] = [0, 1, 2, 3, 4].map(|joint| {
            let [position, rate, ..] = motion.joints[joint].derivatives[at];
            [position, rate]
        });
        let wrist = [20_f64.to_radians() - 0.5 * elbow[0], -0.5 * elbow[1]];
        let right = [0.01 + 1.25 * left[0], 1.25 * left[1]];
        let joints = [shoulder, elbow, wrist, left, right];
        for (told, expected) in motion.joints.iter().zip(joints) {
            let found = [told.derivatives[at][0], told.derivatives[at][1]];
            let miss = (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs());
            assert!(miss < 1e-12, "{}: {found:?} {expected:?}", told.name);
        }
        let [positions, rates] = [0, 1].map(|order| joints.map(|joint| joint[order]));
        Vector3::from(base_twist(&task.robot, &positions, &rates).angular)
    };
    let slope = |q: Quaternion<f64>, at: usize| q * Quaternion::from_imag(omega(at) * 0.5);
    let width = 1.0 / STEPS as f64;
    let mut q = Quaternion::identity();
    for at in (0..2 * STEPS).step_by(2) {
        let k1 = slope(q, at);
        let k2 = slope(q + k1 * (width / 2.0), at + 1);
        let k3 = slope(q + k2 * (width / 2.0), at + 1);
        let k4 = slope(q + k3 * width, at + 2);
        q += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (width / 6.0);
    }
    UnitQuaternion::new_normalize(q)
}

#[test]
fn the_base_ends_where_an_integration_of_its_own_says() {
    let mut rng = Rng::new(3);
    let ([sines, _], [splines, _]) = (sines(3), splines(4));
    let x = drawn(9, 0.5, &mut rng);
    let miss = sines.net_rotation(&x).angle_to(&integrated(&sines, &x));
    assert!(miss < 1e-10, "{miss:e}");
    let x = drawn(3 * splines.family().free(), 0.15, &mut rng);
    let miss = splines.net_rotation(&x).angle_to(&integrated(&splines, &x));
    assert!(miss < 1e-10, "{miss:e}");
}

/// Slopes by all variables against central differences of the cost, but where the cost has a kink.
fn check_slopes(problem: &dyn Problem, share: f64, rng: &mut Rng) -> [usize; 2] {
    const STEP: f64 = 1e-6;
    let bounds: Vec<[f64; 2]> = problem.bounds().iter().collect();
    let point = |[lower, upper]: &[f64; 2]| {
        let middle = f64::midpoint(*lower, *upper);
        middle + share * (rng.uniform(*lower, *upper) - middle)
    };
    let x: Vec<f64> = bounds.iter().map(point).collect();
    let cost = |x: &[f64]| problem.evaluate(x).unwrap().cost;
    let found = problem.slopes().unwrap().at(&x).unwrap().slopes;
    let by_variable = bounds.iter().enumerate().map(|(j, [lower, upper])| {
        let step = STEP * (upper - lower);
        let [ahead, back] = [step, -step].map(|step| {
            let mut there = x.clone();
            there[j] += step;
            cost(&there)
        });
        let here = cost(&x);
        [found[j] * (upper - lower), (ahead - here) / STEP, (here - back) / STEP]
    });
    let all: Vec<[f64; 3]> = by_variable.collect();
    let largest = all.iter().map(|[slope, ..]| slope.abs()).fold(1.0, f64::max);
    let (mut compared, mut kinks) = (0, 0);
    for (j, [slope, ahead, back]) in all.into_iter().enumerate() {
        if (ahead - back).abs() > 4e-5 * largest {
            kinks += 1;
            continue;
        }
        let expected = f64::midpoint(ahead, back);
        assert!((slope - expected).abs() < 2e-5 * largest, "x[{j}]: {slope} {expected}");
        compared += 1;
    }
    [compared, kinks]
}

/// Also with limits on the way, which followers have their share in.
#[test]
fn slopes_agree_with_differences() {
    let mut rng = Rng::new(5);
    let asked = [
        "",
        ", tool_speed_m_s = 0.1, base_turn_deg = 2",
        ", torque_n_m = { shoulder = 5, elbow = 4, wrist = 0.4, left = 0.5, right = 0.6 }",
        ", clearance_m = 0.2",
    ];
    let mut tally = [0; 2];
    for more in asked {
        let [task, _] = tasks(more);
        let problem = Arc::new(Reorientation::new(task.clone(), 2, ACCURACY));
        let boxes =
            Boxes { coefficient: vec![1.0, 0.4], duration: [1.0, 9.0], alpha: vec![0.1, 0.1] };
        let sines = Formulation::ALL
            .map(|formulation| Formulated::new(formulation, problem.clone(), &boxes).unwrap());
        let [_, scaled, time_free] = &sines;
        let family = task.splines(9, 3);
        let splines = Formulated::free_form(Arc::new(Reorientation::over(task, family, ACCURACY)));
        let splines = splines.unwrap();
        let mut problems: Vec<&dyn Problem> = vec![scaled, time_free, &splines];
        if more.is_empty() {
            problems.push(&sines[0]);
        }
        for problem in problems {
            for share in [0.1, 0.4, 0.8] {
                let told = check_slopes(problem, share, &mut rng);
                tally = [tally[0] + told[0], tally[1] + told[1]];
            }
        }
    }
    assert!(tally[0] > 350 && 10 * tally[1] < tally[0], "{tally:?}");
}

/// The second derivative is that by all joints' coefficients, of which followers' are their leaders', with the sign of the way that
/// they go.
#[test]
fn curvature_is_that_of_all_joints() {
    let boxes = Boxes { coefficient: vec![1.0; 2], duration: [1.0, 9.0], alpha: vec![0.1; 2] };
    let [following, own] = sines(2)
        .map(|problem| Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap());
    let x = DVector::from_vec(drawn(6, 0.4, &mut Rng::new(2)));
    let mut all = DMatrix::zeros(10, 6);
    for (joint, row, sign) in [(0, 0, 1.0), (1, 1, 1.0), (2, 1, -1.0), (3, 2, 1.0), (4, 2, 1.0)] {
        (0..2).for_each(|k| all[(2 * joint + k, 2 * row + k)] = sign);
    }
    let curvature = |problem: &Formulated, x: &[f64]| {
        let error = [0.8, -1.1, 0.5].into_iter().zip(0..);
        let error = error.map(|(nu, k)| (PieceId::alone(k), nu)).collect();
        problem.curvature(x, &Multipliers { terms: vec![error, Vec::new()] }).unwrap()
    };
    let found = curvature(&following, x.as_slice());
    let expected = all.transpose() * curvature(&own, (&all * &x).as_slice()) * &all;
    let miss = (&found - &expected).amax();
    assert!(miss < 1e-4 * expected.amax(), "{miss:e} of {}", expected.amax());
}

/// The path of a spline is the same over twice as many pieces.
#[test]
fn coarser_splines_are_prolonged() {
    let [task, _] = tasks("");
    let fine = task.splines(32, 4);
    let coarse = fine.coarser().unwrap();
    let x = drawn(coarse.dimension(), 0.2, &mut Rng::new(4));
    let long = coarse.prolong(&x);
    assert_eq!(long.len(), fine.dimension());
    let problems = [(coarse, x), (fine, long)];
    let ends = problems.map(|(family, x)| {
        let problem = Reorientation::over(task.clone(), family, Accuracy::FINE);
        problem.net_rotation(&x)
    });
    assert!(ends[0].angle_to(&ends[1]) < 1e-9);
}

fn read(text: &str) -> Result<Robot, InputError> {
    Robot::from_document(&Document::embedded("robot.toml", text))
}

/// `mimic` of links, `follow` of the file, and both after a way through URDF and back.
#[test]
fn files_of_all_kinds_say_the_same() {
    let expected = read(&robot(FOLLOW, RANGES[0])).unwrap();
    let mimics = robot("", RANGES[0])
        .replace(
            "name = 'wrist',",
            "name = 'wrist', mimic = { joint = 'elbow', multiplier = -0.5, offset_deg = 20 },",
        )
        .replace(
            "name = 'right',",
            "name = 'right', mimic = { joint = 'left', multiplier = 1.25, offset_m = 0.01 },",
        );
    assert_eq!(read(&mimics).unwrap(), expected);
    for text in [&mimics, &robot(FOLLOW, RANGES[0])] {
        let document = Document::embedded("robot.toml", text);
        let kept = toml::to_string(&RobotFile::read(&document).unwrap()).unwrap();
        assert_eq!(read(&kept).unwrap(), expected, "{kept}");
    }
    let urdf = expected.to_urdf();
    assert!(urdf.contains("<mimic joint=\"left\" multiplier=\"1.25\" offset=\"0.01\"/>"), "{urdf}");
    let again = Robot::from_document(&Document::embedded("robot.urdf", &urdf)).unwrap();
    for (found, expected) in again.follows().iter().zip(expected.follows()) {
        let both = [found, expected].map(|follow| follow.map(|f| (f.leader, f.multiplier)));
        assert_eq!(both[0], both[1]);
    }
    // The leader's name alone: the same position.
    let plain = FOLLOW.replace("{ joint = 'left', multiplier = 1.25, offset_m = 0.01 }", "'left'");
    let follow = read(&robot(&plain, RANGES[0])).unwrap().follows()[4].unwrap();
    assert_eq!((follow.leader, follow.multiplier, follow.offset), (3, 1.0, 0.0));
}

/// The wrist follows the elbow, and the elbow the shoulder: −0.5 · 0.4 of it.
#[test]
fn chains_are_resolved() {
    let chain = "elbow = { joint = 'shoulder', multiplier = 0.4, offset_deg = 10 }";
    let found = read(&robot(&FOLLOW.replace("{ wrist", &format!("{{ {chain}, wrist")), RANGES[0]));
    let follow = found.unwrap().follows()[2].unwrap();
    assert_eq!(follow.leader, 0);
    assert!((follow.multiplier + 0.2).abs() < 1e-15);
    assert!((follow.offset.to_degrees() - 15.0).abs() < 1e-12);
}

/// What follows a joint that is locked is locked, too, in the file and in the task, and moves nothing then.
#[test]
fn followers_of_locked_joints_are_locked() {
    let by_hand = read(&robot("locked = { left = 0.04, right = 0.06 }", RANGES[0])).unwrap();
    let follow = "follow = { right = { joint = 'left', offset_m = 0.02 } }";
    let by_file = read(&robot(&format!("locked = {{ left = 0.04 }}\n{follow}"), RANGES[0]));
    assert_eq!(by_file.unwrap(), by_hand);
    let rest = "start = { joints = [0, 0, 0], base_zyx_deg = [0, 0, 0] }\n\
        goal = { joints = [0, 0, 0], base_zyx_deg = [0, 0, 0] }\n\
        limits = { rate_deg_s = 9, acceleration_deg_s2 = 9, jerk_deg_s3 = 9 }\n";
    for (robot, task) in [
        (robot(follow, RANGES[0]), String::new()),
        (robot("", RANGES[0]), follow.to_owned()),
        // Of what both say the task counts.
        (robot("follow = { right = 'shoulder' }", RANGES[0]), follow.to_owned()),
    ] {
        let task =
            format!("[task]\nrobot = 'robot.toml'\nlocked = {{ left = 0.04 }}\n{task}\n{rest}");
        assert_eq!(*task_of(&robot, &task).unwrap().robot, by_hand);
    }
    // A follower that is locked itself follows no longer.
    let task =
        format!("[task]\nrobot = 'robot.toml'\nlocked = {{ left = 0.04, right = 0.06 }}\n{rest}");
    assert_eq!(*task_of(&robot(follow, RANGES[0]), &task).unwrap().robot, by_hand);
}

#[test]
fn mistakes_are_told() {
    let follow = |what: &str| robot(&format!("follow = {{ {what} }}"), RANGES[0]);
    let cases = [
        (follow("rihgt = 'left'"), "the robot has no joint `rihgt` that moves"),
        (
            follow("right = 'elbw'"),
            "joint `right` follows joint `elbw`: the robot has no joint `elbw`",
        ),
        (follow("right = 'right'"), "joint `right` follows itself"),
        (
            follow("right = 'left', left = 'right'"),
            "joint `left` follows itself by way of joint `right`",
        ),
        (
            follow("right = { joint = 'left', multiplier = 0 }"),
            "found 0, expected a finite number other than zero",
        ),
        (
            follow("right = { joint = 'left', multiplier = inf }"),
            "found inf, expected a finite number other than zero",
        ),
        (
            follow("right = { joint = 'left', offset_m = nan }"),
            "found NaN, expected a finite number",
        ),
        (
            follow("right = { joint = 'left', offset_deg = 3 }"),
            "joint `right` slides, so its offset is `offset_m`",
        ),
        (
            follow("wrist = { joint = 'elbow', offset_m = 3 }"),
            "joint `wrist` turns, so its offset is `offset_deg`",
        ),
        (
            follow("right = { joint = 'left', offset_m = 3, offset_deg = 3 }"),
            "found both `offset_deg` and `offset_m`",
        ),
        (follow("right = { leader = 'left' }"), "unknown field `leader`"),
        (follow("right = { multiplier = 2 }"), "missing field `joint`"),
        (follow("right = 3"), "expected a joint, or a table with `joint`"),
        (robot("follow = ['right']", RANGES[0]), "expected a table of joints"),
        (
            follow("right = { joint = 'left', offset_m = 0.3 }"),
            "joint `right` follows joint `left`, and no motion keeps both within their ranges",
        ),
        (
            format!("locked = ['right']\n{}", follow("right = 'left'")),
            "joint `right` is locked and cannot follow another one",
        ),
        (
            format!("locked = {{ left = 0.3 }}\n{}", follow("right = 'left'")),
            "joint `right` follows joint `left`, which is locked: 0.3 m is out of the range -0.1 m to 0.26 m of right",
        ),
    ];
    for (text, expected) in cases {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "expected {expected}\n found    {error}");
        assert!(error.contains("robot.toml: 1:") || error.contains("robot.toml: 2:"), "{error}");
    }
}

#[test]
fn starts_and_goals_agree_or_are_left_out() {
    let robot = robot(FOLLOW, RANGES[0]);
    let task = TASK.replace("MORE", "").replace("RATE", "[50, 60, 30, 0.2, 0.25]");
    let built = |start: &str| {
        let task = task.replace("START", start).replace("GOAL", "[0, 0, 0.1]");
        task_of(&robot, &task)
    };
    for start in [
        "[10, 30, 0.04]",
        "[10, 30, 5, 0.04, 0.06]",
        "{ shoulder = 10, elbow = 30, left = 0.04, right = 0.06 }",
    ] {
        let joints = built(start).unwrap().start.joints;
        assert!((joints[2].to_degrees() - 5.0).abs() < 1e-12, "{joints:?}");
        assert!((joints[4] - 0.06).abs() < 1e-15, "{joints:?}");
    }
    for (start, expected) in [
        (
            "[10, 30, 6, 0.04, 0.06]",
            "found 6° for joint `wrist`, which follows joint `elbow` to 5°",
        ),
        (
            "{ shoulder = 10, elbow = 30, left = 0.04, right = 0.05 }",
            "found 0.05 m for joint `right`, which follows joint `left` to 0.06 m",
        ),
        ("{ shoulder = 10, elbow = 30, right = 0.06 }", "found no value for joint `left`"),
        (
            "[10, 30, 5, 0.04]",
            "expected 5, one for each joint of robot `gripper`, or 3 without those",
        ),
        // Within the elbow's own range, and not where the wrist can follow.
        ("[10, 120, 0.04]", "120° is out of the range -160° to 100° of elbow"),
    ] {
        let error = built(start).unwrap_err().to_string();
        assert!(error.contains(expected), "{start}\n expected {expected}\n found    {error}");
    }
}

/// A robot that comes with the program does so with a task for all its joints.
#[test]
fn joints_of_shipped_robots_may_follow() {
    let follow = "[task]\nrobot = 'panda'\nfollow = { panda_joint6 = { joint = 'panda_joint4', multiplier = -1 } }";
    let (_folder, document) = file("", follow);
    let file = TaskFile::read(&document).unwrap();
    let TaskProblem::Spline(problem, _) = file.clone().planned().problem(&document).unwrap() else {
        panic!("splines are planned")
    };
    let task = problem.task();
    assert_eq!(task.start.joints[5], -task.start.joints[3]);
    assert_eq!(problem.family().dimension(), 6 * problem.family().free());
}
