//! Robots that start with angular momentum.

use std::sync::Arc;

use driftless::attitude::{Drift, increments};
use driftless::input::Document;
use driftless::lanes::Width;
use driftless::momentum::{BaseResponse, Twist, drifting_twist, locked_momentum, total_momentum};
use driftless::optimiser::{Scp, Settings};
use driftless::reorientation::{
    Accuracy, FamilyChoice, Formulated, Formulation, Motion, Planner, Reach, Reorientation,
    TaskFile, TaskProblem,
};
use driftless::robot::Robot;
use driftless::search::{Problem, Rng, Watch};
use driftless::task::Task;
use driftless::trajectory::{Curve, Family, Spline};
use driftless::vec3::Vec3;
use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3, Vector6};

const ROBOTS: [&str; 4] = ["xiao2023", "ur5e", "dual_arm", "canadarm2"];

fn read(text: &str) -> Result<Task, String> {
    let document = Document::embedded("task.toml", text);
    let file = TaskFile::read(&document).map_err(|error| error.to_string())?;
    let problem = file.problem(&document).map_err(|error| error.to_string())?;
    Ok((**problem.task()).clone())
}

fn drifting(robot: &str, rate_deg_s: [f64; 3]) -> Task {
    read(&format!("[task]\nrobot = '{robot}'\nstart.base_rate_deg_s = {rate_deg_s:?}\n")).unwrap()
}

fn over(task: Task, pieces: usize, steps: usize) -> Reorientation<Spline> {
    let family = task.splines(pieces, 4);
    let accuracy = Accuracy { attitude_steps: steps, peak_intervals: 1 };
    Reorientation::over(Arc::new(task), family, accuracy)
}

/// A smooth path that swings joints by a few tenths of a radian.
fn path(problem: &Reorientation<Spline>, rng: &mut Rng) -> Vec<f64> {
    let family = problem.family();
    let mut coefficients = vec![0.0; family.dimension()];
    for &joint in family.leading() {
        let own = family.coefficients_of(joint);
        let (size, count) = (0.4 * rng.normal(), own.len() as f64);
        for (k, value) in coefficients[own].iter_mut().enumerate() {
            *value = size * (std::f64::consts::PI * (k as f64 + 1.0) / (count + 1.0)).sin();
        }
    }
    coefficients
}

/// The base's twist for which the momentum that is summed body by body, eq. 5, is the one that is asked for.
fn twist(robot: &Robot, positions: &[f64], rates: &[f64], momentum: Vector3<f64>) -> Vector6<f64> {
    let total = |base: Vector6<f64>, rates: &[f64]| {
        let part = |k: usize| Vec3::new(base[k], base[k + 1], base[k + 2]);
        let (p, l) =
            total_momentum(robot, positions, rates, &Twist { linear: part(0), angular: part(3) });
        Vector6::new(p.x, p.y, p.z, l.x, l.y, l.z)
    };
    let own = total(Vector6::zeros(), rates);
    let still = vec![0.0; rates.len()];
    let columns: Vec<_> = (0..6).map(|k| total(Vector6::ith(k, 1.0), &still)).collect();
    let wanted = Vector6::new(0.0, 0.0, 0.0, momentum.x, momentum.y, momentum.z) - own;
    Matrix6::from_columns(&columns).lu().solve(&wanted).unwrap()
}

#[test]
fn the_base_answers_with_the_momentum_that_is_asked_for() {
    let mut rng = Rng::new(1);
    for name in ROBOTS {
        let robot = Robot::from_document(&Robot::embedded(name).unwrap()).unwrap();
        for _ in 0..5 {
            let mut draw = || (0..robot.joint_count()).map(|_| rng.normal()).collect::<Vec<_>>();
            let (positions, rates, h) = (draw(), draw(), draw());
            let h = Vec3::new(30.0 * h[0], -40.0 * h[1], 20.0 * h[2]);
            let base = drifting_twist(&robot, &positions, &rates, h);
            let (linear, angular) = total_momentum(&robot, &positions, &rates, &base);
            assert!(Vector3::from(linear).norm() < 1e-9, "{name}: {linear:?}");
            assert!(Vector3::from(angular - h).norm() < 1e-9, "{name}: {angular:?} {h:?}");
            let response = BaseResponse::of(&robot, &positions, &rates).with(h);
            assert!(Vector3::from(response - base.angular).norm() < 1e-12, "{name}");
            // All moving as one, the momentum is the locked inertia times the rate.
            let still = vec![0.0; rates.len()];
            let rate = Vec3::new(0.1, -0.2, 0.3);
            let locked = locked_momentum(&robot, &positions, rate);
            let turned = drifting_twist(&robot, &positions, &still, locked).angular;
            assert!(Vector3::from(turned - rate).norm() < 1e-12, "{name}: {turned:?}");
        }
    }
}

