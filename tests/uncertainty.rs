//! Robots that are not quite what their files say.

use std::sync::Arc;

use driftless::input::Document;
use driftless::optimiser::{Optimiser, Scp};
use driftless::reorientation::{
    Accuracy, FamilySpec, Formulated, Formulation, Robustness, TaskFile,
};
use driftless::robot::Robot;
use driftless::search::{Oracle, Problem, Rng, Watch};
use driftless::task::{Task, Uncertainty, Unknown};

fn task(text: &str) -> Result<Task, String> {
    let document = Document::embedded("task.toml", text);
    let file = TaskFile::read(&document).map_err(|error| error.to_string())?;
    let problem = file.problem(&document).map_err(|error| error.to_string())?;
    Ok((**problem.task()).clone())
}

const ALL: &str = "[task.uncertainty]\nmass = 0.05\ninertia = 0.05\nmount_m = 0.01\njoint_deg = 0.1\nsamples = 40\n";

fn formulated(text: &str, terms: usize) -> Formulated {
    let text = format!("{text}\n[trajectory]\nterms = {terms}\n");
    let document = Document::embedded("task.toml", &text);
    let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap()
}

/// A robot's text with other numbers, read anew.
#[test]
fn masses_inertias_and_the_mount_are_those_of_another_file() {
    let text = |mass: f64, inertia: f64, x: f64| {
        format!(
            "name = \"arm\"\n[base]\nmass = {}\nmount = [{}, 0.1, 0.2]\ninertia = {{ xx = {}, yy = {}, zz = {} }}\n\
             [[joint]]\ndh = {{ d = 0.1, a = 0.5, alpha_deg = 90 }}\nrange_deg = [-180, 180]\nmass = 5\n\
             centre_of_mass = [-0.25, 0, 0]\ninertia = {{ xx = {i}, yy = {j}, zz = {j} }}\n",
            100.0 * mass,
            0.5 + x,
            10.0 * mass,
            12.0 * mass,
            11.0 * mass,
            i = 0.1 * inertia,
            j = 0.2 * inertia,
        )
    };
    let robot = |text: String| Robot::from_document(&Document::embedded("arm", &text)).unwrap();
    let uncertainty = Uncertainty {
        masses: vec![0.1; 2],
        inertias: vec![0.2; 2],
        mount: 0.03,
        joints: vec![0.0],
        samples: 1,
        seed: 1,
    };
    let mut task = task("").unwrap();
    task.robot = Arc::new(robot(text(1.0, 1.0, 0.0)));
    let unknowns = uncertainty.unknowns(&task.robot);
    assert_eq!(unknowns.len(), 2 + 2 + 3);
    let shares =
        [(Unknown::Mass(None), 0.5), (Unknown::Inertia(Some(0)), -1.0), (Unknown::Mount(0), 1.0)];
    let varied = uncertainty.varied(&task, &shares).unwrap().robot;
    let expected = robot(text(1.05, 0.8, 0.03));
    assert!((varied.base().mass - expected.base().mass).abs() < 1e-12);
    assert!((varied.base().inertia - expected.base().inertia).norm() < 1e-12);
    let [found, wanted] = [&varied, &expected].map(|robot| robot.links()[0].clone());
    assert!((found.body.inertia - wanted.body.inertia).norm() < 1e-12);
    let shift = found.placement.translation() - wanted.placement.translation();
    assert!(shift.norm() < 1e-12, "{shift}");
}

/// What is not known of a payload, and of nothing else.
#[test]
fn bodies_can_be_named() {
    let text = "[task]\nrobot = \"ur5e\"\npayload = { mass = 12 }\n[task.uncertainty]\nmass = { payload = 0.5 }\n";
    let task = task(text).unwrap();
    let uncertainty = task.uncertainty.as_ref().unwrap();
    let [unknown] = uncertainty.unknowns(&task.robot)[..] else { panic!("one unknown") };
    assert_eq!(unknown.name(&task.robot), "mass of payload");
    let heavier = uncertainty.varied(&task, &[(unknown, 1.0)]).unwrap();
    assert!((heavier.robot.total_mass() - task.robot.total_mass() - 6.0).abs() < 1e-9);
}

/// With every joint off by the same amount all the way, the base moves as along the shifted path.
#[test]
fn joints_that_are_off_move_the_base_as_along_a_shifted_path() {
    for name in ["ur5e", "panda", "dual_arm"] {
        let task = task(&format!("[task]\nrobot = \"{name}\"")).unwrap();
        let count = task.robot.joint_count();
        let offset = 0.02;
        let uncertainty = Uncertainty {
            masses: vec![0.0; 1 + task.robot.links().len()],
            inertias: vec![0.0; 1 + task.robot.links().len()],
            mount: 0.0,
            joints: vec![offset; count],
            samples: 1,
            seed: 1,
        };
        let shares: Vec<_> = (0..count).map(|joint| (Unknown::Joint(joint), 1.0)).collect();
        let varied = uncertainty.varied(&task, &shares).unwrap();
        let mut shifted = task.clone();
        for posture in [&mut shifted.start, &mut shifted.goal] {
            posture.joints.iter_mut().for_each(|at| *at += offset);
        }
        let spline = FamilySpec::Spline { pieces: 8, degree: 4 };
        let [found, expected] = [varied, shifted].map(|task| {
            let problem = spline.over(Arc::new(task), Accuracy::FINE);
            let coefficients: Vec<f64> =
                (0..problem.dimension()).map(|i| 0.1 * (i as f64).sin()).collect();
            problem.error(&coefficients, 1.0)
        });
        assert!(found.angle_to(&expected) < 1e-12, "{name}");
    }
}