/// Classical Runge–Kutta on `q' = ½ q ω`, with the twist from the sum over bodies.
fn integrated(problem: &Reorientation<Spline>, c: &[f64], duration: f64) -> UnitQuaternion<f64> {
    let (task, family) = (problem.task(), problem.family());
    let curves: Vec<_> = (0..family.joints())
        .map(|joint| family.curve(joint, &c[family.coefficients_of(joint)]))
        .collect();
    let slope = |q: Quaternion<f64>, tau: f64| {
        let at: Vec<[f64; 2]> = curves.iter().map(|curve| curve.derivatives(tau)).collect();
        let positions: Vec<f64> = at.iter().map(|at| at[0]).collect();
        let rates: Vec<f64> = at.iter().map(|at| at[1] / duration).collect();
        let momentum = UnitQuaternion::new_normalize(q).inverse() * task.angular_momentum.unwrap();
        let base = twist(&task.robot, &positions, &rates, momentum);
        q * Quaternion::from_imag(base.fixed_rows::<3>(3).into_owned() * (duration / 2.0))
    };
    let steps = 2000;
    let width = 1.0 / f64::from(steps);
    let mut q = task.start.base.into_inner();
    for i in 0..steps {
        let tau = f64::from(i) * width;
        let a = slope(q, tau);
        let b = slope(q + a * (width / 2.0), tau + width / 2.0);
        let c = slope(q + b * (width / 2.0), tau + width / 2.0);
        let d = slope(q + c * width, tau + width);
        q += (a + b * 2.0 + c * 2.0 + d) * (width / 6.0);
    }
    UnitQuaternion::new_normalize(q)
}

/// From a slow drift to a tumbling of 3 °/s and more.
#[test]
fn the_base_ends_where_an_integrator_brings_it() {
    let mut rng = Rng::new(2);
    for name in ROBOTS {
        for rate in [[0.02, -0.05, 0.03], [1.0, 3.0, -2.0]] {
            let problem = over(drifting(name, rate), 8, 240);
            let c = path(&problem, &mut rng);
            for duration in [4.0, 30.0] {
                let end = problem.task().start.base * problem.rotation_over(&c, duration);
                let expected = integrated(&problem, &c, duration);
                let miss = end.angle_to(&expected);
                assert!(miss < 1e-9, "{name}, {rate:?}, {duration} s: {miss:e}");
            }
        }
    }
}

#[test]
fn steps_and_panels_and_samples_agree() {
    let problem = over(drifting("ur5e", [0.5, -1.0, 2.0]), 10, 240);
    let c = path(&problem, &mut Rng::new(3));
    let (task, family, duration) = (problem.task(), problem.family(), 12.0);
    let net = problem.rotation_over(&c, duration);
    let scalar = problem.with_width(Width::Scalar).rotation_over(&c, duration);
    assert!(net.angle_to(&scalar) < 1e-12);
    let drift =
        Drift { momentum: task.angular_momentum.unwrap(), start: task.start.base, duration };
    let write = |tau: f64, positions: &mut [f64], rates: &mut [f64]| {
        for joint in 0..family.joints() {
            let curve = family.curve(joint, &c[family.coefficients_of(joint)]);
            [positions[joint], rates[joint]] = curve.derivatives(tau);
        }
    };
    let steps = increments(&task.robot, 300, Some(drift), write);
    let by_steps = steps.fold(UnitQuaternion::identity(), |net, step| net * step);
    assert!(net.angle_to(&by_steps) < 1e-9, "{:e}", net.angle_to(&by_steps));
    let motion = Motion::sample(&problem, &c, duration, 100);
    let end = *motion.base.last().unwrap();
    assert!((task.start.base * net).angle_to(&end) < 1e-8);
}

/// The sixth order: twice as many steps, a sixty-fourth of the error, or rounding.
#[test]
fn errors_fall_with_the_sixth_power() {
    let task = drifting("xiao2023", [1.0, 2.0, -3.0]);
    let net = |steps: usize| {
        let problem = over(task.clone(), 5, steps);
        let c = path(&problem, &mut Rng::new(4));
        problem.rotation_over(&c, 20.0)
    };
    let exact = net(960);
    let [coarse, fine] = [30, 60].map(|steps| net(steps).angle_to(&exact));
    assert!(coarse > 1e-11 && fine < coarse / 40.0, "{coarse:e} {fine:e}");
}