/// Small uncertainties do what the sensitivities say.
#[test]
fn sensitivities_are_those_of_small_changes() {
    let text = "[task]\nrobot = \"ur5e\"\n[task.uncertainty]\nmass = 1e-4\ninertia = 1e-4\nmount_m = 1e-5\njoint_deg = 1e-3\n";
    let task = Arc::new(task(text).unwrap());
    let problem = FamilySpec::SinePolynomial { terms: 2 }.over(task.clone(), Accuracy::FINE);
    let coefficients: Vec<f64> =
        (0..problem.dimension()).map(|i| 0.3 * (1.7 * i as f64).sin()).collect();
    let found = Robustness::of(&*problem, &coefficients, 1.0).unwrap().unwrap();
    let uncertainty = task.uncertainty.as_ref().unwrap();
    assert_eq!(found.sensitivities.len(), uncertainty.unknowns(&task.robot).len());
    assert_eq!(found.residuals.len(), 256);
    let own = problem.error(&coefficients, 1.0);
    for (unknown, angle) in found.sensitivities.iter().take(8) {
        let varied = uncertainty.varied(&task, &[(*unknown, 1.0)]).unwrap();
        let there = problem.spec().over(Arc::new(varied), Accuracy::FINE).error(&coefficients, 1.0);
        let expected = own.angle_to(&there);
        assert!((angle - expected).abs() < 2e-3 * expected, "{unknown:?}: {angle} {expected}");
    }
    // All of them at once turn the base by no more than their sum.
    let most: f64 = found.sensitivities.iter().map(|(_, angle)| angle).sum();
    let off = |residual: &f64| (residual - own.angle()).abs();
    assert!(found.residuals.iter().map(off).fold(0.0, f64::max) < 1.01 * most);
}

/// Differences of the cost, which has kinks only where another robot becomes the worst.
#[test]
fn the_cost_of_robots_as_they_may_be_has_the_right_slopes() {
    for of in ["mean", "worst"] {
        let text =
            format!("[task]\nrobot = \"ur5e\"\nrobust = {{ samples = 6, of = \"{of}\" }}\n{ALL}");
        let problem = formulated(&text, 2);
        let mut rng = Rng::new(3);
        let mut kinks = 0;
        for _ in 0..4 {
            let x: Vec<f64> =
                problem.bounds().iter().map(|[a, b]| 0.3 * rng.uniform(a, b)).collect();
            let found = problem.slopes().unwrap().at(&x).unwrap();
            let cost = |x: &[f64]| problem.evaluate(x).unwrap().cost;
            assert!((found.evaluation.cost - cost(&x)).abs() < 1e-10 * cost(&x));
            let largest = found.slopes.amax();
            for j in 0..x.len() {
                let along = |step: f64| {
                    let mut there = x.clone();
                    there[j] += step;
                    cost(&there)
                };
                let [ahead, back] = [along(1e-6) - cost(&x), cost(&x) - along(-1e-6)];
                if (ahead - back).abs() > 1e-10 * largest {
                    kinks += 1;
                    continue;
                }
                let expected = (ahead + back) / 2e-6;
                assert!(
                    (found.slopes[j] - expected).abs() < 1e-4 * largest,
                    "{of} {j}: {} {expected}",
                    found.slopes[j]
                );
            }
        }
        assert!(kinks < 12, "{of}: {kinks}");
    }
}

/// Judged by robots that the search has not seen, and by the cost that it has.
#[test]
fn robust_motions_miss_by_less() {
    let searched = |wish: &str| {
        let problem = formulated(&format!("[task]\nrobot = \"ur5e\"\n{wish}\n{ALL}"), 3);
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, 3_000, &watch);
        let scp = Scp { starts: std::num::NonZeroUsize::new(4), ..Scp::default() };
        let _ = scp.minimise(&mut oracle, &mut Rng::new(1));
        let best = oracle.best().unwrap().x.clone();
        let (coefficients, _) = problem.certify(&best);
        let found = Robustness::of(problem.task(), &coefficients, 1.0).unwrap().unwrap();
        (problem, best, found.quantile(1.0))
    };
    let (_, plain, plain_worst) = searched("");
    let (problem, robust, robust_worst) = searched("robust = { samples = 16 }");
    let [robust, plain] = [robust, plain].map(|x| problem.evaluate(&x).unwrap().cost);
    assert!(robust < plain, "{robust} {plain}");
    assert!(robust_worst < plain_worst, "{robust_worst} {plain_worst}");
}

#[test]
fn mistakes_are_told() {
    let expect = |text: &str, expected: &str| {
        let found = task(&format!("[task]\nrobot = \"ur5e\"\n{text}")).unwrap_err();
        assert!(found.contains(expected), "{found}\nexpected: {expected}");
    };
    let nothing = "robust = { samples = 4 }\n[task.uncertainty]\nsamples = 9";
    expect(nothing, "`[task.uncertainty]` leaves nothing uncertain");
    expect("robust = { samples = 4 }", "found `robust` without `[task.uncertainty]`");
    expect(
        "robust = { samples = 0 }\n[task.uncertainty]\nmass = 0.1",
        "expected a whole number from 1",
    );
    expect("[task.uncertainty]\nmass = 1.5", "a number from 0 to 1");
    expect("[task.uncertainty]\nmount_m = -1", "zero or above");
    expect("[task.uncertainty]\nmass = { arm = 0.1 }", "robot `ur5e` has no body `arm` with mass");
    expect("[task.uncertainty]\njoint_deg = [1, 2]", "found 2 values, expected 6");
    expect("[task.uncertainty]\nmasses = 0.1", "unknown field `masses`");
}