/// Slopes of the cost at a point beside those of central differences.
fn check_slopes(problem: &impl Problem, x: &[f64], what: &str) {
    let slopes = problem.slopes().unwrap().at(x).unwrap().slopes;
    let cost = |x: &[f64]| problem.evaluate(x).unwrap().cost;
    let mut kinks = 0;
    for (k, slope) in slopes.iter().enumerate() {
        let [ahead, back] = [1e-6, -1e-6].map(|step| {
            let mut there = x.to_vec();
            there[k] += step;
            cost(&there)
        });
        let expected = (ahead - back) / 2e-6;
        let is_kink = (ahead + back - 2.0 * cost(x)).abs() > 2e-6 * 1e-3 * slopes.amax();
        kinks += usize::from(is_kink);
        assert!(
            is_kink || (slope - expected).abs() < 2e-5 * slopes.amax(),
            "{what}, x[{k}]: {slope} {expected}"
        );
    }
    assert!(2 * kinks < slopes.len(), "{what}: {kinks} of {} at a kink", slopes.len());
}

/// At a fixed duration, and where the limits or `least_duration_s` say how long; over splines and over sine polynomials.
#[test]
fn slopes_are_those_of_differences() {
    let mut rng = Rng::new(5);
    for name in ROBOTS {
        for least in [1e-3, 40.0] {
            let mut task = drifting(name, [0.4, -0.8, 1.2]);
            task.least_duration = least;
            let problem = Formulated::free_form(Arc::new(over(task, 7, 24))).unwrap();
            let x = path(problem.task(), &mut rng);
            check_slopes(&problem, &x, &format!("{name}, {least}, splines"));
        }
        let text = format!("[task]\nrobot = '{name}'\nstart.base_rate_deg_s = [0.4, -0.8, 1.2]\n");
        let document = Document::embedded("task.toml", &text);
        let problem = TaskFile::read(&document).unwrap().problem(&document).unwrap();
        let TaskProblem::SinePolynomial(problem, boxes) = problem else {
            panic!("expected sine polynomials")
        };
        let problem = Arc::new(problem);
        let problem = Formulated::new(Formulation::TimeFree, problem, &boxes).unwrap();
        let x: Vec<f64> = problem
            .bounds()
            .iter()
            .map(|[lower, upper]| 0.1 * (upper - lower) * rng.normal())
            .collect();
        check_slopes(&problem, &x, &format!("{name}, sine polynomials"));
    }
}

/// A base that tumbles faster than the arm can turn it back: the motion lasts until the base passes near its goal.
#[test]
fn a_motion_waits_for_the_base() {
    let text = "[task]\nrobot = 'ur5e'\nstart.base_rate_deg_s = [0, 0, 3]\n\
         [trajectory]\nfamily = 'spline'\npieces = 10\n";
    let document = Document::embedded("task.toml", text);
    let scp = Settings::Scp(Scp::default());
    let planner = Planner::read(&document, FamilyChoice::default(), scp).unwrap();
    let found = planner.plan(1, 40_000, &Watch::default()).unwrap();
    assert_eq!(found.reach, Reach::Reached);
    // The base alone would take two minutes for a turn.
    let duration = found.assessment.duration;
    assert!((60.0..150.0).contains(&duration), "{duration}");
    let problem = over((**found.problem.task()).clone(), 10, 240);
    let end = integrated(&problem, &found.coefficients, duration);
    let miss = end.angle_to(&problem.task().goal.base).to_degrees();
    assert!(miss < problem.task().goal_tolerance.to_degrees() + 1e-6, "{miss}");
}

/// Momentum that turns the base by several turns within a panel is too much for the panel, and nothing is said of where it ends.
#[test]
fn what_cannot_be_followed_is_nan() {
    let problem = over(drifting("ur5e", [0.0, 0.0, 30.0]), 8, 24);
    let c = path(&problem, &mut Rng::new(6));
    let end = |duration: f64| problem.rotation_over(&c, duration).coords;
    assert!(end(10.0).iter().all(|number| number.is_finite()));
    assert!(end(1e4).iter().all(|number| number.is_nan()), "{}", end(1e4));
}

#[test]
fn momentum_is_read_in_both_ways() {
    let by_rate = drifting("ur5e", [0.3, -0.2, 0.1]);
    let momentum: [f64; 3] = by_rate.angular_momentum.unwrap().into();
    let text = format!("[task]\nrobot = 'ur5e'\nangular_momentum = {momentum:?}\n");
    assert_eq!(read(&text).unwrap().angular_momentum, by_rate.angular_momentum);
    let still = read("[task]\nangular_momentum = [0, 0, 0]\n").unwrap();
    assert_eq!(still.angular_momentum, None);
    for (text, expected) in [
        ("[task]\nangular_momentum = [0, 0, nan]\n", "finite"),
        ("[task]\nangular_momentum = [0, 0]\n", "3"),
        ("[task]\ngoal.base_rate_deg_s = [0, 0, 1]\n", "for the start alone"),
        (
            "[task]\nangular_momentum = [1, 0, 0]\nstart.base_rate_deg_s = [1, 0, 0]\n",
            "expected one of them",
        ),
        ("[task]\nangular_momentum = [1, 0, 0]\nlimits.base_turn_deg = 20\n", "base_turn_deg"),
        (
            "[task]\nangular_momentum = [1, 0, 0]\nrobust = { samples = 4 }\n[task.uncertainty]\nmass = 0.1\n",
            "`robust`",
        ),
        ("[task]\nlimits.least_duration_s = 0\n", "above zero"),
    ] {
        let error = read(text).unwrap_err();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

/// A target that turns is caught: what the robot and the target had is what both have afterwards, and the base still ends at its goal.
#[test]
fn the_momentum_of_what_is_caught_is_added() {
    let text = "[task]\nrobot = 'ur5e'\nangular_momentum = [0.01, 0, 0]\n\
         [[task.via]]\njoints_deg = [10, -100, 80, -60, -90, 10]\nbase_zyx_deg = [1, 2, 0]\n\
         capture = { mass = 20, inertia = { xx = 0.5, yy = 0.4, zz = 0.3 } }\nangular_momentum = [0, 0.03, -0.02]\n\
         [trajectory]\nfamily = 'spline'\npieces = 16\n";
    let planner = |text: &str| {
        let document = Document::embedded("task.toml", text);
        Planner::read(&document, FamilyChoice::default(), Settings::Scp(Scp::default()))
    };
    let found = planner(text).unwrap().plan_mission(1, 20_000, &Watch::default()).unwrap();
    assert!(found.is_reached());
    let momenta: Vec<[f64; 3]> =
        found.legs.iter().map(|leg| leg.motion.task().angular_momentum.unwrap().into()).collect();
    assert_eq!(momenta, [[0.01, 0.0, 0.0], [0.01, 0.03, -0.02]]);
    let ends = found.legs.iter().map(|leg| *leg.motion.sample(50).base.last().unwrap());
    let goals = found.legs.iter().map(|leg| leg.motion.task().goal.base);
    for (end, goal) in ends.zip(goals) {
        assert!(end.angle_to(&goal).to_degrees() < 1e-3);
    }
    for (keys, expected) in [
        (
            "tool = { position_m = [0.6, 0.2, 0.9], approach_m = 0.1 }\nangular_momentum = [0, 1, 0]",
            "without `capture`",
        ),
        (
            "tool = { position_m = [0.6, 0.2, 0.9], retreat_m = 0.1 }\ncapture = { mass = 1 }\nangular_momentum = [0, 1, 0]",
            "straight line",
        ),
        (
            "joints_deg = [10, -100, 80, -60, -90, 10]\ncapture = { mass = 1 }\nangular_momentum = [0, 1, 0]\n[[task.via]]\nrelease = true",
            "`release`",
        ),
    ] {
        let error =
            planner(&format!("[task]\nrobot = 'ur5e'\n[[task.via]]\n{keys}\n")).unwrap_err();
        assert!(error.to_string().contains(expected), "{keys}: {error}");
    }
}

/// A path that takes no time has slopes all the same.
#[test]
fn a_standing_robot_has_finite_slopes() {
    let mut task = drifting("ur5e", [0.5, 1.0, -0.3]);
    task.goal.joints = task.start.joints.clone();
    let problem = Formulated::free_form(Arc::new(over(task, 8, 24))).unwrap();
    let x = vec![0.0; problem.bounds().len()];
    let found = problem.slopes().unwrap().at(&x).unwrap();
    assert!(found.evaluation.cost.is_finite() && found.slopes.iter().all(|s| s.is_finite()));
}
